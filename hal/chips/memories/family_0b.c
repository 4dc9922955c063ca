/* SPDX-License-Identifier: MIT */
/*
 * DS2505, DS2506 and, with contents from the factory, DS1985U and DS1986U: 16 and 64 kbit of EPROM
 * (data sheets, "16kbit Add-Only Memory", "64kbit Add-Only Memory"). It is programmed with pulses
 * of 12 V, which no adapter here gives: the areas have no row.
 */
#include "hal/chips/family.h"
#include "hal/chips/memories/eprom.h"

enum { MEMORY = 1, STATUS };

#define EPROM(part, pages) \
	static const struct area part##_memory = {EPROM_MEMORY(pages)}; \
	static const struct area part##_status = {EPROM_STATUS(pages)}; \
	static const struct area *const part##_areas[] = { \
		[MEMORY] = &part##_memory, [STATUS] = &part##_status}; \
	static const struct property part##_properties[] = { \
		AREA_MEMORY(MEMORY, 32 * (pages)), \
		PROPERTY_DIR("pages"), \
		AREA_PAGES(MEMORY, pages, 32), \
		PROPERTY_DIR("status"), \
		PROPERTY("status/page", BINARY, STABLE, BOTH, \
	                 ELEMENTS(EPROM_STATUS_PAGES, NUMBERS), .size = (pages) / 8, \
	                 FIELD(STATUS)), \
	};
#define EPROM_FAMILY(code_, text, part, flags_) \
	const struct family family_##code_ = {.code = 0x##code_, \
	                                      .proof = PROOF_CHECKSUM, \
	                                      .type = (text), \
	                                      .flags = (flags_), \
	                                      AREAS(part##_areas), \
	                                      PROPERTIES(part##_properties)};

EPROM(ds2505, 64)
EPROM(ds2506, 256)
EPROM_FAMILY(0b, "DS2505", ds2505, 0)
EPROM_FAMILY(8b, "DS1985U", ds2505, 0)
EPROM_FAMILY(0f, "DS2506", ds2506, FLAG_OVERDRIVE)
EPROM_FAMILY(8f, "DS1986U", ds2506, FLAG_OVERDRIVE)
