/* SPDX-License-Identifier: MIT */
/* DS28EA00: a DS18B20 with two switches. PIO is what the pins are, latch what they are set to. */
#include "hal/chips/pio.h"
#include "hal/chips/thermometer.h"

static const struct area latches = {PIO_LATCHES(0xa5)};

static const struct property properties[] = {
	PIO_BITS("PIO", BOTH, PIO_READ(PIO_PINS, true), PIO_SET(latches)),
	THERMOMETER_TEMPERATURE("fasttemp", 9),
	PIO_BITS("latch", BOTH, PIO_READ(PIO_OUTPUTS, true), PIO_SET(latches)),
	THERMOMETER_LATEST,
	PROPERTY("piostate", UNSIGNED, VOLATILE, READ, .hidden = true, PIO_READ(PIO_STATE, false)),
	THERMOMETER_POWER,
	PIO_BITS("sensed", READ, PIO_READ(PIO_PINS, false)),
	THERMOMETER_TEMPERATURES,
};

const struct family family_42 = {
	.code = 0x42,
	.type = "DS28EA00",
	THERMOMETER_FAMILY,
	PROPERTIES(properties),
};
