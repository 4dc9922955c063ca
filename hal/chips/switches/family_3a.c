/* SPDX-License-Identifier: MIT */
/* DS2413: two switches. */
#include "hal/chips/family.h"
#include "hal/chips/switches/pio.h"

enum { STATUS = 1, LATCHES };
static const struct area *const areas[] = {
	[STATUS] = &pio_status,
	[LATCHES] = AREA(PIO_LATCHES(0x5a)),
};

enum { WAY_PIO = 1, WAY_STATE };
static const struct property_how how[] = {
	[WAY_PIO] = {PIO_SET(LATCHES)},
	[WAY_STATE] = {SET(LATCHES)},
};

static const struct property properties[] = {
	PIO_BITS("PIO", BOTH, PIO_READ(STATUS, PIO_OUTPUTS, true), .holds = true, .how = WAY_PIO),
	PROPERTY("piostate", UNSIGNED, VOLATILE, BOTH, .hidden = true, .digits = 3,
                 PIO_READ(STATUS, PIO_STATE, false), .how = WAY_STATE),
	PIO_BITS("sensed", READ, PIO_READ(STATUS, PIO_PINS, false)),
};

CHIP_FAMILY(3a, "DS2413", CHECKSUM, .flags = FLAG_RESUME | FLAG_OVERDRIVE,
            SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
