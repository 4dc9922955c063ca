/* SPDX-License-Identifier: MIT */
/* A link master for tests, without a bridge chip. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "tests/unit/aid/wire_link.h"

#define RESET_NS 1184000
#define SLOT_NS 69250

struct wire_net wire_net;

static struct link links[WIRE_CHANNELS];

int64_t wire_time(void)
{
	return wire_net.host->now;
}

static struct sim_wire *wire_of(const struct link *link)
{
	return &wire_net.wire[link - links];
}

static int spend(int64_t ns)
{
	wire_net.cost.wire_ns += (uint64_t)ns;
	return wire_net.host->env.wait(wire_net.host, -1, 0, wire_net.host->now + ns) < 0
	               ? -ECANCELED
	               : 0;
}

/* Carry out the restarts that are due since the wire was last used: one may fall into a wait. */
static void restart(void)
{
	struct trouble *trouble = wire_net.trouble;

	if (wire_net.used)
		wire_net.used(wire_time());
	while (trouble && trouble->kind == TROUBLE_RESTART && trouble->restart_ns &&
	       trouble->restart_ns <= wire_time()) {
		for (unsigned i = 0; i < wire_net.wire[0].count; i++)
			sim_slave_brownout(wire_net.wire[0].slaves[i], trouble->restart_ns);
		trouble->restart_ns = trouble->every_ns ? trouble->restart_ns + trouble->every_ns
		                                        : 0;
	}
}

/* The chip of the link does not answer any more. */
static bool is_gone(const struct link *link)
{
	return link >= links + wire_net.channels;
}

/* Begin a call of the link. */
static int begin(struct link *link)
{
	struct sim_wire *wire = wire_of(link);

	restart();
	for (unsigned i = 0; i < wire_net.channels; i++) {
		if (!wire_net.wire[i].strong || links[i].chip != link->chip)
			continue;
		wire_net.strong_ns = wire_time() - wire_net.strong_begin;
		sim_wire_strong(&wire_net.wire[i], false, wire_time());
	}
	if (is_gone(link)) {
		spend(SLOT_NS);
		return -EIO;
	}
	if (wire_net.fault_count) {
		wire_net.fault_count--;
		spend(SLOT_NS);
		return wire_net.fault;
	}
	return sim_wire_level(wire, wire_time()) ? 0 : -ECOMM;
}

static int wire_reset(struct link *link)
{
	int err = begin(link);

	if (err)
		return err;
	wire_net.resets[link - links]++;
	bool heard = !wire_net.trouble || trouble_heard(wire_net.trouble);
	bool presence = heard && sim_wire_reset(wire_of(link), false, wire_time());
	if (wire_net.trouble)
		presence = trouble_presence(wire_net.trouble, presence);
	err = spend(RESET_NS);
	return err ? err : presence ? 0 : -EHOSTDOWN;
}

static void break_down(struct sim_wire *wire)
{
	struct trouble *trouble = wire_net.trouble;

	trouble->due = false;
	if (trouble->kind == TROUBLE_UNPLUG)
		sim_wire_plug(wire, wire->slaves[0], false, wire_time());
	else
		wire->shorted = true;
}

/* A turned bit reaches the chips if the master wrote it, and the master if a chip did. */
static bool slot(struct link *link, bool out, bool writes)
{
	restart();
	bool turns = wire_net.trouble && trouble_turns(wire_net.trouble);
	if (wire_net.trouble && wire_net.trouble->due)
		break_down(wire_of(link));
	bool sent = out ^ (turns && writes);
	bool deaf = wire_net.trouble && wire_net.trouble->deaf;
	bool line = deaf ? sent : sim_wire_slot(wire_of(link), sent, false, wire_time());

	spend(SLOT_NS);
	return line ^ (turns && !writes);
}

static void after_call(struct link *link, enum link_after after)
{
	if (after == LINK_IDLE)
		return;
	wire_net.strong_count++;
	wire_net.strong_begin = wire_time();
	sim_wire_strong(wire_of(link), true, wire_time());
}

static int wire_write(struct link *link, const uint8_t *data, size_t n, enum link_after after)
{
	int err = wire_net.passive && after == LINK_STRONG ? -EOPNOTSUPP : begin(link);

	if (err)
		return err;
	if (n == 2 && data[0] == 0xcc && data[1] == 0x44)
		wire_net.converts[wire_net.convert_count++ % 64] = wire_time();
	if (wire_net.sends)
		wire_net.sends(data, n);
	for (size_t i = 0; i < n; i++)
		for (int bit = 0; bit < 8; bit++)
			slot(link, data[i] >> bit & 1, true);
	if (wire_net.sent)
		wire_net.sent(data, n);
	after_call(link, after);
	return 0;
}

static int wire_read(struct link *link, uint8_t *data, size_t n)
{
	int err = begin(link);

	if (err)
		return err;
	memset(data, 0, n);
	for (size_t i = 0; i < n; i++)
		for (int bit = 0; bit < 8; bit++)
			data[i] |= (uint8_t)(slot(link, true, false) << bit);
	return 0;
}

static int wire_run(struct link *link, const struct link_part *part)
{
	int err = part->reset ? wire_reset(link) : 0;

	if (!err && part->out_n)
		err = wire_write(link, part->out, part->out_n, part->after);
	return err || !part->in_n ? err : wire_read(link, part->in, part->in_n);
}

static int wire_slot(struct link *link, bool out, enum link_after after)
{
	int err = wire_net.passive && after == LINK_STRONG ? -EOPNOTSUPP : begin(link);

	if (err)
		return err;
	int line = slot(link, out, !out);
	after_call(link, after);
	return line;
}

/* Three slots as the bridge chips do them, so that the trouble knows which one writes. */
static int wire_triplet(struct link *link, bool direction)
{
	int err = begin(link);

	if (err)
		return err;
	bool id = slot(link, true, false), complement = slot(link, true, false);
	bool taken = id == complement ? id || direction : id;
	slot(link, taken, true);
	return id | complement << 1 | taken << 2;
}

static int wire_recover(struct link *link, enum link_rung rung)
{
	wire_net.recovered[rung]++;
	if (is_gone(link))
		return -EIO;
	if (wire_net.rung_err[rung])
		return wire_net.rung_err[rung];
	if (rung == LINK_POWER_CYCLE) {
		sim_wire_power(wire_of(link), false, wire_time());
		spend(1000000);
		sim_wire_power(wire_of(link), true, wire_time());
	}
	if (wire_net.fault_until && (int)rung >= wire_net.fault_until)
		wire_net.fault_count = 0;
	return 0;
}

static void wire_cost(const struct link *link, struct link_cost *cost)
{
	*cost = (struct link_cost){0};
	if (link == links)
		*cost = wire_net.cost;
	cost->resets = wire_net.resets[link - links];
}

#define LINK_OPS \
	.name = "test wire", .run = wire_run, .slot = wire_slot, .recover = wire_recover, \
	.cost = wire_cost

static const struct link_ops link_ops = {LINK_OPS};
static const struct link_ops troubled_ops = {LINK_OPS, .triplet = wire_triplet};

static struct link_facts facts;

static int master_create(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size)
{
	extern const struct link_master_ops wire_master;
	struct link_master *new = calloc(1, sizeof(*new));

	(void)where;
	(void)why;
	(void)why_size;
	if (!new)
		return -ENOMEM;
	new->ops = &wire_master;
	new->env = env;
	*master = new;
	return 0;
}

static int master_open(struct link_master *master, char *why, size_t why_size)
{
	wire_net.opens++;
	if (wire_net.open_error) {
		snprintf(why, why_size, "no such chip");
		return wire_net.open_error;
	}
	facts = (struct link_facts){.strong = !wire_net.passive, .splits = true};
	for (unsigned i = 0; i < wire_net.channels; i++)
		links[i] = (struct link){.ops = wire_net.trouble ? &troubled_ops : &link_ops,
		                         .facts = &facts,
		                         .env = master->env,
		                         .chip = wire_net.chips == 1 ? 0 : i};
	return 0;
}

static void master_close(struct link_master *master)
{
	(void)master;
	wire_net.closes++;
}

static unsigned master_channels(struct link_master *master)
{
	(void)master;
	return wire_net.channels;
}

static struct link *master_channel(struct link_master *master, unsigned n)
{
	(void)master;
	return &links[n];
}

static void master_cost(const struct link_master *master, struct link_master_cost *cost)
{
	(void)master;
	*cost = wire_net.shared;
}

static void master_destroy(struct link_master *master)
{
	free(master);
}

extern const struct link_master_ops wire_master;
const struct link_master_ops wire_master = {
	.create = master_create,
	.open = master_open,
	.close = master_close,
	.channels = master_channels,
	.channel = master_channel,
	.cost = master_cost,
	.destroy = master_destroy,
	.simulated = true,
};

static int bus_over_wire(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                         size_t why_size)
{
	return native_create(&wire_bus, &wire_master, where, env, bus, why, why_size);
}

/* clang-format off */
const struct bus_ops wire_bus = {
	.scheme = "wire", .summary = "simulated slaves", .create = bus_over_wire, NATIVE_BUS_SLOTS,
};
/* clang-format on */

void wire_init(struct host *host, unsigned channels, unsigned chips)
{
	memset(&wire_net, 0, sizeof(wire_net));
	wire_net.host = host;
	wire_net.channels = channels;
	wire_net.chips = chips;
}

void wire_clear(void)
{
	for (unsigned i = 0; i < WIRE_CHANNELS; i++)
		sim_wire_clear(&wire_net.wire[i]);
}

struct sim_slave *wire_add(unsigned channel, const char *chip, unsigned number)
{
	const struct sim_family *family = sim_family_find(chip, 0);
	uint8_t id[6] = {(uint8_t)number, (uint8_t)(number >> 8), 0x5d, 0xdf, 0x03, 0};

	TEST_ASSERT_NOT_NULL_MESSAGE(family, chip);
	struct sim_slave *slave = sim_slave_create(family, id);
	TEST_ASSERT_NOT_NULL(slave);
	TEST_ASSERT_EQUAL_INT(0, sim_wire_add(&wire_net.wire[channel], slave));
	sim_slave_power_on(slave, wire_time());
	return slave;
}

void wire_set(struct sim_slave *slave, const char *input, double value)
{
	int n = sim_slave_input(slave, input);

	TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(0, n, input);
	sim_slave_advance(slave, wire_time());
	slave->input[n] = sim_constant(value);
}

struct bus *wire_open(void)
{
	struct bus *bus = NULL;
	char why[100] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, wire_bus.create("", &wire_net.host->env, &bus, why, sizeof(why)), why);
	return bus;
}
