/* SPDX-License-Identifier: MIT */
/*
 * DS2405 (data sheet, "Addressable Switch"): no function commands. Match ROM turns the output over;
 * then, as after a search that ended here, read slots give the pin's level. The conditional
 * search is answered while the output is on.
 */
#include "hal/sim/families.h"
#include "hal/sim/pins.h"

static void ds2405_power_on(struct sim_slave *slave)
{
	sim_pins_start(slave, 0, 1);
}

static void ds2405_selected(struct sim_slave *slave, bool match)
{
	if (match)
		sim_pins_write(slave, sim_state(slave, sim_pins)->latch ^ 1);
	sim_send_bits(slave);
}

static bool ds2405_alarm(struct sim_slave *slave)
{
	return !(sim_state(slave, sim_pins)->latch & 1);
}

static bool ds2405_bit(struct sim_slave *slave)
{
	return sim_state(slave, sim_pins)->level & 1;
}

static const struct sim_input inputs[] = {{SIM_PIN("pin")}, {0}};

const struct sim_family sim_ds2405 = {
	.name = "DS2405",
	.code = 0x05,
	.state_size = sizeof(struct sim_pins),
	.inputs = inputs,
	.power_on = ds2405_power_on,
	.selected = ds2405_selected,
	.alarm = ds2405_alarm,
	.bit = ds2405_bit,
	.advance = sim_pins_follow,
};
