/* SPDX-License-Identifier: MIT */
/*
 * DS2740: coulomb counter (data sheet, "High-Precision Coulomb Counter"). A step of its 16 bits is
 * 1.5625 uV; "vis_B" is the same of a DS2740B, whose 13 bits stand at the top of them.
 */
#include "hal/chips/batteries/gauge.h"

enum { STATUS = AFTER_GAUGE_AREAS, SPECIAL };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[STATUS] = GAUGE_REGISTER("status", 0x01),
	[SPECIAL] = GAUGE_REGISTER("special", 0x08),
};

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, VOLATILE, BOTH,
                 FIELD(SPECIAL, .shift = 6, .bits = 1, .inverted = true)),
	AREA_MEMORY(MEMORY, 256),
	GAUGE_BIT("smod", VOLATILE, BOTH, STATUS, 0, 6),
	GAUGE_WORD("vis", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_WORD("vis_B", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(36, "DS2740", PRESENCE,
            SCAN({"vis", "vis"}, {"volthours", "volthours"}, {"PIO", "switch"}), AREAS(areas),
            PROPERTIES(properties));
