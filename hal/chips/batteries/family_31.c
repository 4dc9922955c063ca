/* SPDX-License-Identifier: MIT */
/*
 * DS2720: protection of a lithium-ion cell (data sheet, "Efficient, Addressable Single-Cell
 * Rechargeable Lithium Protection IC"): registers, and two blocks of EEPROM that can be locked.
 */
#include "hal/chips/batteries/gauge.h"

#define PINS 0x0c /* of the protection register: CC and DC mirror the pins */

/* The pins follow at once, and are nothing that was written. */
static int saw_protection(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	bytes[0] &= (uint8_t)~PINS;
	return 0;
}

static const struct area protection = {
	.name = "protection",
	.size = 1,
	GAUGE_WRITE(1),
	.saw = saw_protection,
};
static const struct area pins = {.name = "pins", .size = 1, GAUGE_READ};
static const struct area special = {.name = "special", .at = 8, .size = 1, GAUGE_WRITE(1)};
static const struct area eeprom = {.name = "EEPROM", .size = 0x34, GAUGE_STORED(4)};

enum { PROTECTION = AFTER_GAUGE_AREAS, PINS_OF, SPECIAL, BLOCKS };
static const struct area *const areas[] = {
	GAUGE_AREAS,          [PROTECTION] = &protection, [PINS_OF] = &pins,
	[SPECIAL] = &special, [BLOCKS] = &eeprom,
};
static const struct property_how how[] = {GAUGE_WAYS};

#define FLAG(text, area_, shift_) \
	PROPERTY(text, YESNO, VOLATILE, BOTH, FIELD(area_, .shift = (shift_), .bits = 1))

static const struct property properties[] = {
	FLAG("cc", PINS_OF, 3),
	FLAG("ce", PROTECTION, 1),
	FLAG("dc", PINS_OF, 2),
	FLAG("de", PROTECTION, 0),
	FLAG("doc", PROTECTION, 4),
	GAUGE_LOCK(2, 0x07, 0x3020),
	AREA_MEMORY(MEMORY, 256),
	FLAG("ot", SPECIAL, 0),
	FLAG("ov", PROTECTION, 7),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(2, NUMBERS), .size = 4,
                 FIELD(BLOCKS, .at = 0x20, .stride = 0x10)),
	FLAG("psf", SPECIAL, 7),
	FLAG("uv", PROTECTION, 6),
};

const struct family family_31 = {
	.code = 0x31,
	.proof = PROOF_PRESENCE,
	.type = "DS2720",
	SCAN({"present", "present"}),
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
