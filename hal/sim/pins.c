/* SPDX-License-Identifier: MIT */
#include "hal/sim/pins.h"

static bool outside(const struct sim_slave *slave, unsigned pin, int64_t t)
{
	return sim_input_at(slave, pin, t) >= 0.5;
}

static uint8_t levels(const struct sim_slave *slave, const struct sim_pins *pins, int64_t t)
{
	unsigned level = 0;

	for (unsigned i = 0; i < pins->count; i++)
		level |= (unsigned)outside(slave, i, t) << i;
	return (uint8_t)(level & pins->latch);
}

/* Did the outside change and change back between two looks? Few jumps settle it. */
static bool jumped(const struct sim_slave *slave, unsigned pin, int64_t from, int64_t to)
{
	bool level = outside(slave, pin, from);

	for (unsigned i = 0; i < 2 * SIM_MAX_STEPS; i++) {
		from = sim_curve_next(&slave->input[pin], from);
		if (from > to)
			return false;
		if (outside(slave, pin, from) != level)
			return true;
	}
	return false;
}

void sim_pins_start(struct sim_slave *slave, struct sim_pins *pins, unsigned count, int64_t t)
{
	*pins = (struct sim_pins){.latch = (uint8_t)((1u << count) - 1), .count = count, .seen = t};
	pins->level = levels(slave, pins, t);
}

void sim_pins_follow(struct sim_slave *slave, struct sim_pins *pins, int64_t t)
{
	uint8_t level = levels(slave, pins, t);

	pins->activity |= level ^ pins->level;
	for (unsigned i = 0; i < pins->count; i++) {
		uint8_t mask = (uint8_t)(1u << i);

		if ((pins->latch & mask) && !(pins->activity & mask) &&
		    jumped(slave, i, pins->seen, t))
			pins->activity |= mask;
	}
	pins->level = level;
	pins->seen = t;
}

void sim_pins_write(struct sim_slave *slave, struct sim_pins *pins, uint8_t latch, int64_t t)
{
	pins->latch = latch;
	sim_pins_follow(slave, pins, t);
}
