/* SPDX-License-Identifier: MIT */
/* DS2780: battery gauge that computes capacities (data sheet, "Standalone Fuel Gauge IC"). */
#include "hal/chips/batteries/gauge.h"

enum { STATUS = AFTER_GAUGE_AREAS, SPECIAL, PARAMETERS };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[STATUS] = GAUGE_REGISTER("status", 0x01),
	[SPECIAL] = GAUGE_REGISTER("special", 0x15),
	[PARAMETERS] = &gauge_parameters,
};
static const struct property_how how[] = {GAUGE_WAYS};

/* The control register is the first byte of the parameters in the EEPROM. */
#define SETTING(text, bit) GAUGE_BIT(text, VOLATILE, BOTH, PARAMETERS, 0, bit)
#define FLAG(text, bit) GAUGE_BIT(text, VOLATILE, BOTH, STATUS, 0, bit)

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, VOLATILE, WRITE, FIELD(SPECIAL, .bits = 1, .inverted = true)),
	FLAG("aef", 6),
	FLAG("chgtf", 7),
	SETTING("dc", 3),
	FLAG("learnf", 4),
	GAUGE_LOCK(2, 0x1f, 0x6020),
	AREA_MEMORY(MEMORY, 256),
	SETTING("nben", 7),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(2, NUMBERS), .size = 16,
                 FIELD(EEPROM, .at = 0x20, .stride = 0x40)),
	SETTING("pmod", 5),
	FLAG("porf", 1),
	SETTING("rnaop", 4),
	FLAG("sef", 5),
	GAUGE_BIT("sensed", VOLATILE, READ, BYTES, 0x15, 0),
	GAUGE_TEMPERATURE(0x0a),
	GAUGE_COUPLES(0x0a, 1),
	SETTING("uven", 6),
	FLAG("uvf", 2),
	PROPERTY("vbias", FLOAT, STABLE, BOTH,
                 FIELD(PARAMETERS, .at = 1, .is_signed = true, .unit = GAUGE_FINE), IN_UNIT("V")),
	GAUGE_WORD("vis", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_WORD("vis_avg", 0x08, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(32, "DS2780", PRESENCE,
            SCAN({"temperature", "temperature"}, {"volt", "volt"}, {"vis", "vis"},
                 {"volthours", "volthours"}, {"sensed", "input"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
