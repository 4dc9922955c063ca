/* SPDX-License-Identifier: MIT */
/* DS2450 (data sheet, "1-Wire Quad A/D Converter"). */
#include <math.h>
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/crc.h"

enum { READ_MEMORY = 0xAA, WRITE_MEMORY = 0x55, CONVERT = 0x3C };

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
	uint8_t command, got, taken[2], channels;
	uint16_t address, crc;
	bool converting;
	int64_t until;
};

static struct ds2450 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2450);
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct ds2450 *s = state(slave);

	(void)t;
	memset(s, 0, sizeof(*s));
	for (unsigned i = 0; i < 4; i++) {
		s->memory[CONTROL + 2 * i] = 0x08;
		s->memory[CONTROL + 2 * i + 1] = POR | AEH | AEL;
		s->memory[LIMITS + 2 * i + 1] = 0xFF;
	}
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

static unsigned resolution(const struct ds2450 *s, unsigned channel)
{
	unsigned bits = s->memory[CONTROL + 2 * channel] & 15;

	return bits ? bits : 16;
}

/* The result is left-aligned, the bits not converted are 0. */
static void measure(struct sim_slave *slave, unsigned channel, int64_t t)
{
	struct ds2450 *s = state(slave);
	uint8_t *control = &s->memory[CONTROL + 2 * channel],
		*limit = &s->memory[LIMITS + 2 * channel];
	double range = control[1] & IR ? 5.12 : 2.56;
	double part = floor(sim_input_at(slave, channel, t) / range * 65536);
	unsigned raw = part < 0 ? 0 : part > 65535 ? 65535 : (unsigned)part;

	if ((control[0] & (OE | OC)) == OE) /* the output transistor pulls the input down */
		raw = 0;
	raw &= 0xFFFFu << (16 - resolution(s, channel));
	s->memory[2 * channel] = (uint8_t)raw;
	s->memory[2 * channel + 1] = (uint8_t)(raw >> 8);
	control[1] &= (uint8_t) ~(AFL | AFH);
	if (raw >> 8 < limit[0])
		control[1] |= AFL;
	if (raw >> 8 > limit[1])
		control[1] |= AFH;
}

static void advance(struct sim_slave *slave, int64_t t)
{
	struct ds2450 *s = state(slave);

	if (!s->converting || t < s->until)
		return;
	s->converting = false;
	for (unsigned i = 0; i < 4; i++) {
		if (s->channels >> i & 1)
			measure(slave, i, s->until);
	}
	slave->conversions++;
}

static bool alarm(struct sim_slave *slave, int64_t t)
{
	const struct ds2450 *s = state(slave);

	(void)t;
	for (unsigned i = 0; i < 4; i++) {
		uint8_t control = s->memory[CONTROL + 2 * i + 1];

		if ((control & POR) || ((control & AEL) && (control & AFL)) ||
		    ((control & AEH) && (control & AFH)))
			return true;
	}
	return false;
}

static bool bit(struct sim_slave *slave, int64_t t)
{
	(void)t;
	return !state(slave)->converting;
}

static unsigned add_crc(struct ds2450 *s, uint8_t *out, unsigned n)
{
	s->crc = sim_crc16(s->crc, out, n);
	out[n++] = (uint8_t)~s->crc;
	out[n++] = (uint8_t)(~s->crc >> 8);
	return n;
}

/* A byte, and behind a page the checksum: of the first over command and address too. */
static void send_memory(struct sim_slave *slave)
{
	struct ds2450 *s = state(slave);
	uint8_t out[3];
	unsigned n = 1;

	if (s->address >= SIZE) {
		sim_end(slave);
		return;
	}
	out[0] = s->memory[s->address++];
	if (s->address % PAGE == 0) {
		n = add_crc(s, out, 1);
		s->crc = 0;
	} else {
		s->crc = sim_crc16(s->crc, out, 1);
	}
	sim_send(slave, out, n);
}

/* The checksum, then the byte as it is stored; then the next address may be written. */
static void write_memory(struct sim_slave *slave, uint8_t byte)
{
	struct ds2450 *s = state(slave);
	uint8_t out[3];
	unsigned n;

	if (s->address >= SIZE) {
		sim_end(slave);
		return;
	}
	s->crc = sim_crc16(s->crc, &byte, 1);
	n = add_crc(s, out, 0);
	if (s->address >= PAGE) /* the results are read-only */
		s->memory[s->address] = byte;
	out[n++] = s->memory[s->address++];
	/* The next checksum starts with the next address. */
	s->crc = s->address;
	sim_send(slave, out, n);
}

static void convert_command(struct sim_slave *slave)
{
	uint8_t out[2];

	add_crc(state(slave), out, 0);
	sim_send(slave, out, 2);
}

/* It starts behind the checksum, where a parasite's strong pull-up comes too. */
static void convert(struct sim_slave *slave, int64_t t)
{
	struct ds2450 *s = state(slave);
	int64_t takes = START_NS;

	s->channels = s->taken[0] & 15;
	for (unsigned i = 0; i < 4; i++) {
		unsigned preset = s->taken[1] >> (2 * i) & 3;

		if (s->channels >> i & 1)
			takes += BIT_NS * resolution(s, i);
		if (preset == 1 || preset == 2)
			memset(&s->memory[2 * i], preset == 1 ? 0 : 0xFF, 2);
	}
	s->until = t + takes;
	s->converting = true;
	sim_send_bits(slave);
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2450 *s = state(slave);

	(void)t;
	if (s->command == 0) {
		s->command = byte;
		s->got = 0;
		s->crc = sim_crc16(0, &byte, 1);
		if (byte != READ_MEMORY && byte != WRITE_MEMORY && byte != CONVERT)
			sim_end(slave);
		return;
	}
	if (s->got == 2) {
		write_memory(slave, byte);
		return;
	}
	s->crc = sim_crc16(s->crc, &byte, 1);
	s->taken[s->got++] = byte;
	if (s->got < 2)
		return;
	s->address = (uint16_t)(s->taken[0] | s->taken[1] << 8);
	if (s->command == READ_MEMORY)
		send_memory(slave);
	else if (s->command == CONVERT)
		convert_command(slave);
}

static void drained(struct sim_slave *slave, int64_t t)
{
	switch (state(slave)->command) {
	case READ_MEMORY:
		send_memory(slave);
		break;
	case WRITE_MEMORY:
		sim_receive(slave);
		break;
	case CONVERT:
		convert(slave, t);
		break;
	}
}

static const struct sim_input inputs[] = {
	{.name = "volt.A"}, {.name = "volt.B"}, {.name = "volt.C"}, {.name = "volt.D"}, {0}};

const struct sim_family sim_ds2450 = {
	.name = "DS2450",
	.code = 0x20,
	.overdrive = true,
	.state_size = sizeof(struct ds2450),
	.inputs = inputs,
	.power_on = power_on,
	.reset = reset,
	.alarm = alarm,
	.received = received,
	.drained = drained,
	.bit = bit,
	.advance = advance,
};
