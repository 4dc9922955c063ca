/* SPDX-License-Identifier: MIT */
/*
 * DS1992, DS1993 (data sheet 102199), DS1995 and DS1996 (data sheet, "64kbit Memory iButton"):
 * memories with a battery. Nothing of theirs has a checksum.
 */
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

static const struct sim_function functions[] = {SIM_SCRATCHPAD_FUNCTIONS(0x55), {0}};

/* A copy takes 30 us. */
#define MEMORY(part, family, bytes, fast) \
	.name = (part), .code = (family), .overdrive = (fast), .functions = functions, \
	.kind = &(const struct sim_scratchpad_kind){.size = (bytes), \
	                                            .writable = (bytes), \
	                                            .page = 32, \
	                                            .copy_ns = 30000, \
	                                            .to_end = true, \
	                                            .plain = true}, \
	.state_size = sizeof(struct sim_scratchpad), .power_on = sim_scratchpad_power_on, \
	.bit = sim_scratchpad_bit, .worked = sim_scratchpad_worked, \
	SIM_MEMORY(sim_scratchpad, memory, bytes)

const struct sim_family sim_ds1992 = {MEMORY("DS1992", 0x08, 128, false)};
const struct sim_family sim_ds1993 = {MEMORY("DS1993", 0x06, 512, false)};
const struct sim_family sim_ds1995 = {MEMORY("DS1995", 0x0A, 2048, true)};
const struct sim_family sim_ds1996 = {MEMORY("DS1996", 0x0C, 8192, true)};
