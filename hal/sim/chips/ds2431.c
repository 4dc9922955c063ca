/* SPDX-License-Identifier: MIT */
/* DS2431 (data sheet 19-4675), DS2433 (19-5268) and DS28EC20 (19-5235): EEPROM. */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

/* Four pages of 32, and the register page; tPROG 10 ms. */
static const struct sim_scratchpad_kind ds2431 = {
	.size = 0x90, .writable = 0x90, .page = 8, .copy_ns = 10 * NS_PER_MS, .whole = true};
/* Sixteen pages of 32; tPROG 5 ms. */
static const struct sim_scratchpad_kind ds2433 = {
	.size = 512, .writable = 512, .page = 32, .copy_ns = 5 * NS_PER_MS};
/* Eighty pages of 32, the register page, a page that is read-only; tPROG 10 ms. */
static const struct sim_scratchpad_kind ds28ec20 = {.size = 0xA40,
                                                    .writable = 0xA20,
                                                    .page = 32,
                                                    .copy_ns = 10 * NS_PER_MS,
                                                    .to_end = true,
                                                    .sequence = true};

static void ds2431_create(struct sim_slave *slave)
{
	uint8_t *memory = sim_state(slave, sim_scratchpad)->memory;

	switch (slave->family->code) {
	case 0x2D:
		memory[0x85] = 0xAA; /* factory byte */
		memset(memory + 0x86, 0xFF, 0x90 - 0x86);
		break;
	case 0x43:
		memset(memory, 0xFF, 0xA00);
		memory[0xA20] = 0x55; /* factory byte */
		break;
	default:
		memset(memory, 0xFF, 512);
		break;
	}
}

static const struct sim_function functions[] = {SIM_SCRATCHPAD_FUNCTIONS(0x55), {0}};
static const struct sim_function ds28ec20_functions[] = {
	SIM_SCRATCHPAD_FUNCTIONS(0x55),
	/* Extended Read Memory */
	{SIM_SCRATCHPAD_PAGES},
	{0},
};

#define EEPROM(part, family, sizes, bytes, commands) \
	.name = (part), .code = (family), .overdrive = true, .functions = (commands), \
	.resume = (family) != 0x23, .state_size = sizeof(struct sim_scratchpad), .kind = &(sizes), \
	.create = ds2431_create, .power_on = sim_scratchpad_power_on, .bit = sim_scratchpad_bit, \
	.worked = sim_scratchpad_worked, SIM_MEMORY(sim_scratchpad, memory, bytes)

const struct sim_family sim_ds2431 = {EEPROM("DS2431", 0x2D, ds2431, 0x90, functions)};
const struct sim_family sim_ds2433 = {EEPROM("DS2433", 0x23, ds2433, 512, functions)};
const struct sim_family sim_ds28ec20 = {
	EEPROM("DS28EC20", 0x43, ds28ec20, 0xA40, ds28ec20_functions)};
