/* SPDX-License-Identifier: MIT */
/*
 * DS2751: battery gauge with a resistor inside (data sheet, "Multichemistry Battery Fuel
 * Gauge").
 */
#include "hal/chips/batteries/gauge.h"

enum { SPECIAL = AFTER_GAUGE_AREAS };
static const struct area *const areas[] = {
	GAUGE_AREAS, [SPECIAL] = GAUGE_REGISTER("special", 0x08)};
static const struct property_how how[] = {GAUGE_WAYS};

#define BIAS(text, life_, resistor, unit_) \
	PROPERTY(text, FLOAT, life_, BOTH, \
	         FIELD(EEPROM, .at = 0x33, .is_signed = true, .unit = 15.625e-6 / (resistor)), \
	         IN_UNIT(unit_))

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, VOLATILE, WRITE,
                 FIELD(SPECIAL, .shift = 6, .bits = 1, .inverted = true)),
	GAUGE_AMPHOURS,
	GAUGE_WORD("current", 0x0e, GAUGE_COARSE / GAUGE_RESISTOR, GAUGE_CURRENT_COARSE),
	BIAS("currentbias", VOLATILE, GAUGE_RESISTOR, "A"),
	GAUGE_BIT("defaultpmod", STABLE, BOTH, EEPROM, 0x31, 5),
	GAUGE_LOCK(2, 0x07, 0x3020),
	AREA_MEMORY(MEMORY, 256),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(2, NUMBERS), .size = 16,
                 FIELD(EEPROM, .at = 0x20)),
	GAUGE_BIT("pmod", STABLE, READ, BYTES, 0x01, 5),
	GAUGE_BESIDE_PIO("por", STABLE, SPECIAL, 0),
	GAUGE_BIT("sensed", VOLATILE, READ, BYTES, 0x08, 6),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	/* the status register has it from the EEPROM */
	GAUGE_BIT("uven", STABLE, BOTH, EEPROM, 0x31, 3),
	BIAS("vbias", STABLE, 1, "V"),
	GAUGE_WORD("vis", 0x0e, GAUGE_COARSE, GAUGE_VIS_COARSE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(51, "DS2751", PRESENCE,
            SCAN({"temperature", "temperature"}, {"volt", "volt"}, {"current", "current"},
                 {"amphours", "amphours"}, {"sensed", "input"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
