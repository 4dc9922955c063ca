/* SPDX-License-Identifier: MIT */
/* DS2423 (data sheet, "4kbit 1-Wire RAM with Counter"): RAM, and two counters of falling edges. */

#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { FIRST_COUNTER_PAGE = 14 };

struct ds2423 {
	struct sim_scratchpad memory; /* first */
	uint32_t counter[2];
	int64_t seen;
	bool level[2];
};

/* tPROG of a RAM: 32 us. */
static const struct sim_scratchpad_kind kind = {
	.size = 512, .writable = 512, .page = 32, .copy_ns = 32000};

static void ds2423_create(struct sim_slave *slave)
{
	struct ds2423 *s = slave->state;

	s->level[0] = s->level[1] = true;
}

/* A battery keeps RAM and counters. */
static void ds2423_power_on(struct sim_slave *slave)
{
	sim_scratchpad_power_on(slave);
	sim_state(slave, ds2423)->seen = slave->now;
}

static void ds2423_advance(struct sim_slave *slave)
{
	struct ds2423 *s = slave->state;

	for (unsigned i = 0; i < 2; i++) {
		const struct sim_curve *curve = &slave->input[i];
		bool level = sim_curve_at(curve, slave->now) >= 0.5;
		uint64_t falls = sim_curve_falls(curve, s->seen, slave->now);

		/* A new curve may begin low where the old one ended high. */
		if (s->level[i] && sim_curve_at(curve, s->seen) < 0.5)
			falls++;
		s->counter[i] += (uint32_t)falls;
		s->level[i] = level;
	}
	s->seen = slave->now;
}

static void ds2423_send_page(struct sim_slave *slave)
{
	static const uint8_t zeros[4] = {0};
	const struct ds2423 *s = slave->state;
	unsigned page = slave->address / 32;

	sim_scratchpad_send_counted(
		slave, page < FIRST_COUNTER_PAGE ? UINT32_MAX : s->counter[page % 2], zeros);
}

static void set_a(struct sim_slave *slave, int64_t count)
{
	sim_state(slave, ds2423)->counter[0] = (uint32_t)count;
}

static void set_b(struct sim_slave *slave, int64_t count)
{
	sim_state(slave, ds2423)->counter[1] = (uint32_t)count;
}

static const struct sim_option options[] = {
	{"count.A", 0, UINT32_MAX, .set = set_a}, {"count.B", 0, UINT32_MAX, .set = set_b}, {0}};

static const struct sim_function functions[] = {
	SIM_SCRATCHPAD_FUNCTIONS(0x5A),
	/* Read Memory and Counter */
	{.code = 0xA5, .takes = 2, .start = ds2423_send_page, .next = ds2423_send_page},
	{0},
};

static const struct sim_input inputs[] = {{SIM_PIN("pin.A")}, {SIM_PIN("pin.B")}, {0}};

const struct sim_family sim_ds2423 = {
	.name = "DS2423",
	.code = 0x1D,
	.overdrive = true,
	.state_size = sizeof(struct ds2423),
	.kind = &kind,
	.functions = functions,
	.inputs = inputs,
	.create = ds2423_create,
	.power_on = ds2423_power_on,
	.bit = sim_scratchpad_bit,
	.worked = sim_scratchpad_worked,
	.advance = ds2423_advance,
	.options = options,
	SIM_MEMORY(ds2423, memory.memory, 512),
};
