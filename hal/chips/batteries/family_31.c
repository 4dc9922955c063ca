/* SPDX-License-Identifier: MIT */
/*
 * DS2720: protection of a lithium-ion cell (data sheet, "Efficient, Addressable Single-Cell
 * Rechargeable Lithium Protection IC"): registers, and two blocks of EEPROM that can be locked.
 */
#include "hal/chips/batteries/gauge.h"

enum { PROTECTION = AFTER_GAUGE_AREAS, PINS_OF, SPECIAL, BLOCKS };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[PROTECTION] = &gauge_protection,
	[PINS_OF] = &gauge_pins,
	[SPECIAL] = GAUGE_REGISTER("special", 0x08),
	[BLOCKS] = AREA(.name = "EEPROM", .size = 0x34, GAUGE_STORED(4)),
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

CHIP_FAMILY(31, "DS2720", PRESENCE, SCAN({"present", "present"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
