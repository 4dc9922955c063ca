/* SPDX-License-Identifier: MIT */
/*
 * DS2502: 1 kbit of EPROM (data sheet 19-5076), read by pages that have a CRC8 each. It is
 * programmed with pulses of 12 V, which no adapter here gives: the area has no row.
 */
#include "hal/chips/family.h"

static const struct area memory = {
	.name = "memory",
	.size = 128,
	.address_bytes = 2,
	.read = 0xc3,
	.block = 32,
	.check = AREA_CRC8_PAGES,
};

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 32),
};

const struct family family_09 = {.code = 0x09,
                                 .proof = PROOF_PRESENCE,
                                 .type = "DS2502",
                                 SCAN({"present", "present"}),
                                 AREAS(areas),
                                 PROPERTIES(properties)};
