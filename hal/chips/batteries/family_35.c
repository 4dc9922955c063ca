/* SPDX-License-Identifier: MIT */
/*
 * DS2755: battery gauge. Its data sheet could not be had: registers as in the DS2756 (data sheet,
 * "High-Accuracy Battery Fuel Gauge"); alarm_set and the bits of the status as OWFS has them.
 */
#include "hal/chips/batteries/gauge.h"

enum { SPECIAL = AFTER_GAUGE_AREAS, ALARM, EEPROM32 };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[EEPROM32] = AREA(.name = "EEPROM", .size = 128, GAUGE_STORED(32)),
	[SPECIAL] = GAUGE_REGISTER("special", 0x08),
	[ALARM] = GAUGE_REGISTER("alarm", 0x85),
};
static const struct property_how how[] = {GAUGE_WAYS};

/* The status register has them from the EEPROM. */
#define SETTING(text, bit) GAUGE_BIT(text, STABLE, BOTH, EEPROM32, 0x31, bit)
#define STATUS(text, bit) GAUGE_BIT(text, STABLE, READ, BYTES, 0x01, bit)

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, VOLATILE, WRITE,
                 FIELD(SPECIAL, .shift = 6, .bits = 1, .inverted = true)),
	PROPERTY("alarm_set", FLOAT, VOLATILE, BOTH, FIELD(ALARM, .is_signed = true)),
	SETTING("defaultpmod", 5),
	SETTING("ios", 2),
	GAUGE_LOCK(3, 0x07, 0x604020),
	AREA_MEMORY(MEMORY, 256),
	SETTING("ovd", 0),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(3, NUMBERS), .size = 32,
                 FIELD(EEPROM32, .at = 0x20)),
	STATUS("pie0", 6),
	STATUS("pie1", 7),
	STATUS("pmod", 5),
	GAUGE_BESIDE_PIO("por", STABLE, SPECIAL, 7),
	STATUS("rnaop", 4),
	GAUGE_BIT("sensed", VOLATILE, READ, BYTES, 0x08, 6),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	SETTING("uben", 1),
	SETTING("uven", 3),
	PROPERTY("vbias", FLOAT, STABLE, BOTH,
                 FIELD(EEPROM32, .at = 0x33, .is_signed = true, .unit = 1.95e-6), IN_UNIT("V")),
	GAUGE_WORD("vis", 0x0e, GAUGE_COARSE, GAUGE_VIS_COARSE),
	GAUGE_WORD("vis_avg", 0x1a, 1.953e-6, GAUGE_VIS_COARSE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(35, "DS2755", PRESENCE, .flags = FLAG_ALARM,
            SCAN({"temperature", "temperature"}, {"volt", "volt"}, {"vis", "vis"},
                 {"volthours", "volthours"}, {"sensed", "input"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
