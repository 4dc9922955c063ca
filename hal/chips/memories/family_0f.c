/* SPDX-License-Identifier: MIT */
/*
 * DS2506 and, with contents from the factory, DS1986U: 64 kbit of EPROM (data sheet, "64kbit
 * Add-Only Memory"). It is programmed with pulses of 12 V, which no adapter here gives: the areas
 * have no row.
 */
#include "hal/chips/family.h"
#include "hal/chips/memories/eprom.h"

static const struct area memory = {EPROM_MEMORY(256)};
static const struct area status = {EPROM_STATUS(256)};

enum { MEMORY = 1, STATUS };
static const struct area *const areas[] = {[MEMORY] = &memory, [STATUS] = &status};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 8192),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 256, 32),
	PROPERTY_DIR("status"),
	PROPERTY("status/page", BINARY, STABLE, BOTH, ELEMENTS(EPROM_STATUS_PAGES, NUMBERS),
                 .size = 32, FIELD(STATUS)),
};

const struct family family_0f = {.code = 0x0f,
                                 .proof = PROOF_CHECKSUM,
                                 .type = "DS2506",
                                 .flags = FLAG_OVERDRIVE,
                                 AREAS(areas),
                                 PROPERTIES(properties)};
const struct family family_8f = {.code = 0x8f,
                                 .proof = PROOF_CHECKSUM,
                                 .type = "DS1986U",
                                 .flags = FLAG_OVERDRIVE,
                                 AREAS(areas),
                                 PROPERTIES(properties)};
