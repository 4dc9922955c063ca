/* SPDX-License-Identifier: MIT */
/* A serial adapter as a master: its port opened, proved, closed and opened again. */
#include <errno.h>
#include <stdlib.h>

#include "hal/base/time.h"
#include "hal/serial/master.h"

/* What a USB adapter and a busy machine may add to the time of the line. */
#define LATE_NS (200 * NS_PER_MS)
/* What each port and machine adds: who looks earlier is woken once more for the last byte. */
#define ARRIVE_NS (NS_PER_MS / 4)
#define QUIET_NS (30 * NS_PER_MS) /* nothing comes for longer than a USB adapter gathers bytes */
#define SETTLE_NS (200 * NS_PER_MS)
#define END_NS (5 * NS_PER_MS) /* two bytes are on the line by then */

/* Of a DS2480B, the only one that has a strong pull-up: out of the mode for data, and its end. */
static const uint8_t end_pulse[] = {0xE3, 0xF1};

int serial_create(const struct link_master_ops *ops, const struct serial_kind *kind,
                  const struct bus_env *env, const struct serial_source *source,
                  struct link_master **out)
{
	struct serial_master *master = calloc(1, sizeof(*master));

	if (!master) {
		source->destroy(source->ctx);
		return -ENOMEM;
	}
	adapter_init(&master->adapter, &kind->adapter, ops, env);
	master->adapter.device = master->adapter.name;
	master->adapter.proc = source->proc;
	master->kind = kind;
	master->source = *source;
	*out = &master->adapter.master;
	return 0;
}

int serial_open(struct link_master *base, char *why, size_t why_size)
{
	struct serial_master *master = (struct serial_master *)base;
	struct adapter *adapter = &master->adapter;
	int err = master->source.open(master->source.ctx, base->env, &master->port, adapter->name,
	                              sizeof(adapter->name), why, why_size);

	if (err)
		return err;
	master->port->cost = &adapter->shared;
	master->baud = 0;
	adapter->open = true;
	adapter->lost = false;
	err = master->kind->begin(master, why, why_size);
	if (err) {
		adapter_accuse(adapter, why, why_size);
		serial_close(base);
	}
	return err;
}

void serial_close(struct link_master *base)
{
	struct serial_master *master = (struct serial_master *)base;
	struct adapter *adapter = &master->adapter;

	if (!adapter->open)
		return;
	size_t skipped = !master->data_mode;

	/* nobody else ends the pull-up; a shutdown ends waits, and a closed port forgets bytes */
	if (adapter->strong &&
	    !master->port->ops->write(master->port, end_pulse + skipped,
	                              sizeof(end_pulse) - skipped) &&
	    adapter_wait(adapter, END_NS))
		clock_pause(END_NS);
	adapter->strong = adapter->open = false;
	master->port->ops->close(master->port);
}

int serial_visible(struct link_master *base, uint64_t *mark)
{
	struct serial_master *master = (struct serial_master *)base;

	return master->source.visible ? master->source.visible(master->source.ctx, mark) : 1;
}

void serial_destroy(struct link_master *base)
{
	struct serial_master *master = (struct serial_master *)base;

	serial_close(base);
	master->source.destroy(master->source.ctx);
	free(master);
}

int serial_speed(struct serial_master *master, unsigned baud)
{
	int err = master->baud == baud ? 0 : master->port->ops->speed(master->port, baud);

	master->baud = err ? 0 : baud;
	return err;
}

int serial_exchange(struct serial_master *master, unsigned baud, const uint8_t *out, size_t out_n,
                    uint8_t *in, size_t n, size_t *got)
{
	struct serial_port *port = master->port;
	int64_t byte_ns = 10 * NS_PER_S / baud;
	int64_t until_ns;
	int err = serial_speed(master, baud);

	master->adapter.shared.transfers++;
	*got = 0;
	if (!err)
		err = port->ops->write(port, out, out_n);
	/* to take each answer as it comes would wake us as often */
	if (!err && n)
		err = adapter_wait(&master->adapter,
		                   byte_ns * (int64_t)out_n + master->kind->lag_ns + ARRIVE_NS);
	/* from now on: on a busy machine the calls above may have taken longer than that */
	until_ns = bus_now(port->env) + byte_ns * (int64_t)n + LATE_NS;
	while (!err && *got < n) {
		int came = port->ops->read(port, in + *got, n - *got, until_ns);

		if (came <= 0)
			err = came < 0 ? came : -ETIMEDOUT;
		else
			*got += (size_t)came;
	}
	return err;
}

int serial_settle(struct serial_master *master)
{
	struct serial_port *port = master->port;
	int64_t end_ns = bus_now(port->env) + SETTLE_NS;
	uint8_t bytes[64];
	int came;

	do {
		came = port->ops->read(port, bytes, sizeof(bytes), bus_now(port->env) + QUIET_NS);
	} while (came > 0 && bus_now(port->env) < end_ns);
	return came < 0 ? came : 0;
}
