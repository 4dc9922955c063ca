/* SPDX-License-Identifier: MIT */
/* DS2433: 4 kbit of EEPROM (data sheet 2433): rows of 32 bytes, 5 ms to copy one. */
#include "hal/chips/memory.h"

/* clang-format off */
static const struct chip_memory memory = {
	.size = 512, .page = 32, .row = 32, .copy = 0x55, .checks = false, .strong = true,
	.copy_ns = 5 * TXN_MS,
};
/* clang-format on */

static const struct property properties[] = {
	MEMORY_WHOLE(512, memory_write),
	MEMORY_PAGES(16, 32, memory_write_page),
};

/* clang-format off */
const struct family family_23 = {
	.code = 0x23, .type = "DS2433", .memory = &memory, PROPERTIES(properties),
};
/* clang-format on */
