/* SPDX-License-Identifier: MIT */
/*
 * DS2760: battery gauge with protection (data sheet, "High-Precision Li+ Battery Monitor"). Recall
 * Data sets CE and DE to their defaults: so only what is written goes by way of the EEPROM, and
 * what is read is its shadow. A WS603 is a weather station with this chip: ws603.c.
 */
#include "hal/chips/batteries/gauge.h"
#include "hal/chips/batteries/ws603.h"

enum { PROTECTION = AFTER_GAUGE_AREAS, PINS_OF, SPECIAL };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[PROTECTION] = &gauge_protection,
	[PINS_OF] = &gauge_pins,
	[SPECIAL] = GAUGE_REGISTER("special", 0x08),
};

enum { WAY_PAGE = AFTER_GAUGE_WAYS, WAY_PMOD, WAY_SWEN, WAY_CURRENTBIAS, WAY_VBIAS, WAYS_WS603 };
#define BIAS(resistor) .at = 0x33, .is_signed = true, .unit = 15.625e-6 / (resistor)
static const struct property_how how[] = {
	GAUGE_WAYS,
	[WAY_PAGE] = {SET(EEPROM, .at = 0x20)},
	[WAY_PMOD] = {SET(EEPROM, .at = 0x31, .shift = 5, .bits = 1)},
	[WAY_SWEN] = {SET(EEPROM, .at = 0x31, .shift = 3, .bits = 1)},
	[WAY_CURRENTBIAS] = {SET(EEPROM, BIAS(GAUGE_RESISTOR))},
	[WAY_VBIAS] = {SET(EEPROM, BIAS(1))},
	WS603_WAYS(WAYS_WS603),
};

#define FLAG(text, area_, bit) GAUGE_BIT(text, VOLATILE, BOTH, area_, 0, bit)
#define STATUS(text, bit) GAUGE_BIT(text, STABLE, READ, BYTES, 0x01, bit)
#define SETTING(text, bit, way) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(BYTES, .at = 0x31, .shift = (bit), .bits = 1), \
	         .how = (way))

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, VOLATILE, WRITE,
                 FIELD(SPECIAL, .shift = 6, .bits = 1, .inverted = true)),
	WS603_PROPERTIES(WAYS_WS603, WORDS),
	GAUGE_AMPHOURS,
	FLAG("cc", PINS_OF, 3),
	FLAG("ce", PROTECTION, 1),
	FLAG("coc", PROTECTION, 5),
	GAUGE_WORD("current", 0x0e, GAUGE_COARSE / GAUGE_RESISTOR, GAUGE_CURRENT_COARSE),
	PROPERTY("currentbias", FLOAT, VOLATILE, BOTH, FIELD(BYTES, BIAS(GAUGE_RESISTOR)),
                 IN_UNIT("A"), .how = WAY_CURRENTBIAS),
	FLAG("dc", PINS_OF, 2),
	FLAG("de", PROTECTION, 0),
	SETTING("defaultpmod", 5, WAY_PMOD),
	SETTING("defaultswen", 3, WAY_SWEN),
	FLAG("doc", PROTECTION, 4),
	GAUGE_LOCK(2, 0x07, 0x3020),
	AREA_MEMORY(MEMORY, 256),
	GAUGE_BIT("mstr", VOLATILE, READ, BYTES, 0x08, 5),
	FLAG("ov", PROTECTION, 7),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(2, NUMBERS), .size = 16,
                 FIELD(MEMORY, .at = 0x20), .how = WAY_PAGE),
	STATUS("pmod", 5),
	GAUGE_BESIDE_PIO("ps", VOLATILE, SPECIAL, 7),
	GAUGE_BIT("sensed", VOLATILE, READ, BYTES, 0x08, 6),
	STATUS("swen", 3),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	FLAG("uv", PROTECTION, 6),
	PROPERTY("vbias", FLOAT, STABLE, BOTH, FIELD(BYTES, BIAS(1)), IN_UNIT("V"),
                 .how = WAY_VBIAS),
	GAUGE_WORD("vis", 0x0e, GAUGE_COARSE, GAUGE_VIS_COARSE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(30, "DS2760", PRESENCE,
            SCAN({"temperature", "temperature"}, {"volt", "volt"}, {"current", "current"},
                 {"amphours", "amphours"}, {"sensed", "input"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
