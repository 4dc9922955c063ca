/* SPDX-License-Identifier: MIT */
/*
 * DS1992, DS1993 (data sheet 102199), DS1995 and DS1996 (data sheet, "64kbit Memory iButton"):
 * memories with a battery. Nothing of theirs has a checksum.
 */
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

/* A copy takes 30 us. */
#define KIND(bytes) \
	{ \
		.size = (bytes), .writable = (bytes), .page = 32, .copy_ns = 30000, \
		.to_end = true, .plain = true \
	}

static const struct sim_scratchpad_kind ds1992 = KIND(128);
static const struct sim_scratchpad_kind ds1993 = KIND(512);
static const struct sim_scratchpad_kind ds1995 = KIND(2048);
static const struct sim_scratchpad_kind ds1996 = KIND(8192);

static void ds1993_create(struct sim_slave *slave)
{
	struct sim_scratchpad *s = sim_state(slave, sim_scratchpad);

	switch (slave->family->code) {
	case 0x06:
		s->kind = &ds1993;
		break;
	case 0x08:
		s->kind = &ds1992;
		break;
	case 0x0A:
		s->kind = &ds1995;
		break;
	default:
		s->kind = &ds1996;
		break;
	}
}

static const struct sim_function functions[] = {SIM_SCRATCHPAD_FUNCTIONS(0x55), {0}};

#define MEMORY(part, family, fast) \
	{ \
		.name = (part), .code = (family), .overdrive = (fast), .functions = functions, \
		.state_size = sizeof(struct sim_scratchpad), .create = ds1993_create, \
		.power_on = sim_scratchpad_power_on, .bit = sim_scratchpad_bit, \
		.worked = sim_scratchpad_worked, .memory = sim_scratchpad_memory \
	}

const struct sim_family sim_ds1992 = MEMORY("DS1992", 0x08, false);
const struct sim_family sim_ds1993 = MEMORY("DS1993", 0x06, false);
const struct sim_family sim_ds1995 = MEMORY("DS1995", 0x0A, true);
const struct sim_family sim_ds1996 = MEMORY("DS1996", 0x0C, true);
