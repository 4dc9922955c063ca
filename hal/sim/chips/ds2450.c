/* SPDX-License-Identifier: MIT */
/* DS2450 (data sheet, "1-Wire Quad A/D Converter"). */
#include <math.h>
#include <string.h>

#include "hal/sim/families.h"

/* Page 1, the second byte of a channel: input range, alarms enabled, alarms, power-on reset. */
enum { IR = 0x01, AEL = 0x04, AEH = 0x08, AFL = 0x10, AFH = 0x20, POR = 0x80 };
/* Its first byte: resolution in the lower four bits, output control, output enable. */
enum { OC = 0x40, OE = 0x80 };

enum { PAGE = 8, SIZE = 32, CONTROL = 8, LIMITS = 16 };

/* 80 us a bit and channel, and 160 us. */
#define BIT_NS INT64_C(80000)
#define START_NS INT64_C(160000)

struct ds2450 {
	uint8_t memory[SIZE];
	uint8_t channels; /* under conversion */
};

static void ds2450_power_on(struct sim_slave *slave)
{
	struct ds2450 *s = slave->state;

	memset(s, 0, sizeof(*s));
	for (unsigned i = 0; i < 4; i++) {
		s->memory[CONTROL + 2 * i] = 0x08;
		s->memory[CONTROL + 2 * i + 1] = POR | AEH | AEL;
		s->memory[LIMITS + 2 * i + 1] = 0xFF;
	}
}

static unsigned channel_bits(const struct ds2450 *s, unsigned channel)
{
	unsigned bits = s->memory[CONTROL + 2 * channel] & 15;

	return bits ? bits : 16;
}

/* The result is left-aligned, the bits not converted are 0. */
static void ds2450_measure(struct sim_slave *slave, unsigned channel)
{
	struct ds2450 *s = slave->state;
	uint8_t *control = &s->memory[CONTROL + 2 * channel],
		*limit = &s->memory[LIMITS + 2 * channel];
	double range = control[1] & IR ? 5.12 : 2.56;
	double part = floor(sim_input_now(slave, channel) / range * 65536);
	unsigned raw = (unsigned)sim_within(part, 0, 65535);

	if ((control[0] & (OE | OC)) == OE) /* the output transistor pulls the input down */
		raw = 0;
	raw &= 0xFFFFu << (16 - channel_bits(s, channel));
	sim_put(s->memory + 2 * channel, 2, raw);
	control[1] &= (uint8_t) ~(AFL | AFH);
	if (raw >> 8 < limit[0])
		control[1] |= AFL;
	if (raw >> 8 > limit[1])
		control[1] |= AFH;
}

static void ds2450_worked(struct sim_slave *slave)
{
	for (unsigned i = 0; i < 4; i++) {
		if (sim_state(slave, ds2450)->channels >> i & 1)
			ds2450_measure(slave, i);
	}
	slave->conversions++;
}

static bool ds2450_alarm(struct sim_slave *slave)
{
	const struct ds2450 *s = slave->state;

	for (unsigned i = 0; i < 4; i++) {
		uint8_t control = s->memory[CONTROL + 2 * i + 1];

		if ((control & POR) || ((control & AEL) && (control & AFL)) ||
		    ((control & AEH) && (control & AFH)))
			return true;
	}
	return false;
}

/* Send a page, then the checksum; the first one covers command and address too. */
static void send_memory(struct sim_slave *slave)
{
	sim_send_memory(slave, sim_state(slave, ds2450)->memory, SIZE, PAGE);
}

/* Send the checksum, then the byte as stored; then the host may write to the next address. */
static void write_memory(struct sim_slave *slave, uint8_t byte)
{
	struct ds2450 *s = slave->state;

	if (slave->address >= SIZE) {
		sim_end(slave);
		return;
	}
	if (slave->address >= PAGE) /* the results are read-only */
		s->memory[slave->address] = byte;
	sim_send_stored(slave, s->memory[slave->address]);
}

/* The conversion starts after the checksum, where a parasite needs the strong pull-up. */
static void ds2450_convert(struct sim_slave *slave)
{
	struct ds2450 *s = slave->state;
	int64_t takes = START_NS;

	s->channels = slave->taken[0] & 15;
	for (unsigned i = 0; i < 4; i++) {
		unsigned preset = slave->taken[1] >> (2 * i) & 3;

		if (s->channels >> i & 1)
			takes += BIT_NS * channel_bits(s, i);
		if (preset == 1 || preset == 2)
			memset(&s->memory[2 * i], preset == 1 ? 0 : 0xFF, 2);
	}
	sim_work(slave, takes);
}

static const struct sim_function functions[] = {
	{.code = 0xAA, .takes = 2, .start = send_memory, .next = send_memory}, /* Read Memory */
	{.code = 0x55, .takes = 2, .byte = write_memory, .next = sim_receive},
	{.code = 0x3C, .takes = 2, .start = sim_send_checksum, .next = ds2450_convert},
	{0},
};

static const struct sim_input inputs[] = {
	{.name = "volt.A"}, {.name = "volt.B"}, {.name = "volt.C"}, {.name = "volt.D"}, {0}};

const struct sim_family sim_ds2450 = {
	.name = "DS2450",
	.code = 0x20,
	.overdrive = true,
	.state_size = sizeof(struct ds2450),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2450_power_on,
	.alarm = ds2450_alarm,
	.worked = ds2450_worked,
};
