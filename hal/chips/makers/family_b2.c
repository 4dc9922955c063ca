/* SPDX-License-Identifier: MIT */
/* Analog input mAM001: 10,000 is 10 V or 20 mA, as its switches are set. */
#include "hal/chips/makers/cmciel.h"

static const struct area *const areas[] = {CMCIEL_AREAS};

static const struct property properties[] = {
	PROPERTY("current", FLOAT, VOLATILE, READ, FIELD(READING, .bytes = 2, .unit = 2e-6),
                 MEASURES(0, .131072, 6, "A")),
	CMCIEL_READING,
	PROPERTY("volts", FLOAT, VOLATILE, READ, FIELD(READING, .bytes = 2, .unit = 0.001),
                 MEASURES(0, 65.536, 3, "V")),
};

CHIP_FAMILY(b2, "mAM001", PRESENCE, SCAN({"volts", "volt"}, {"current", "current"}), AREAS(areas),
            PROPERTIES(properties));
