/* SPDX-License-Identifier: MIT */
/* DS28EC20: 20 kbit of EEPROM (data sheet 19-6067): rows of 32 bytes, 10 ms to copy one. */
#include "hal/chips/family.h"

static AREA_NAMED(memory, "memory", .size = 2560, .address_bytes = 2, .read = 0xa5, .block = 32,
                  .check = AREA_CRC16, .row = 32, .write = 0x0f, .verify = 0xaa, .copy = 0x55,
                  .write_crc16 = true, .strong = true, .copy_ns = 10 * TXN_MS);

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 2560),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 80, 32),
};

CHIP_FAMILY(43, "DS28EC20", CHECKSUM, .flags = FLAG_RESUME | FLAG_OVERDRIVE,
            SCAN({"present", "present"}), AREAS(areas), PROPERTIES(properties));
