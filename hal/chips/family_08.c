/* SPDX-License-Identifier: MIT */
/* DS1992: 1024 bits of memory with a battery (its data sheet, "Memory function commands"). */
#include "hal/chips/family.h"

static const struct area memory = {
	.name = "memory",
	.size = 128,
	.address_bytes = 2,
	.read = 0xf0,
	.row = 32,
	.write = 0x0f,
	.verify = 0xaa,
	.copy = 0x55,
};

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 32),
};

const struct family family_08 = {
	.code = 0x08, .type = "DS1992", AREAS(areas), PROPERTIES(properties)};
