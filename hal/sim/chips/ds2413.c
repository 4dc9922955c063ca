/* SPDX-License-Identifier: MIT */
/* DS2413 (data sheet 19-5709): two pins. */
#include "hal/sim/families.h"
#include "hal/sim/pins.h"

static void ds2413_power_on(struct sim_slave *slave)
{
	sim_pins_start(slave, 0, 2);
}

/*
 * A program that plays one, as OneWireHub: the status once; no confirmation of a write. It sends
 * the complement itself while the master writes it, and does not compare.
 */
static void send_once(struct sim_slave *slave)
{
	sim_pins_send(slave);
}

static void say_nothing(struct sim_slave *slave)
{
	sim_end(slave);
}

static void send_complement(struct sim_slave *slave)
{
	sim_send_byte(slave, (uint8_t)~slave->taken[0]);
}

static void take(struct sim_slave *slave)
{
	sim_pins_write(slave, slave->taken[0] & 3);
	sim_end(slave);
}

static const struct sim_function functions[] = {{SIM_PINS_READ(0xF5)}, {SIM_PINS_WRITE(0x5A)}, {0}};
static const struct sim_function emulated[] = {
	{.code = 0xF5, .start = send_once, .next = say_nothing},
	{.code = 0x5A, .takes = 1, .start = send_complement, .next = take},
	{0},
};
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

const struct sim_family sim_ds2413_emulated = {
	.name = "DS2413-EMULATED",
	.code = 0x3A,
	.state_size = sizeof(struct sim_pins),
	.functions = emulated,
	.inputs = inputs,
	.power_on = ds2413_power_on,
	.advance = sim_pins_follow,
};
