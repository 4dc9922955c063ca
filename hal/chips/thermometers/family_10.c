/* SPDX-License-Identifier: MIT */
/* DS18S20 and DS1920: one resolution, and what is below half a degree comes from COUNT_REMAIN. */
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_store.h"

#define HIDDEN_TEMPERATURE(text, decimals) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .hidden = true, .convert = CONVERT_TEMPRES, \
	         THERMOMETER_MEASURES(decimals), .how = WAY_TEMPERATURE)

static const struct area *const areas[] = {THERMOMETER_AREAS};
static const struct property_how how[] = {THERMOMETER_WAYS};

static const struct property properties[] = {
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
            PROPERTIES(properties));
