/* SPDX-License-Identifier: MIT */
/* DS2431 (data sheet 19-4675) and DS2433 (19-5268): EEPROM. */
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/chips/scratchpad.h"

/* Four pages of 32, and the register page; tPROG 10 ms. */
static const struct sim_scratchpad_kind ds2431 = {
	.size = 0x90, .page = 8, .copy = 0x55, .copy_ns = 10000000, .whole = true};
/* Sixteen pages of 32; tPROG 5 ms. */
static const struct sim_scratchpad_kind ds2433 = {
	.size = 512, .page = 32, .copy = 0x55, .copy_ns = 5000000};

static void create(struct sim_slave *slave)
{
	struct sim_scratchpad *s = sim_state(slave, sim_scratchpad);

	s->kind = slave->family == &sim_ds2431 ? &ds2431 : &ds2433;
	memset(s->memory, 0xFF, sizeof(s->memory));
	if (s->kind == &ds2431) {
		memset(s->memory, 0, 0x85);
		s->memory[0x85] = 0xAA; /* factory byte */
	}
}

#define EEPROM(part, family) \
	{ \
		.name = (part), .code = (family), .overdrive = true, .resume = (family) == 0x2D, \
		.state_size = sizeof(struct sim_scratchpad), .create = create, \
		.power_on = sim_scratchpad_power_on, .reset = sim_scratchpad_reset, \
		.received = sim_scratchpad_received, .drained = sim_scratchpad_drained, \
		.bit = sim_scratchpad_bit, .advance = sim_scratchpad_advance, \
		.strong = sim_scratchpad_strong, .memory = sim_scratchpad_memory \
	}

const struct sim_family sim_ds2431 = EEPROM("DS2431", 0x2D);
const struct sim_family sim_ds2433 = EEPROM("DS2433", 0x23);
