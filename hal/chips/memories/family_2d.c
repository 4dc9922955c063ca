/* SPDX-License-Identifier: MIT */
/* DS2431: 1024 bits of EEPROM (data sheet 19-4675): rows of 8 bytes, 10 ms to copy one. */
#include "hal/chips/family.h"

static AREA_NAMED(memory, "memory", .size = 128, .address_bytes = 2, .read = 0xf0, .row = 8,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x55, .write_crc16 = true, .strong = true,
                  .copy_ns = 10 * TXN_MS);

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 32),
};

CHIP_FAMILY(2d, "DS2431", PRESENCE, .flags = FLAG_RESUME | FLAG_OVERDRIVE,
            SCAN({"present", "present"}), AREAS(areas), PROPERTIES(properties));
