/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight pins, activity latches, conditional search. */
#include <string.h>

#include "hal/sim/families.h"
#include "hal/sim/pins.h"

enum { REGISTERS = 0x88, END = 0x90 }; /* "Figure 4" */

static void ds2408_power_on(struct sim_slave *slave)
{
	struct sim_pins *s = slave->state;

	sim_pins_start(slave, 0, 8);
	s->registers = REGISTERS;
	s->control = SIM_PORL;
}

static bool ds2408_alarm(struct sim_slave *slave)
{
	return (sim_state(slave, sim_pins)->control & SIM_PORL) || sim_pins_match(slave);
}

/* Send the bytes up to the last register; then the checksum, of command and address too. */
static void send_registers(struct sim_slave *slave)
{
	uint8_t all[END];

	memset(all, 0xFF, sizeof(all));
	sim_pins_registers(slave, all + REGISTERS);
	if (slave->address < REGISTERS)
		sim_end(slave);
	else
		sim_send_memory(slave, all, END, END);
}

static const struct sim_function functions[] = {
	/* Read PIO Registers, Channel Access Write */
	{.code = 0xF0, .takes = 2, .start = send_registers, .next = send_registers},
	{SIM_PINS_WRITE(0x5A)},
	SIM_PINS_REGISTER_FUNCTIONS,
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
	.state_size = sizeof(struct sim_pins),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2408_power_on,
	.alarm = ds2408_alarm,
	.advance = sim_pins_follow,
};
