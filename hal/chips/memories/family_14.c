/* SPDX-License-Identifier: MIT */
/* DS2430A (data sheet 19-5235): 32 bytes of EEPROM, and 8 that can be written once. */
#include "hal/chips/family.h"

#define KEY 0xa5

static AREA_NAMED(memory, "memory", .size = 32, .address_bytes = 1, .read = 0xf0, .row = 32,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x55, .key = KEY, .strong = true,
                  .copy_ns = 10 * TXN_MS);
static const struct area application = {
	.name = "application",
	.size = 8,
	.address_bytes = 1,
	.read = 0xc3,
	.row = 8,
	.write = 0x99,
	.verify = 0xc3, /* AAh has the scratchpad of the memory, not that of the register */
	.copy = 0x5a,
	.key = KEY,
	.strong = true,
	.copy_ns = 10 * TXN_MS,
};

enum { MEMORY = 1, APPLICATION, STATUS };
static const struct area *const areas[] = {
	[MEMORY] = &memory,
	[APPLICATION] = &application,
	[STATUS] = AREA(.name = "status", .size = 1, .address_bytes = 1, .read = 0x66),
};

static const struct property properties[] = {
	PROPERTY("application", BINARY, STABLE, BOTH, .size = 8, FIELD(APPLICATION)),
	AREA_MEMORY(MEMORY, 32),
	PROPERTY("status", UNSIGNED, STABLE, READ, FIELD(STATUS)),
};

CHIP_FAMILY(14, "DS2430A", PRESENCE, SCAN({"present", "present"}), AREAS(areas),
            PROPERTIES(properties));
