/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight pins, activity latches, conditional search. */
#include <errno.h>
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/crc.h"
#include "hal/sim/pins.h"

enum {
	READ_REGISTERS = 0xF0,
	READ_CHANNELS = 0xF5,
	WRITE_CHANNELS = 0x5A,
	WRITE_CONDITION = 0xCC,
	RESET_ACTIVITY = 0xC3,
};

/* Register addresses, "Figure 4". */
enum { LOGIC = 0x88, LATCH, ACTIVITY, MASK, POLARITY, CONTROL, LAST = 0x8F };
/* Control/status register. */
enum { PLS = 0x01, CT = 0x02, ROS = 0x04, PORL = 0x08, VCCP = 0x80 };

#define SAMPLES 32 /* between two checksums of Channel Access Read */

struct ds2408 {
	struct sim_pins pins;
	uint8_t mask, polarity, control;
	uint8_t command, got, taken[3];
	uint16_t address, crc;
	unsigned sampled;
};

static struct ds2408 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2408);
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct ds2408 *s = state(slave);

	memset(s, 0, sizeof(*s));
	sim_pins_start(slave, &s->pins, 8, t);
	s->control = PORL;
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

static bool alarm(struct sim_slave *slave, int64_t t)
{
	const struct ds2408 *s = state(slave);
	uint8_t source = s->control & PLS ? s->pins.activity : s->pins.level;
	uint8_t match = (uint8_t) ~(source ^ s->polarity) & s->mask;

	(void)t;
	if (s->control & PORL)
		return true;
	if (s->control & CT)
		return match == s->mask && s->mask;
	return match;
}

static uint8_t read_register(struct sim_slave *slave, unsigned address)
{
	const struct ds2408 *s = state(slave);

	switch (address) {
	case LOGIC:
		return s->pins.level;
	case LATCH:
		return s->pins.latch;
	case ACTIVITY:
		return s->pins.activity;
	case MASK:
		return s->mask;
	case POLARITY:
		return s->polarity;
	case CONTROL:
		return (uint8_t)(s->control | (slave->parasite ? 0 : VCCP));
	default:
		return 0xFF;
	}
}

/* A byte, and behind the last register the inverted CRC16 over command, address and data. */
static void send_registers(struct sim_slave *slave)
{
	struct ds2408 *s = state(slave);
	uint8_t out[3];

	out[0] = read_register(slave, s->address);
	s->crc = sim_crc16(s->crc, out, 1);
	if (s->address++ < LAST) {
		sim_send(slave, out, 1);
		return;
	}
	out[1] = (uint8_t)~s->crc;
	out[2] = (uint8_t)(~s->crc >> 8);
	s->command = 0;
	sim_send(slave, out, 3);
}

static void send_sample(struct sim_slave *slave)
{
	struct ds2408 *s = state(slave);
	uint8_t out[3] = {s->pins.level};

	s->crc = sim_crc16(s->crc, out, 1);
	if (++s->sampled < SAMPLES) {
		sim_send(slave, out, 1);
		return;
	}
	out[1] = (uint8_t)~s->crc;
	out[2] = (uint8_t)(~s->crc >> 8);
	s->crc = 0;
	s->sampled = 0;
	sim_send(slave, out, 3);
}

static void write_channels(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2408 *s = state(slave);

	s->taken[s->got++] = byte;
	if (s->got < 2)
		return;
	if ((s->taken[0] ^ s->taken[1]) != 0xFF) {
		sim_end(slave);
		return;
	}
	sim_pins_write(slave, &s->pins, s->taken[0], t);
	sim_send_byte(slave, 0xAA);
}

static void write_condition(struct sim_slave *slave, uint8_t byte)
{
	struct ds2408 *s = state(slave);

	if (s->got < 2) {
		s->address |= (uint16_t)(byte << (8 * s->got++));
		if (s->got == 2 && (s->address < MASK || s->address > CONTROL))
			sim_end(slave);
		return;
	}
	switch (s->address++) {
	case MASK:
		s->mask = byte;
		break;
	case POLARITY:
		s->polarity = byte;
		break;
	case CONTROL: /* PORL can be cleared, not set */
		s->control = (uint8_t)((byte & (PLS | CT | ROS)) | (s->control & byte & PORL));
		sim_end(slave);
		break;
	}
}

static void read_registers(struct sim_slave *slave, uint8_t byte)
{
	struct ds2408 *s = state(slave);

	s->address |= (uint16_t)(byte << (8 * s->got++));
	s->crc = sim_crc16(s->crc, &byte, 1);
	if (s->got < 2)
		return;
	if (s->address < LOGIC || s->address > LAST)
		sim_end(slave);
	else
		send_registers(slave);
}

static void command(struct sim_slave *slave, uint8_t byte)
{
	struct ds2408 *s = state(slave);

	s->command = byte;
	s->got = 0;
	s->address = 0;
	s->sampled = 0;
	s->crc = sim_crc16(0, &byte, 1);
	switch (byte) {
	case READ_REGISTERS:
	case WRITE_CHANNELS:
	case WRITE_CONDITION:
		break;
	case READ_CHANNELS:
		send_sample(slave);
		break;
	case RESET_ACTIVITY:
		s->pins.activity = 0;
		sim_send_byte(slave, 0xAA);
		break;
	default:
		sim_end(slave);
		break;
	}
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	switch (state(slave)->command) {
	case READ_REGISTERS:
		read_registers(slave, byte);
		break;
	case WRITE_CHANNELS:
		write_channels(slave, byte, t);
		break;
	case WRITE_CONDITION:
		write_condition(slave, byte);
		break;
	default:
		command(slave, byte);
		break;
	}
}

static void drained(struct sim_slave *slave, int64_t t)
{
	struct ds2408 *s = state(slave);

	(void)t;
	switch (s->command) {
	case READ_REGISTERS:
		send_registers(slave);
		break;
	case READ_CHANNELS:
		send_sample(slave);
		break;
	case RESET_ACTIVITY:
		sim_send_byte(slave, 0xAA);
		break;
	case WRITE_CHANNELS: /* AAh, the new state of the pins, and the next byte */
		if (s->got == 2) {
			s->got = 3;
			sim_send_byte(slave, s->pins.level);
		} else {
			s->got = 0;
			sim_receive(slave);
		}
		break;
	}
}

static const struct sim_input inputs[] = {
	SIM_PIN("pin.0"), SIM_PIN("pin.1"), SIM_PIN("pin.2"),
	SIM_PIN("pin.3"), SIM_PIN("pin.4"), SIM_PIN("pin.5"),
	SIM_PIN("pin.6"), SIM_PIN("pin.7"), {0},
};

const struct sim_family sim_ds2408 = {
	.name = "DS2408",
	.code = 0x29,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds2408),
	.inputs = inputs,
	.power_on = power_on,
	.reset = reset,
	.alarm = alarm,
	.received = received,
	.drained = drained,
	.advance = advance,
};
