/* SPDX-License-Identifier: MIT */
/*
 * DS2505 and, with contents from the factory, DS1985U: 16 kbit of EPROM (data sheet, "16kbit
 * Add-Only Memory"). It is programmed with pulses of 12 V, which no adapter here gives: the areas
 * have no row.
 */
#include "hal/chips/family.h"
#include "hal/chips/memories/eprom.h"

static const struct area memory = {EPROM_MEMORY(64)};
static const struct area status = {EPROM_STATUS(64)};

enum { MEMORY = 1, STATUS };
static const struct area *const areas[] = {[MEMORY] = &memory, [STATUS] = &status};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 2048),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 64, 32),
	PROPERTY_DIR("status"),
	PROPERTY("status/page", BINARY, STABLE, BOTH, ELEMENTS(EPROM_STATUS_PAGES, NUMBERS),
                 .size = 8, FIELD(STATUS)),
};

const struct family family_0b = {.code = 0x0b,
                                 .proof = PROOF_CHECKSUM,
                                 .type = "DS2505",
                                 AREAS(areas),
                                 PROPERTIES(properties)};
const struct family family_8b = {.code = 0x8b,
                                 .proof = PROOF_CHECKSUM,
                                 .type = "DS1985U",
                                 AREAS(areas),
                                 PROPERTIES(properties)};
