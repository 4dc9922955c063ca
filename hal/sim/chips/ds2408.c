/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight pins, activity latches, conditional search. */
#include <string.h>

#include "hal/sim/families.h"
#include "hal/sim/pins.h"

/* Register addresses, "Figure 4". */
enum { LOGIC = 0x88, LATCH, ACTIVITY, MASK, POLARITY, CONTROL, END = 0x90 };
/* Control/status register. */
enum { PLS = 0x01, CT = 0x02, ROS = 0x04, PORL = 0x08, VCCP = 0x80 };

#define SAMPLES 32 /* between two checksums of Channel Access Read */

struct ds2408 {
	struct sim_pins pins;
	uint8_t mask, polarity, control;
};

static void ds2408_power_on(struct sim_slave *slave)
{
	*sim_state(slave, ds2408) = (struct ds2408){.control = PORL};
	sim_pins_start(slave, 0, 8);
}

static bool alarm(struct sim_slave *slave)
{
	const struct ds2408 *s = slave->state;
	uint8_t source = s->control & PLS ? s->pins.activity : s->pins.level;
	uint8_t match = (uint8_t) ~(source ^ s->polarity) & s->mask;

	if (s->control & PORL)
		return true;
	if (s->control & CT)
		return match == s->mask && s->mask;
	return match;
}

/* Send the bytes up to the last register; then the checksum, of command and address too. */
static void send_registers(struct sim_slave *slave)
{
	const struct ds2408 *s = slave->state;
	uint8_t all[END];

	memset(all, 0xFF, sizeof(all));
	all[LOGIC] = s->pins.level;
	all[LATCH] = s->pins.latch;
	all[ACTIVITY] = s->pins.activity;
	all[MASK] = s->mask;
	all[POLARITY] = s->polarity;
	all[CONTROL] = (uint8_t)(s->control | (slave->parasite ? 0 : VCCP));
	if (slave->address < LOGIC)
		sim_end(slave);
	else
		sim_send_memory(slave, all, END, END);
}

/* Send a sample. The address counts the samples. */
static void send_sample(struct sim_slave *slave)
{
	const struct ds2408 *s = slave->state;

	if (slave->address++ % SAMPLES == SAMPLES - 1)
		sim_send_checked(slave, &s->pins.level, 1);
	else
		sim_send_byte(slave, s->pins.level);
}

static void send_first_sample(struct sim_slave *slave)
{
	slave->address = 0;
	send_sample(slave);
}

static void check_condition(struct sim_slave *slave)
{
	if (slave->address < MASK || slave->address > CONTROL)
		sim_end(slave);
}

static void write_condition(struct sim_slave *slave, uint8_t byte)
{
	struct ds2408 *s = slave->state;

	switch (slave->address++) {
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

static void confirm(struct sim_slave *slave)
{
	sim_send_byte(slave, 0xAA);
}

static void reset_activity(struct sim_slave *slave)
{
	sim_state(slave, ds2408)->pins.activity = 0;
	confirm(slave);
}

static const struct sim_function functions[] = {
	/* Read PIO Registers, Channel Access Read and Write */
	{.code = 0xF0, .takes = 2, .start = send_registers, .next = send_registers},
	{.code = 0xF5, .start = send_first_sample, .next = send_sample},
	{SIM_PINS_WRITE(0x5A)},
	/* Write Conditional Search Register, Reset Activity Latches */
	{.code = 0xCC, .takes = 2, .start = check_condition, .byte = write_condition},
	{.code = 0xC3, .start = reset_activity, .next = confirm},
	{0},
};

static const struct sim_input inputs[] = {
	{SIM_PIN("pin.0")}, {SIM_PIN("pin.1")}, {SIM_PIN("pin.2")},
	{SIM_PIN("pin.3")}, {SIM_PIN("pin.4")}, {SIM_PIN("pin.5")},
	{SIM_PIN("pin.6")}, {SIM_PIN("pin.7")}, {0},
};

const struct sim_family sim_ds2408 = {
	.name = "DS2408",
	.code = 0x29,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds2408),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2408_power_on,
	.alarm = alarm,
	.advance = sim_pins_follow,
};
