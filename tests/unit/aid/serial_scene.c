/* SPDX-License-Identifier: MIT */
/* Sets up a driver of a serial adapter over a simulated one, on a virtual clock. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
#include "hal/native/native.h"
#include "hal/sim/crc.h"
#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/serial_scene.h"

struct serial_scene serial;

static bool is_gone(void)
{
	serial.pulled |= serial.pull_at && serial.sim.bytes >= serial.pull_at;
	return serial.pulled;
}

static int set_speed(struct serial_port *port, unsigned baud)
{
	(void)port;
	if (baud == serial.no_speed)
		return -ENOTTY;
	serial.baud = baud;
	return is_gone() ? -ENODEV : 0;
}

static int port_write(struct serial_port *port, const uint8_t *bytes, size_t n)
{
	serial.writes++;
	serial.host.now += serial.late_ns;
	serial.written_ns = clock_ns(CLOCK_MONOTONIC);
	if (serial.full)
		return -ETIMEDOUT;
	for (size_t i = 0; i < n && !is_gone(); i++)
		sim_serial_send(&serial.sim, bytes[i], serial.baud, serial.host.now);
	port->cost->bytes += n;
	return is_gone() ? -ENODEV : 0;
}

static int port_read(struct serial_port *port, uint8_t *bytes, size_t n, int64_t until_ns)
{
	size_t got = 0;

	(void)port;
	serial.reads++;
	if (is_gone())
		return -ENODEV;
	if (serial.host.shutdown)
		return -ECANCELED;
	if (serial.babbles) {
		serial.host.now += HOST_MS;
		bytes[0] = 0x55;
		return 1;
	}
	if (sim_serial_due(&serial.sim) > until_ns) {
		serial.host.now = until_ns;
		return 0;
	}
	if (serial.host.now < sim_serial_due(&serial.sim))
		serial.host.now = sim_serial_due(&serial.sim);
	while (got < n && sim_serial_due(&serial.sim) <= serial.host.now)
		bytes[got++] = sim_serial_take(&serial.sim, serial.baud);
	return (int)got;
}

static void port_break(struct serial_port *port)
{
	(void)port;
	serial.breaks++;
	if (!serial.deaf_to_break)
		sim_serial_break(&serial.sim, serial.host.now);
}

static void port_close(struct serial_port *port)
{
	(void)port;
	serial.closed_ns = clock_ns(CLOCK_MONOTONIC);
}

static const struct serial_port_ops port_ops = {
	.speed = set_speed,
	.write = port_write,
	.read = port_read,
	.send_break = port_break,
	.close = port_close,
};

static int open_port(void *ctx, const struct bus_env *env, struct serial_port **port, char *name,
                     size_t name_size, char *why, size_t why_size)
{
	(void)ctx;
	serial.opens++;
	snprintf(name, name_size, "%s", serial.proc ? "/dev/null" : "port");
	if (is_gone()) {
		snprintf(why, why_size, "no port");
		return -ENODEV;
	}
	serial.port = (struct serial_port){.ops = &port_ops, .env = env};
	serial.baud = 1200; /* that of whoever had it before */
	*port = &serial.port;
	return 0;
}

static void forget(void *ctx)
{
	(void)ctx;
}

static const struct link_master_ops master_ops = {
	SERIAL_MASTER_SLOTS,
};

void serial_begin(void)
{
	memset(&serial, 0, sizeof(serial));
	host_init_virtual(&serial.host);
	serial.host.now = HOST_S;
}

void serial_end(void)
{
	if (serial.master)
		serial.master->ops->destroy(serial.master);
	serial.master = NULL;
	sim_net_clear(&serial.net);
}

void serial_make(enum sim_serial_kind kind, const struct serial_kind *driver, const char *scenario)
{
	const struct serial_source source = {
		.open = open_port, .destroy = forget, .proc = serial.proc};

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0,
		sim_scenario_parse("test", scenario, &serial.net, serial.why, sizeof(serial.why)),
		serial.why);
	sim_net_start(&serial.net, serial.host.now);
	sim_serial_init(&serial.sim, kind, &serial.net);
	TEST_ASSERT_EQUAL_INT(
		0, serial_create(&master_ops, driver, &serial.host.env, &source, &serial.master));
}

static enum sim_serial_kind bus_kind;
static const struct serial_kind *bus_driver;
static const char *bus_scenario;

static int make_master(const char *where, const struct bus_env *env, struct link_master **out,
                       char *why, size_t why_size)
{
	(void)where, (void)env, (void)why, (void)why_size;
	serial_make(bus_kind, bus_driver, bus_scenario);
	*out = serial.master;
	serial.master = NULL; /* the bus owns it */
	return 0;
}

struct bus *serial_bus_of(enum sim_serial_kind kind, const struct serial_kind *driver,
                          const char *scenario)
{
	static struct link_master_ops of_bus;
	static const struct bus_ops ops = {NATIVE_BUS_SLOTS};
	struct bus *bus;

	of_bus = master_ops;
	of_bus.create = make_master;
	bus_kind = kind;
	bus_driver = driver;
	bus_scenario = scenario;
	TEST_ASSERT_EQUAL_INT(0, native_create(&ops, &of_bus, "", &serial.host.env, &bus,
	                                       serial.why, sizeof(serial.why)));
	host_run(&serial.host, bus, serial.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&serial.host, BUS_UP));
	return bus;
}

int serial_try(void)
{
	int err = serial.master->ops->open(serial.master, serial.why, sizeof(serial.why));

	serial.wire = serial.master->ops->channel(serial.master, 0);
	return err;
}

void serial_start(enum sim_serial_kind kind, const struct serial_kind *driver, const char *scenario)
{
	serial_make(kind, driver, scenario);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, serial_try(), serial.why);
}

void serial_event(const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0,
	                              sim_scenario_event(&serial.net, text, serial.host.now,
	                                                 serial.why, sizeof(serial.why)),
	                              serial.why);
}

int serial_scratchpad(const char *name, uint8_t scratchpad[9])
{
	uint8_t out[10] = {0x55};
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .in = scratchpad, .in_n = 9};

	memcpy(out + 1, sim_net_slave(&serial.net, name)->rom, 8);
	out[9] = 0xBE;
	return serial.wire->ops->run(serial.wire, &part);
}

void serial_check(const char *name)
{
	uint8_t scratchpad[9];

	TEST_ASSERT_EQUAL_INT(0, serial_scratchpad(name, scratchpad));
	TEST_ASSERT_EQUAL_HEX8(0x50, scratchpad[0]);
	TEST_ASSERT_EQUAL_HEX8(0x05, scratchpad[1]);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
}
