/* SPDX-License-Identifier: MIT */
/* Alternating current sensor mCM001. */
#include "hal/chips/makers/cmciel.h"

static const struct area *const areas[] = {CMCIEL_AREAS};

static const struct property properties[] = {
	PROPERTY("current", FLOAT, VOLATILE, READ, FIELD(READING, .bytes = 2, .unit = 0.01),
                 MEASURES(0, 655.35, 2, "A")),
	CMCIEL_READING,
};

const struct family family_a2 = {
	.code = 0xa2,
	.proof = PROOF_PRESENCE,
	.type = "mCM001",
	SCAN({"current", "current"}),
	AREAS(areas),
	PROPERTIES(properties),
};
