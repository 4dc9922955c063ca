/* SPDX-License-Identifier: MIT */
/*
 * MAX31825: a thermometer of 8 to 12 bits with alarm limits of two bytes and a location address by
 * resistors. It answers with the family code of the DS1825. Its data sheet could not be had: codes,
 * registers and times are facts of the drivers that its maker published (Zephyr's max31825.c, the
 * MAX Essential Toolkit). They say nothing of the first temperature (here 0), of the busy slots
 * (here as in its relatives), and of Read Power Supply (here unknown to the chip). Not simulated:
 * conversions by itself, overdrive.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

/* Configuration and status. */
enum { EXTENDED = 0x80, INTERRUPT = 0x10, TH_FAULT = 0x80, TL_FAULT = 0x40, ADDRESS = 0x3F };
enum { CONFIG = 3, TH = 4, TL = 6 }; /* TH begins with its high byte, TL with its low one */

struct max31825 {
	uint8_t scratchpad[8];
	uint8_t address, faults;
};

static void max31825_power_on(struct sim_slave *slave)
{
	struct max31825 *s = slave->state;
	static const uint8_t first[8] = {0, 0, 0, 0x60, 0x07, 0xFF, 0x90, 0xFC};

	memcpy(s->scratchpad, first, 8);
	s->faults = 0;
}

static void max31825_convert(struct sim_slave *slave)
{
	static const uint8_t ms[] = {30, 40, 70, 160};

	sim_work(slave, ms[sim_state(slave, max31825)->scratchpad[CONFIG] >> 5 & 3] * NS_PER_MS);
}

static void max31825_worked(struct sim_slave *slave)
{
	static const uint8_t unused[] = {4, 3, 2, 0};
	struct max31825 *s = slave->state;
	const uint8_t *pad = s->scratchpad;
	int most = pad[CONFIG] & EXTENDED ? 145 * 16 : 2047;
	int raw = sim_within(sim_input_now(slave, 0) * 16, -55 * 16, most);

	raw &= ~((1 << unused[pad[CONFIG] >> 5 & 3]) - 1);
	if (!(pad[CONFIG] & INTERRUPT))
		s->faults = 0;
	if (raw > (int16_t)(pad[TH] << 8 | pad[TH + 1]))
		s->faults |= TH_FAULT;
	if (raw < (int16_t)(pad[TL + 1] << 8 | pad[TL]))
		s->faults |= TL_FAULT;
	sim_put(s->scratchpad, 2, raw);
	slave->conversions++;
}

static void max31825_read_scratchpad(struct sim_slave *slave)
{
	struct max31825 *s = slave->state;

	s->scratchpad[2] = s->faults | s->address;
	if (s->scratchpad[CONFIG] & INTERRUPT)
		s->faults = 0;
	sim_send_crc8(slave, s->scratchpad, 8);
}

static void max31825_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	unsigned at = CONFIG + slave->address++;

	sim_state(slave, max31825)->scratchpad[at] = at == CONFIG ? byte & 0xF7 : byte;
	if (at == 7)
		sim_end(slave);
}

/* Another function follows, for the chips with this location address only. */
static void select_address(struct sim_slave *slave)
{
	if ((slave->taken[0] & ADDRESS) != sim_state(slave, max31825)->address) {
		sim_end(slave);
		return;
	}
	slave->function = NULL;
	sim_receive(slave);
}

static const struct sim_function functions[] = {
	{.code = 0x44, .start = max31825_convert},
	{.code = 0xBE, .start = max31825_read_scratchpad},
	{.code = 0x4E, .byte = max31825_write_scratchpad},
	{.code = 0x88, .start = sim_end}, /* The resistors are as they were at power-on. */
	{.code = 0x70, .takes = 1, .start = select_address},
	{0},
};

static bool max31825_alarm(struct sim_slave *slave)
{
	return sim_state(slave, max31825)->faults != 0;
}

static const struct sim_input inputs[] = {
	{.name = "temperature", .start = 20, .least = -55, .most = 145},
	{0},
};

static const struct sim_option options[] = {SIM_OPTION(max31825, "address", 0, ADDRESS, address),
                                            {0}};

const struct sim_family sim_max31825 = {
	.name = "MAX31825",
	.code = 0x3B,
	.starves = true,
	.state_size = sizeof(struct max31825),
	.inputs = inputs,
	.functions = functions,
	.power_on = max31825_power_on,
	.alarm = max31825_alarm,
	.worked = max31825_worked,
	.options = options,
};
