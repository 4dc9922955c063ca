/* SPDX-License-Identifier: MIT */
/*
 * Thermometers with a nine-byte scratchpad that are tables alone: DS18S20 and DS1920 (one
 * resolution, and what is below half a degree comes from COUNT_REMAIN), DS1822 (the properties of a
 * DS18B20), DS28EA00 (a DS18B20 with two switches: PIO is what the pins are, latch what they are
 * set to).
 */
#include "hal/chips/switches/pio.h"
#include "hal/chips/thermometers/thermometer.h"

enum { STATUS = AFTER_THERMOMETER_AREAS, LATCHES };
static const struct area *const areas[] = {
	THERMOMETER_AREAS,
	[STATUS] = &pio_status,
	[LATCHES] = AREA(PIO_LATCHES(0xa5)),
};

enum { WAY_PIO = AFTER_THERMOMETER_WAYS };
static const struct property_how how[] = {THERMOMETER_WAYS, [WAY_PIO] = {PIO_SET(LATCHES)}};

#define HIDDEN_TEMPERATURE(text, decimals) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .hidden = true, .convert = CONVERT_TEMPRES, \
	         THERMOMETER_MEASURES(decimals), .how = WAY_TEMPERATURE)

static const struct property ds18s20[] = {
	THERMOMETER_ERRATA,
	HIDDEN_TEMPERATURE("fasttemp", 1),
	THERMOMETER_LATEST,
	THERMOMETER_POWER,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_TEMPERATURE("temperature", CONVERT_TEMPRES, 4),
	HIDDEN_TEMPERATURE("temperature10", 2),
	HIDDEN_TEMPERATURE("temperature11", 3),
	HIDDEN_TEMPERATURE("temperature12", 4),
	HIDDEN_TEMPERATURE("temperature9", 1),
	THERMOMETER_LIMIT("temphigh", SP_HIGH),
	THERMOMETER_LIMIT("templow", SP_LOW),
};

CHIP_FAMILY(10, "DS18S20", PRESENCE, .fixed = true, .flags = FLAG_ALARM | FLAG_TEMPERATURE,
            SCAN({"temperature", "temperature"}), THERMOMETER_FAMILY, AREAS(areas), HOW(how),
            PROPERTIES(ds18s20));

static const struct property ds1822[] = {THERMOMETER_PROPERTIES};

CHIP_FAMILY(22, "DS1822", PRESENCE, .flags = FLAG_ALARM | FLAG_TEMPERATURE,
            SCAN({"temperature12", "temperature"}), THERMOMETER_FAMILY, AREAS(areas), HOW(how),
            PROPERTIES(ds1822));

static const struct property ds28ea00[] = {
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
            PROPERTIES(ds28ea00));
