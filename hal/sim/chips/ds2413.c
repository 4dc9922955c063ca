/* SPDX-License-Identifier: MIT */
/* DS2413 (data sheet 19-5709): two pins. */
#include "hal/sim/families.h"
#include "hal/sim/pins.h"

static void ds2413_power_on(struct sim_slave *slave)
{
	sim_pins_start(slave, 0, 2);
}

static const struct sim_function functions[] = {{SIM_PINS_READ(0xF5)}, {SIM_PINS_WRITE(0x5A)}, {0}};
static const struct sim_input inputs[] = {{SIM_PIN("pin.A")}, {SIM_PIN("pin.B")}, {0}};

const struct sim_family sim_ds2413 = {
	.name = "DS2413",
	.code = 0x3A,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct sim_pins),
	.functions = functions,
	.inputs = inputs,
	.power_on = ds2413_power_on,
	.advance = sim_pins_follow,
};
