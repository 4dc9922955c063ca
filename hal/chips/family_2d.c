/* SPDX-License-Identifier: MIT */
/* DS2431: 1024 bits of EEPROM (data sheet 19-4675): rows of 8 bytes, 10 ms to copy one. */
#include "hal/chips/memory.h"

/* clang-format off */
static const struct chip_memory memory = {
	.size = 128, .page = 32, .row = 8, .copy = 0x55, .checks = true, .strong = true,
	.copy_ns = 10 * TXN_MS,
};
/* clang-format on */

static const struct property properties[] = {
	MEMORY_WHOLE(128, memory_write),
	MEMORY_PAGES(4, 32, memory_write_page),
};

/* clang-format off */
const struct family family_2d = {
	.code = 0x2d, .type = "DS2431", .memory = &memory, PROPERTIES(properties),
};
/* clang-format on */
