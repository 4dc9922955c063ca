/* SPDX-License-Identifier: MIT */
/*
 * DS28E04-100 (data sheet 19-6134): EEPROM, two pins with activity latches, conditional search.
 * Neither page protection nor PIO Access Pulse.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { LOGIC = 0x220, LATCH, ACTIVITY, MASK, POLARITY, CONTROL, END };
/* Control/status register. */
enum { PLS = 0x01, CT = 0x02, PORL = 0x08, POL = 0x40, VCCP = 0x80 };
enum { PIN_POL = 2 }; /* the input */

#define SAMPLES 32 /* between two checksums of PIO Access Read */

struct ds28e04 {
	struct sim_scratchpad memory; /* first */
	uint8_t mask, polarity, control;
};

/* Sixteen pages of 32, and the register page; tPROG 10 ms. */
static const struct sim_scratchpad_kind kind = {
	.size = END, .writable = 0x210, .page = 32, .copy_ns = 10 * NS_PER_MS};

static void ds28e04_create(struct sim_slave *slave)
{
	memset(sim_state(slave, ds28e04)->memory.memory, 0xFF, END);
}

/* POL says what the pins are after power-on. */
static void ds28e04_power_on(struct sim_slave *slave)
{
	struct ds28e04 *s = slave->state;
	bool pol = sim_input_now(slave, PIN_POL) >= 0.5;

	s->mask = s->polarity = 0;
	s->control = (uint8_t)(PORL | (pol ? POL : 0));
	sim_scratchpad_power_on(slave);
	sim_pins_start(slave, 0, 2);
	sim_pins_write(slave, pol ? 3 : 0);
	s->memory.pins.activity = 0;
}

static bool ds28e04_alarm(struct sim_slave *slave)
{
	const struct ds28e04 *s = slave->state;
	const struct sim_pins *pins = &s->memory.pins;
	uint8_t source = s->control & PLS ? pins->activity : pins->level;
	uint8_t match = (uint8_t) ~(source ^ s->polarity) & s->mask;

	return s->control & CT ? match == s->mask && s->mask : match;
}

/* Send the memory and the registers, without a checksum. */
static void dump(struct sim_slave *slave)
{
	struct ds28e04 *s = slave->state;
	uint8_t *memory = s->memory.memory;

	memcpy(memory + 0x218, slave->rom, 8);
	memory[LOGIC] = s->memory.pins.level;
	memory[LATCH] = s->memory.pins.latch;
	memory[ACTIVITY] = s->memory.pins.activity;
	memory[MASK] = s->mask;
	memory[POLARITY] = s->polarity;
	memory[CONTROL] = (uint8_t)(s->control | (slave->parasite ? 0 : VCCP));
	sim_scratchpad_dump(slave);
}

static uint8_t pin_status(struct sim_slave *slave)
{
	return sim_state(slave, ds28e04)->memory.pins.level | 0xFC;
}

/* Send a sample. The address counts the samples. */
static void send_sample(struct sim_slave *slave)
{
	uint8_t sample = pin_status(slave);

	if (slave->address++ % SAMPLES == SAMPLES - 1)
		sim_send_checked(slave, &sample, 1);
	else
		sim_send_byte(slave, sample);
}

static void send_first_sample(struct sim_slave *slave)
{
	slave->address = 0;
	send_sample(slave);
}

/* The latches were taken: send the pins as they are now, and receive the next two bytes. */
static void taken(struct sim_slave *slave)
{
	if (slave->got == 2) {
		slave->got = 3;
		sim_send_byte(slave, pin_status(slave));
	} else {
		sim_pins_taken(slave);
	}
}

static void check_register(struct sim_slave *slave)
{
	if (slave->address < MASK || slave->address > CONTROL)
		sim_end(slave);
}

static void write_register(struct sim_slave *slave, uint8_t byte)
{
	struct ds28e04 *s = slave->state;

	switch (slave->address++) {
	case MASK:
		s->mask = byte & 3;
		break;
	case POLARITY:
		s->polarity = byte & 3;
		break;
	case CONTROL: /* PORL can be cleared, not set */
		s->control = (uint8_t)((byte & (PLS | CT)) | (s->control & (POL | (byte & PORL))));
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
	sim_state(slave, ds28e04)->memory.pins.activity = 0;
	confirm(slave);
}

static const struct sim_function functions[] = {
	{.code = 0x0F, .takes = 2, .start = sim_scratchpad_target, .byte = sim_scratchpad_write},
	{.code = 0xAA, .start = sim_scratchpad_read},
	{.code = 0x55, .takes = 3, .start = sim_scratchpad_copy},
	{.code = 0xF0, .takes = 2, .start = dump, .next = dump},
	/* PIO Access Read and Write, Write Register, Reset Activity Latches */
	{.code = 0xF5, .start = send_first_sample, .next = send_sample},
	{.code = 0x5A, .takes = 2, .start = sim_pins_take, .next = taken},
	{.code = 0xCC, .takes = 2, .start = check_register, .byte = write_register},
	{.code = 0xC3, .start = reset_activity, .next = confirm},
	{0},
};

static const struct sim_input inputs[] = {
	{SIM_PIN("pin.0")}, {SIM_PIN("pin.1")}, [PIN_POL] = {SIM_PIN("pol")}, {0}};

const struct sim_family sim_ds28e04 = {
	.name = "DS28E04",
	.code = 0x1C,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds28e04),
	.kind = &kind,
	.functions = functions,
	.inputs = inputs,
	.create = ds28e04_create,
	.power_on = ds28e04_power_on,
	.alarm = ds28e04_alarm,
	.bit = sim_scratchpad_bit,
	.worked = sim_scratchpad_worked,
	.advance = sim_pins_follow,
	SIM_MEMORY(ds28e04, memory.memory, 0x210),
};
