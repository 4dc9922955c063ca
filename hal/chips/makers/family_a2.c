/* SPDX-License-Identifier: MIT */
/* Alternating current sensor mCM001. */
#include "hal/chips/makers/cmciel.h"

static const struct area *const areas[] = {CMCIEL_AREAS};

static const struct property properties[] = {
	PROPERTY("current", FLOAT, VOLATILE, READ, FIELD(READING, .bytes = 2, .unit = 0.01),
                 MEASURES(0, 655.35, 2, "A")),
	CMCIEL_READING,
};

CHIP_FAMILY(a2, "mCM001", PRESENCE, SCAN({"current", "current"}), AREAS(areas),
            PROPERTIES(properties));
