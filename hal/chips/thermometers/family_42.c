/* SPDX-License-Identifier: MIT */
/* DS28EA00: a DS18B20 with two switches. PIO is what the pins are, latch what they are set to. */
#include "hal/chips/switches/pio.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_store.h"

enum { STATUS = AFTER_THERMOMETER_AREAS, LATCHES };
static const struct area *const areas[] = {
	THERMOMETER_AREAS,
	[STATUS] = &pio_status,
	[LATCHES] = AREA(PIO_LATCHES(0xa5)),
};

enum { WAY_PIO = AFTER_THERMOMETER_WAYS };
static const struct property_how how[] = {THERMOMETER_WAYS, [WAY_PIO] = {PIO_SET(LATCHES)}};

static const struct property properties[] = {
	PIO_BITS("PIO", BOTH, PIO_READ(STATUS, PIO_PINS, true), .how = WAY_PIO),
	THERMOMETER_TEMPERATURE("fasttemp", 9, 1),
	PIO_BITS("latch", BOTH, PIO_READ(STATUS, PIO_OUTPUTS, true), .holds = true, .how = WAY_PIO),
	THERMOMETER_LATEST,
	PROPERTY("piostate", UNSIGNED, VOLATILE, READ, .hidden = true,
                 PIO_READ(STATUS, PIO_STATE, false)),
	THERMOMETER_POWER,
	PIO_BITS("sensed", READ, PIO_READ(STATUS, PIO_PINS, false)),
	THERMOMETER_TEMPERATURES,
};

CHIP_FAMILY(42, "DS28EA00", PRESENCE, .flags = FLAG_ALARM | FLAG_CHAIN | FLAG_TEMPERATURE,
            SCAN({"temperature12", "temperature"}), THERMOMETER_FAMILY, AREAS(areas), HOW(how),
            PROPERTIES(properties));
