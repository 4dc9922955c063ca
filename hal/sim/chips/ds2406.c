/* SPDX-License-Identifier: MIT */
/* DS2406 (data sheet, "Dual Addressable Switch Plus 1Kb Memory"); its EPROM is not programmed. */
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/crc.h"
#include "hal/sim/pins.h"

enum { READ_MEMORY = 0xF0, WRITE_STATUS = 0x55, READ_STATUS = 0xAA, CHANNEL_ACCESS = 0xF5 };

/* Status byte 7. */
enum { POLARITY = 0x01, LATCH_A = 0x20, LATCH_B = 0x40, SUPPLY = 0x80 };
/* Channel control byte 1. */
enum { TOG = 0x20, IM = 0x40, ALR = 0x80 };

enum { MEMORY = 128, STATUS = 8 };

struct ds2406 {
	struct sim_pins pins;
	uint8_t memory[MEMORY], status[STATUS];
	uint8_t command, got, taken[3];
	uint16_t address, crc;
	/* Channel access. */
	uint8_t control;
	bool reading; /* the direction of this byte */
	unsigned bytes;
};

static struct ds2406 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2406);
}

static void create(struct sim_slave *slave)
{
	memset(state(slave)->memory, 0xFF, MEMORY);
	memset(state(slave)->status, 0xFF, 5);
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct ds2406 *s = state(slave);

	s->command = 0;
	s->status[7] = 0x1F;
	sim_pins_start(slave, &s->pins, 2, t);
}

static void advance(struct sim_slave *slave, int64_t t)
{
	sim_pins_follow(slave, &state(slave)->pins, t);
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

/* The channels selected, ORed, from the source selected, against the polarity. */
static bool alarm(struct sim_slave *slave, int64_t t)
{
	const struct ds2406 *s = state(slave);
	const uint8_t sources[4] = {0, s->pins.activity, s->pins.latch, s->pins.level};
	uint8_t channels = s->status[7] >> 3 & 3, source = sources[s->status[7] >> 1 & 3];

	(void)t;
	return ((source & channels) != 0) == (s->status[7] & POLARITY);
}

static uint8_t status(struct sim_slave *slave, unsigned at)
{
	const struct ds2406 *s = state(slave);

	if (at != 7)
		return s->status[at];
	return (uint8_t)((s->status[7] & 0x1F) | (s->pins.latch & 1 ? LATCH_A : 0) |
	                 (s->pins.latch & 2 ? LATCH_B : 0) | (slave->parasite ? 0 : SUPPLY));
}

static unsigned add_crc(struct ds2406 *s, uint8_t *out, unsigned n)
{
	s->crc = sim_crc16(s->crc, out, n);
	out[n++] = (uint8_t)~s->crc;
	out[n++] = (uint8_t)(~s->crc >> 8);
	s->crc = 0;
	return n;
}

/* A byte, and behind the last one the checksum over command, address and data. */
static void send_memory(struct sim_slave *slave, unsigned size)
{
	struct ds2406 *s = state(slave);
	uint8_t out[3];
	unsigned n = 1;

	if (s->address >= size) {
		sim_end(slave);
		return;
	}
	out[0] = s->command == READ_STATUS ? status(slave, s->address) : s->memory[s->address];
	if (++s->address == size)
		n = add_crc(s, out, 1);
	else
		s->crc = sim_crc16(s->crc, out, 1);
	sim_send(slave, out, n);
}

static void write_status(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2406 *s = state(slave);
	uint8_t out[2];

	if (s->address == 7) {
		s->status[7] = byte & 0x1F;
		sim_pins_write(slave, &s->pins, byte >> 5 & 3, t);
	}
	add_crc(s, out, 0);
	sim_send(slave, out, 2);
}

/* --- Channel access ---------------------------------------------------------------------------- */

static unsigned channels(const struct ds2406 *s)
{
	return s->control >> 2 & 3;
}

static uint8_t info(const struct sim_slave *slave)
{
	const struct ds2406 *s = slave->state;

	return (uint8_t)(s->pins.latch | s->pins.level << 2 | s->pins.activity << 4 | 0x40 |
	                 (slave->parasite ? 0 : 0x80));
}

static uint8_t sample(const struct ds2406 *s)
{
	bool a = s->pins.level & 1, b = s->pins.level & 2;

	switch (channels(s)) {
	case 1:
		return a ? 0xFF : 0;
	case 2:
		return b ? 0xFF : 0;
	default:
		return (uint8_t)((a ? 0x55 : 0) | (b ? 0xAA : 0));
	}
}

static void write_pins(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2406 *s = state(slave);
	uint8_t latch = s->pins.latch;

	/* Bit by bit; the last one for each channel stays. */
	if (channels(s) == 1)
		latch = (uint8_t)((latch & 2) | byte >> 7);
	else if (channels(s) == 2)
		latch = (uint8_t)((latch & 1) | (byte >> 7) << 1);
	else
		latch = byte >> 6;
	sim_pins_write(slave, &s->pins, latch, t);
}

static unsigned crc_every(const struct ds2406 *s)
{
	static const unsigned every[4] = {0, 1, 8, 32};

	return every[s->control & 3];
}

/* The next byte of the exchange, in its direction; with a checksum before it when one is due. */
static void next_byte(struct sim_slave *slave)
{
	struct ds2406 *s = state(slave);
	uint8_t out[3];
	unsigned n = 1;

	if (!s->reading) {
		sim_receive(slave);
		return;
	}
	out[0] = sample(s);
	s->bytes++;
	if (crc_every(s) && s->bytes % crc_every(s) == 0)
		n = add_crc(s, out, 1);
	else
		s->crc = sim_crc16(s->crc, out, 1);
	if (s->control & TOG)
		s->reading = false;
	sim_send(slave, out, n);
}

static void channel_received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2406 *s = state(slave);
	uint8_t out[2];

	s->crc = sim_crc16(s->crc, &byte, 1);
	if (s->got < 2) {
		s->taken[s->got++] = byte;
		if (s->got < 2)
			return;
		s->control = s->taken[0];
		s->reading = s->control & IM;
		s->bytes = 0;
		out[0] = info(slave);
		if (s->control & ALR)
			s->pins.activity = 0;
		if (channels(s) == 0) {
			sim_end(slave);
			return;
		}
		s->crc = sim_crc16(s->crc, out, 1);
		sim_send(slave, out, 1);
		return;
	}
	write_pins(slave, byte, t);
	s->bytes++;
	if (s->control & TOG)
		s->reading = true;
	if (crc_every(s) && s->bytes % crc_every(s) == 0) {
		add_crc(s, out, 0);
		sim_send(slave, out, 2);
	} else {
		next_byte(slave);
	}
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2406 *s = state(slave);

	if (s->command == CHANNEL_ACCESS) {
		channel_received(slave, byte, t);
		return;
	}
	s->crc = sim_crc16(s->command ? s->crc : 0, &byte, 1);
	if (s->command == 0) {
		s->command = byte;
		s->got = 0;
		if (byte != READ_MEMORY && byte != WRITE_STATUS && byte != READ_STATUS &&
		    byte != CHANNEL_ACCESS)
			sim_end(slave);
		return;
	}
	s->taken[s->got++] = byte;
	s->address = (uint16_t)(s->taken[0] | s->taken[1] << 8);
	if (s->got == 2 && s->command != WRITE_STATUS)
		send_memory(slave, s->command == READ_STATUS ? STATUS : MEMORY);
	else if (s->got == 3)
		write_status(slave, byte, t);
}

static void drained(struct sim_slave *slave, int64_t t)
{
	struct ds2406 *s = state(slave);

	(void)t;
	if (s->command == CHANNEL_ACCESS)
		next_byte(slave);
	else if (s->command == READ_STATUS)
		send_memory(slave, STATUS);
	else if (s->command == READ_MEMORY)
		send_memory(slave, MEMORY);
}

static uint8_t *memory(struct sim_slave *slave, size_t *size)
{
	*size = MEMORY;
	return state(slave)->memory;
}

static const struct sim_input inputs[] = {SIM_PIN("pin.A"), SIM_PIN("pin.B"), {0}};

const struct sim_family sim_ds2406 = {
	.name = "DS2406",
	.code = 0x12,
	.state_size = sizeof(struct ds2406),
	.inputs = inputs,
	.create = create,
	.power_on = power_on,
	.reset = reset,
	.alarm = alarm,
	.received = received,
	.drained = drained,
	.advance = advance,
	.memory = memory,
};
