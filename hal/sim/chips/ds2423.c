/* SPDX-License-Identifier: MIT */
/* DS2423 (data sheet, "4kbit 1-Wire RAM with Counter"): RAM, and two counters of falling edges. */
#include <errno.h>
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/crc.h"

enum { READ_COUNTER = 0xA5 };
enum { FIRST_COUNTER_PAGE = 14, PAGES = 16 };

struct ds2423 {
	struct sim_scratchpad memory; /* first */
	uint32_t counter[2];
	int64_t seen;
	bool level[2];
};

/* tPROG of a RAM: 32 us. */
static const struct sim_scratchpad_kind kind = {
	.size = 512, .page = 32, .copy = 0x5A, .copy_ns = 32000};

static struct ds2423 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2423);
}

static void create(struct sim_slave *slave)
{
	state(slave)->memory.kind = &kind;
	state(slave)->level[0] = state(slave)->level[1] = true;
}

/* A battery keeps RAM and counters. */
static void power_on(struct sim_slave *slave, int64_t t)
{
	sim_scratchpad_power_on(slave, t);
	state(slave)->seen = t;
}

static void advance(struct sim_slave *slave, int64_t t)
{
	struct ds2423 *s = state(slave);

	sim_scratchpad_advance(slave, t);
	for (unsigned i = 0; i < 2; i++) {
		const struct sim_curve *curve = &slave->input[i];
		bool level = sim_curve_at(curve, t) >= 0.5;
		uint64_t falls = sim_curve_falls(curve, s->seen, t);

		/* A new curve may begin low where the old one ended high. */
		if (s->level[i] && sim_curve_at(curve, s->seen) < 0.5)
			falls++;
		s->counter[i] += (uint32_t)falls;
		s->level[i] = level;
	}
	s->seen = t;
}

/* The rest of the page, its counter, four bytes of 0, checksum. */
static void send_page(struct sim_slave *slave)
{
	struct sim_scratchpad *m = &state(slave)->memory;
	unsigned page = m->address / 32, n = 0;
	uint32_t count = UINT32_MAX;
	uint8_t out[32 + 4 + 4 + 2];

	if (page >= PAGES) {
		sim_end(slave);
		return;
	}
	if (page >= FIRST_COUNTER_PAGE)
		count = state(slave)->counter[page - FIRST_COUNTER_PAGE];
	do
		out[n++] = m->memory[m->address++];
	while (m->address % 32);
	for (unsigned i = 0; i < 4; i++)
		out[n++] = (uint8_t)(count >> (8 * i));
	memset(out + n, 0, 4);
	n += 4;
	m->crc = sim_crc16(m->crc, out, n);
	out[n++] = (uint8_t)~m->crc;
	out[n++] = (uint8_t)(~m->crc >> 8);
	m->crc = 0;
	sim_send(slave, out, n);
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct sim_scratchpad *m = &state(slave)->memory;

	if (m->command == 0 && byte == READ_COUNTER) {
		m->command = byte;
		m->got = 0;
		m->crc = sim_crc16(0, &byte, 1);
	} else if (m->command == READ_COUNTER) {
		m->crc = sim_crc16(m->crc, &byte, 1);
		m->taken[m->got++] = byte;
		if (m->got == 2) {
			m->address = (uint16_t)(m->taken[0] | m->taken[1] << 8);
			send_page(slave);
		}
	} else {
		sim_scratchpad_received(slave, byte, t);
	}
}

static void drained(struct sim_slave *slave, int64_t t)
{
	if (state(slave)->memory.command == READ_COUNTER)
		send_page(slave);
	else
		sim_scratchpad_drained(slave, t);
}

static int option(struct sim_slave *slave, const char *name, double value)
{
	unsigned counter;

	if (strcmp(name, "count.A") == 0)
		counter = 0;
	else if (strcmp(name, "count.B") == 0)
		counter = 1;
	else
		return -ENOENT;
	if (value < 0 || value > UINT32_MAX)
		return -ERANGE;
	state(slave)->counter[counter] = (uint32_t)value;
	return 0;
}

static const struct sim_input inputs[] = {SIM_PIN("pin.A"), SIM_PIN("pin.B"), {0}};

const struct sim_family sim_ds2423 = {
	.name = "DS2423",
	.code = 0x1D,
	.overdrive = true,
	.state_size = sizeof(struct ds2423),
	.inputs = inputs,
	.create = create,
	.power_on = power_on,
	.reset = sim_scratchpad_reset,
	.received = received,
	.drained = drained,
	.bit = sim_scratchpad_bit,
	.advance = advance,
	.option = option,
	.memory = sim_scratchpad_memory,
};
