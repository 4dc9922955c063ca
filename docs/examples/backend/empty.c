/* SPDX-License-Identifier: MIT */
/*
 * A wire without chips: a whole link master. Target: `empty`, nothing after it.
 *
 * Room hal/empty: a wire without chips.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/native/native.h"

extern const struct bus_ops empty_bus; /* will come from schemes.h */

struct empty {
	struct link_master master; /* first */
	struct link wire;
};

/*
 * A real one pulls the line low where part->reset says so, returns -EHOSTDOWN if no chip does the
 * same after it, writes part->out and reads part->in.
 */
static int wire_run(struct link *wire, const struct link_part *part)
{
	(void)wire;
	if (part->after == LINK_STRONG)
		return -EOPNOTSUPP;
	if (part->in_n)
		memset(part->in, 0xff, part->in_n);
	return part->reset ? -EHOSTDOWN : 0;
}

static int wire_slot(struct link *wire, bool out, enum link_after after)
{
	(void)wire;
	return after == LINK_STRONG ? -EOPNOTSUPP : out;
}

static const struct link_ops wire_ops = {
	.name = "empty",
	.run = wire_run,
	.slot = wire_slot,
};

static const struct link_facts wire_facts = {.splits = true};

/* A real one opens its device here, or says in why what to do about it. */
static int empty_open(struct link_master *master, char *why, size_t why_size)
{
	(void)master, (void)why, (void)why_size;
	return 0;
}

static void empty_close(struct link_master *master)
{
	(void)master;
}

static unsigned empty_channels(struct link_master *master)
{
	(void)master;
	return 1;
}

static struct link *empty_channel(struct link_master *master, unsigned n)
{
	(void)n;
	return &((struct empty *)master)->wire;
}

static void empty_destroy(struct link_master *master)
{
	free(master);
}

static int empty_create(const char *where, const struct bus_env *env, struct link_master **master,
                        char *why, size_t why_size);

static const struct link_master_ops empty_ops = {
	.create = empty_create,
	.open = empty_open,
	.close = empty_close,
	.channels = empty_channels,
	.channel = empty_channel,
	.destroy = empty_destroy,
};

static int empty_create(const char *where, const struct bus_env *env, struct link_master **master,
                        char *why, size_t why_size)
{
	struct empty *empty;

	if (*where) {
		snprintf(why, why_size, "nothing may follow 'empty'");
		return -EINVAL;
	}
	empty = calloc(1, sizeof(*empty));
	if (!empty)
		return -ENOMEM;
	empty->master = (struct link_master){.ops = &empty_ops, .env = env};
	empty->wire = (struct link){.ops = &wire_ops, .facts = &wire_facts, .env = env};
	*master = &empty->master;
	return 0;
}

static int bus_create_empty(const char *where, const struct bus_env *env, struct bus **bus,
                            char *why, size_t why_size)
{
	return native_create(&empty_bus, &empty_ops, where, env, bus, why, why_size);
}

const struct bus_ops empty_bus = {
	.scheme = "empty",
	.summary = "a wire without chips",
	.create = bus_create_empty,
	NATIVE_BUS_SLOTS,
};
