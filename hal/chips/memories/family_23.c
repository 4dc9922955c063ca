/* SPDX-License-Identifier: MIT */
/* DS2433: 4 kbit of EEPROM (data sheet 2433): rows of 32 bytes, 5 ms to copy one. */
#include "hal/chips/family.h"

static AREA_NAMED(memory, "memory", .size = 512, .address_bytes = 2, .read = 0xf0, .row = 32,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x55, .strong = true,
                  .copy_ns = 5 * TXN_MS);

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 512),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 16, 32),
};

CHIP_FAMILY(23, "DS2433", PRESENCE, .flags = FLAG_OVERDRIVE, SCAN({"present", "present"}),
            AREAS(areas), PROPERTIES(properties));
