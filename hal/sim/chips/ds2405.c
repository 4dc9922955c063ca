/* SPDX-License-Identifier: MIT */
/*
 * DS2405 (data sheet, "Addressable Switch"): no function commands. Match ROM turns the output over;
 * then, as after a search that ended here, read slots give the pin's level. The conditional
 * search is answered while the output is on.
 */
#include "hal/sim/families.h"
#include "hal/sim/pins.h"

static struct sim_pins *pins(struct sim_slave *slave)
{
	return sim_state(slave, sim_pins);
}

static void ds2405_power_on(struct sim_slave *slave, int64_t t)
{
	sim_pins_start(slave, 0, 1, t);
}

static void selected(struct sim_slave *slave, bool match, int64_t t)
{
	if (match)
		sim_pins_write(slave, pins(slave)->latch ^ 1, t);
	sim_send_bits(slave);
}

static bool alarm(struct sim_slave *slave, int64_t t)
{
	(void)t;
	return !(pins(slave)->latch & 1);
}

static bool ds2405_bit(struct sim_slave *slave, int64_t t)
{
	(void)t;
	return pins(slave)->level & 1;
}

static const struct sim_input inputs[] = {SIM_PIN("pin"), {0}};

const struct sim_family sim_ds2405 = {
	.name = "DS2405",
	.code = 0x05,
	.state_size = sizeof(struct sim_pins),
	.inputs = inputs,
	.power_on = ds2405_power_on,
	.selected = selected,
	.alarm = alarm,
	.bit = ds2405_bit,
	.advance = sim_pins_follow,
};
