/* SPDX-License-Identifier: MIT */
/*
 * DS1992, DS1993, DS1995, DS1996: memory with a battery, alike but for its size (their data sheets,
 * "Memory function commands").
 */
#include "hal/chips/family.h"

enum { MEMORY = 1, PAGE = 32 };

#define MEMORY_FAMILY(code_, part, pages, flags_) \
	static const struct area memory_##code_ = { \
		.name = "memory", \
		.size = (pages)*PAGE, \
		.address_bytes = 2, \
		.read = 0xf0, \
		.row = PAGE, \
		.write = 0x0f, \
		.verify = 0xaa, \
		.copy = 0x55, \
	}; \
	static const struct area *const areas_##code_[] = {[MEMORY] = &memory_##code_}; \
	static const struct property properties_##code_[] = { \
		AREA_MEMORY(MEMORY, (pages)*PAGE), \
		PROPERTY_DIR("pages"), \
		AREA_PAGES(MEMORY, (pages), PAGE), \
	}; \
	const struct family family_##code_ = {.code = 0x##code_, \
	                                      .proof = PROOF_PRESENCE, \
	                                      .type = (part), \
	                                      .flags = (flags_), \
	                                      AREAS(areas_##code_), \
	                                      PROPERTIES(properties_##code_)};

MEMORY_FAMILY(06, "DS1993", 16, 0)
MEMORY_FAMILY(08, "DS1992", 4, 0)
MEMORY_FAMILY(0a, "DS1995", 64, FLAG_OVERDRIVE)
MEMORY_FAMILY(0c, "DS1996", 256, FLAG_OVERDRIVE)
