/* SPDX-License-Identifier: MIT */
/*
 * The pins that a switch drives and that are driven from outside, and the commands that read and
 * write them.
 */
#include "hal/sim/pins.h"

static bool outside(const struct sim_slave *slave, unsigned input, int64_t t)
{
	return sim_input_at(slave, input, t) >= 0.5;
}

static uint8_t levels(const struct sim_slave *slave)
{
	const struct sim_pins *pins = slave->state;
	unsigned level = 0;

	for (unsigned i = 0; i < pins->count; i++)
		level |= (unsigned)outside(slave, pins->first + i, slave->now) << i;
	return (uint8_t)(level & pins->latch);
}

/* Did the input change and change back between two looks? A few jumps are enough to find it. */
static bool jumped(const struct sim_slave *slave, unsigned input, int64_t from, int64_t to)
{
	bool level = outside(slave, input, from);

	for (unsigned i = 0; i < 2 * SIM_MAX_STEPS; i++) {
		from = sim_curve_next(&slave->input[input], from);
		if (from > to)
			return false;
		if (outside(slave, input, from) != level)
			return true;
	}
	return false;
}

void sim_pins_start(struct sim_slave *slave, unsigned first, unsigned count)
{
	struct sim_pins *s = slave->state;

	*s = (struct sim_pins){.latch = (uint8_t)((1u << count) - 1),
	                       .first = first,
	                       .count = count,
	                       .seen = slave->now};
	s->level = levels(slave);
}

void sim_pins_follow(struct sim_slave *slave)
{
	struct sim_pins *pins = slave->state;
	uint8_t level = levels(slave);

	pins->activity |= level ^ pins->level;
	for (unsigned i = 0; i < pins->count; i++) {
		uint8_t mask = (uint8_t)(1u << i);

		if ((pins->latch & mask) && !(pins->activity & mask) &&
		    jumped(slave, pins->first + i, pins->seen, slave->now))
			pins->activity |= mask;
	}
	pins->level = level;
	pins->seen = slave->now;
}

void sim_pins_write(struct sim_slave *slave, uint8_t latch)
{
	sim_state(slave, sim_pins)->latch = latch;
	sim_pins_follow(slave);
}

/* A bit for each pin. */
static uint8_t each_pin(const struct sim_pins *pins)
{
	return (uint8_t)((1u << pins->count) - 1);
}

/* The level of each pin, and ones where there is none. */
static uint8_t levels_in_byte(const struct sim_slave *slave)
{
	const struct sim_pins *pins = slave->state;

	return pins->level | (uint8_t)~each_pin(pins);
}

/* Send two pins as pin A, latch A, pin B, latch B, and their complement above; or a sample. */
void sim_pins_send(struct sim_slave *slave)
{
	const struct sim_pins *pins = slave->state;
	unsigned low = (pins->level & 1) | (pins->latch & 1) << 1 | (pins->level & 2) << 1 |
	               (pins->latch & 2) << 2;

	sim_send_byte(slave,
	              pins->registers ? levels_in_byte(slave) : (uint8_t)(low | (~low & 15) << 4));
}

/* Take new latches and their complement, and answer AAh, */
void sim_pins_take(struct sim_slave *slave)
{
	if ((slave->taken[0] ^ slave->taken[1]) != 0xFF) {
		sim_end(slave);
		return;
	}
	sim_pins_write(slave, slave->taken[0] & each_pin(slave->state));
	sim_pins_confirm(slave);
}

/* then send the pins as they are now, and receive the next two bytes. */
void sim_pins_taken(struct sim_slave *slave)
{
	if (slave->got == 2) {
		slave->got = 3;
		sim_pins_send(slave);
	} else {
		slave->got = 0;
		sim_receive(slave);
	}
}

/* --- The registers --------------------------------------------------------------------------- */

#define SAMPLES 32 /* between two checksums */

void sim_pins_registers(const struct sim_slave *slave, uint8_t out[SIM_PIN_REGISTERS])
{
	const struct sim_pins *pins = slave->state;

	out[SIM_LOGIC] = pins->level;
	out[SIM_LATCH] = pins->latch;
	out[SIM_ACTIVITY] = pins->activity;
	out[SIM_MASK] = pins->mask;
	out[SIM_POLARITY] = pins->polarity;
	out[SIM_CONTROL] = (uint8_t)(pins->control | (slave->parasite ? 0 : SIM_VCCP));
}

bool sim_pins_match(struct sim_slave *slave)
{
	const struct sim_pins *pins = slave->state;
	uint8_t source = pins->control & SIM_PLS ? pins->activity : pins->level;
	uint8_t match = (uint8_t) ~(source ^ pins->polarity) & pins->mask;

	return pins->control & SIM_CT ? match == pins->mask && pins->mask : match;
}

/* The address counts the samples. */
void sim_pins_sample(struct sim_slave *slave)
{
	sim_send_next(slave, levels_in_byte(slave), SAMPLES);
}

void sim_pins_check_condition(struct sim_slave *slave)
{
	unsigned first = sim_state(slave, sim_pins)->registers;

	if (slave->address < first + SIM_MASK || slave->address > first + SIM_CONTROL)
		sim_end(slave);
}

void sim_pins_write_condition(struct sim_slave *slave, uint8_t byte)
{
	struct sim_pins *pins = slave->state;
	uint8_t writable = SIM_PLS | SIM_CT | (pins->count == 8 ? SIM_ROS : 0);

	switch (slave->address++ & 7) {
	case SIM_MASK:
		pins->mask = byte & each_pin(pins);
		break;
	case SIM_POLARITY:
		pins->polarity = byte & each_pin(pins);
		break;
	case SIM_CONTROL:
		pins->control = (uint8_t)((byte & writable) |
		                          (pins->control & (SIM_POL | (byte & SIM_PORL))));
		sim_end(slave);
		break;
	}
}

void sim_pins_confirm(struct sim_slave *slave)
{
	sim_send_byte(slave, 0xAA);
}

void sim_pins_reset_activity(struct sim_slave *slave)
{
	sim_state(slave, sim_pins)->activity = 0;
	sim_pins_confirm(slave);
}
