/* SPDX-License-Identifier: MIT */
/* A serial adapter as a master: its port opened, proved, closed and opened again. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/serial/master.h"

/* What a USB adapter and a busy machine may add to the time of the line. */
#define LATE_NS (200 * NS_PER_MS)
#define QUIET_NS (30 * NS_PER_MS) /* nothing comes for longer than a USB adapter gathers bytes */
#define SETTLE_NS (200 * NS_PER_MS)
#define END_NS (5 * NS_PER_MS) /* a byte is on the line by then */

/* Of a DS2480B, the only one that has a strong pull-up. */
static const uint8_t end_pulse = 0xF1;

int serial_create(const struct link_master_ops *ops, const struct serial_kind *kind,
                  const struct bus_env *env, const struct serial_source *source,
                  struct link_master **out)
{
	struct serial_master *master = calloc(1, sizeof(*master));

	if (!master) {
		source->destroy(source->ctx);
		return -ENOMEM;
	}
	master->master = (struct link_master){.ops = ops, .env = env};
	master->link = (struct link){.ops = kind->link, .facts = &kind->facts, .env = env};
	master->kind = kind;
	master->source = *source;
	*out = &master->master;
	return 0;
}

int serial_open(struct link_master *base, char *why, size_t why_size)
{
	struct serial_master *master = (struct serial_master *)base;
	int err = master->source.open(master->source.ctx, base->env, &master->port, master->name,
	                              sizeof(master->name), why, why_size);

	if (err)
		return err;
	master->baud = 0;
	err = master->kind->begin(master, why, why_size);
	if (err)
		serial_close(base);
	return err;
}

void serial_close(struct link_master *base)
{
	struct serial_master *master = (struct serial_master *)base;

	if (!master->port)
		return;
	serial_master_cost(base, &master->closed);
	/* nobody else would end a strong pull-up */
	if (master->strong && !master->port->ops->write(master->port, &end_pulse, 1))
		(void)serial_wait(master, END_NS);
	master->strong = false;
	master->port->ops->close(master->port);
	master->port = NULL;
}

int serial_visible(struct link_master *base, uint64_t *mark)
{
	struct serial_master *master = (struct serial_master *)base;

	return master->source.visible ? master->source.visible(master->source.ctx, mark) : 1;
}

void serial_trouble(struct link_master *base, bool failed, char *text, size_t size)
{
	struct serial_master *master = (struct serial_master *)base;
	char who[RIVALS_TEXT];

	(void)failed;
	text[0] = '\0';
	if (master->source.proc && rivals_find(master->source.proc, master->name, who, sizeof(who)))
		snprintf(text, size,
		         "%s is also open in %s: two programs on one adapter disturb each other",
		         master->name, who);
}

unsigned serial_channels(struct link_master *base)
{
	return ((struct serial_master *)base)->port != NULL;
}

struct link *serial_channel(struct link_master *base, unsigned n)
{
	return n == 0 ? &((struct serial_master *)base)->link : NULL;
}

void serial_master_cost(const struct link_master *base, struct link_master_cost *cost)
{
	const struct serial_master *master = (const struct serial_master *)base;

	*cost = master->closed;
	cost->transfers = master->transfers;
	if (!master->port)
		return;
	cost->bytes += master->port->bytes;
	cost->syscalls += master->port->syscalls;
}

void serial_cost(const struct link *link, struct link_cost *cost)
{
	*cost = ((const struct serial_master *)((const char *)link -
	                                        offsetof(struct serial_master, link)))
	                ->cost;
}

void serial_destroy(struct link_master *base)
{
	struct serial_master *master = (struct serial_master *)base;

	serial_close(base);
	master->source.destroy(master->source.ctx);
	free(master);
}

int serial_wait(struct serial_master *master, int64_t ns)
{
	const struct bus_env *env = master->master.env;

	return env->wait(env->ctx, -1, 0, bus_now(env) + ns) < 0 ? -ECANCELED : 0;
}

int serial_exchange(struct serial_master *master, unsigned baud, const uint8_t *out, size_t out_n,
                    uint8_t *in, size_t n, size_t *got)
{
	struct serial_port *port = master->port;
	int64_t byte_ns = 10 * NS_PER_S / baud, until_ns;

	*got = 0;
	if (!port)
		return -ENODEV;
	master->transfers++;
	until_ns = bus_now(port->env) + byte_ns * (int64_t)(out_n + n) + LATE_NS;
	int err = port->ops->write(port, out, out_n);

	/* to take each answer as it comes would wake us as often */
	if (!err && n)
		err = serial_wait(master, byte_ns * (int64_t)out_n + master->kind->lag_ns);
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
	uint8_t bytes[64];
	int64_t end_ns;
	int came;

	if (!port)
		return -ENODEV;
	end_ns = bus_now(port->env) + SETTLE_NS;
	do {
		came = port->ops->read(port, bytes, sizeof(bytes), bus_now(port->env) + QUIET_NS);
	} while (came > 0 && bus_now(port->env) < end_ns);
	return came < 0 ? came : 0;
}
