/* SPDX-License-Identifier: MIT */
/* DS2413: two switches. */
#include "hal/chips/family.h"
#include "hal/chips/pio.h"

static const struct area latches = {PIO_LATCHES(0x5a)};

static const struct property properties[] = {
	PIO_BITS("PIO", BOTH, PIO_READ(PIO_OUTPUTS, true), PIO_SET(latches)),
	PROPERTY("piostate", UNSIGNED, VOLATILE, BOTH, .hidden = true, .digits = "3",
                 PIO_READ(PIO_STATE, false), SET(latches)),
	PIO_BITS("sensed", READ, PIO_READ(PIO_PINS, false)),
};

const struct family family_3a = {.code = 0x3a, .type = "DS2413", PROPERTIES(properties)};
