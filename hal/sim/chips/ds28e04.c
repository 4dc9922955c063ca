/* SPDX-License-Identifier: MIT */
/*
 * DS28E04-100 (data sheet 19-6134): EEPROM, two pins with activity latches, conditional search.
 * Neither page protection nor PIO Access Pulse.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { MEMORY = 0x210, ID = 0x218, REGISTERS = 0x220, END = REGISTERS + SIM_PIN_REGISTERS };
enum { PIN_POL = 2 }; /* the input */

/* Sixteen pages of 32, and the register page; tPROG 10 ms. */
static const struct sim_scratchpad_kind kind = {
	.size = END, .writable = MEMORY, .page = 32, .copy_ns = 10 * NS_PER_MS};

static void ds28e04_create(struct sim_slave *slave)
{
	memset(sim_state(slave, sim_scratchpad)->memory, 0xFF, END);
}

/* POL says what the pins are after power-on. */
static void ds28e04_power_on(struct sim_slave *slave)
{
	struct sim_pins *pins = slave->state;
	bool pol = sim_input_now(slave, PIN_POL) >= 0.5;

	sim_scratchpad_power_on(slave);
	sim_pins_start(slave, 0, 2);
	pins->registers = REGISTERS;
	pins->control = (uint8_t)(SIM_PORL | (pol ? SIM_POL : 0));
	sim_pins_write(slave, pol ? 3 : 0);
	pins->activity = 0;
}

/* Send the memory and the registers, without a checksum. */
static void ds28e04_dump(struct sim_slave *slave)
{
	uint8_t *memory = sim_state(slave, sim_scratchpad)->memory;

	memcpy(memory + ID, slave->rom, 8);
	sim_pins_registers(slave, memory + REGISTERS);
	sim_scratchpad_dump(slave);
}

static const struct sim_function functions[] = {
	SIM_SCRATCHPAD_COMMANDS(0x55, ds28e04_dump),
	{SIM_PINS_WRITE(0x5A)}, /* PIO Access Write */
	SIM_PINS_REGISTER_FUNCTIONS,
	{0},
};

static const struct sim_input inputs[] = {
	{SIM_PIN("pin.0")}, {SIM_PIN("pin.1")}, [PIN_POL] = {SIM_PIN("pol")}, {0}};

const struct sim_family sim_ds28e04 = {
	.name = "DS28E04",
	.code = 0x1C,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct sim_scratchpad),
	.kind = &kind,
	.functions = functions,
	.inputs = inputs,
	.create = ds28e04_create,
	.power_on = ds28e04_power_on,
	.alarm = sim_pins_match,
	.bit = sim_scratchpad_bit,
	.worked = sim_scratchpad_worked,
	.advance = sim_pins_follow,
	SIM_MEMORY(sim_scratchpad, memory, MEMORY),
};
