/* SPDX-License-Identifier: MIT */
/* Schemes "serial" and "uart": the native bus over a serial adapter with a DS2480B, or without. */
#include <errno.h>
#include <sys/stat.h>

#include "hal/native/native.h"
#include "hal/serial/ds2480b.h"
#include "hal/serial/find.h"
#include "hal/serial/passive.h"

static const struct bus_look looks[] = {
	{.begin = "/",
         .root = "",
         .type = S_IFCHR,
         .wrong = "no serial port",
         .remedy = "ls " SERIAL_BY_ID " lists the serial adapters that are plugged in"},
	{0},
};

static int create(const struct link_master_ops *ops, const struct serial_kind *kind,
                  const char *where, const struct bus_env *env, struct link_master **master,
                  char *why, size_t why_size)
{
	struct serial_source source;
	int err = tty_source(where, SERIAL_NAMES, &source, why, why_size);

	return err ? err : serial_create(ops, kind, env, &source, master);
}

static const struct link_master_ops serial_master, uart_master;

static int create_serial(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size)
{
	return create(&serial_master, &serial_ds2480b, where, env, master, why, why_size);
}

static int create_uart(const char *where, const struct bus_env *env, struct link_master **master,
                       char *why, size_t why_size)
{
	return create(&uart_master, &serial_passive, where, env, master, why, why_size);
}

static const struct link_master_ops serial_master = {.create = create_serial, SERIAL_MASTER_SLOTS};
static const struct link_master_ops uart_master = {.create = create_uart, SERIAL_MASTER_SLOTS};

static int serial_bus_create(const char *where, const struct bus_env *env, struct bus **bus,
                             char *why, size_t why_size)
{
	return native_create(&serial_bus, &serial_master, where, env, bus, why, why_size);
}

static int uart_bus_create(const char *where, const struct bus_env *env, struct bus **bus,
                           char *why, size_t why_size)
{
	return native_create(&uart_bus, &uart_master, where, env, bus, why, why_size);
}

const struct bus_ops serial_bus = {
	.scheme = "serial",
	.summary = "1-Wire devices on a serial adapter with DS2480B: DS9097U, LinkUSB",
	.create = serial_bus_create,
	.caches = "",
	.looks = looks,
	NATIVE_BUS_SLOTS,
};

const struct bus_ops uart_bus = {
	.scheme = "uart",
	.summary = "1-Wire devices on a passive serial adapter: DS9097",
	.create = uart_bus_create,
	.caches = "",
	.looks = looks,
	NATIVE_BUS_SLOTS,
};
