/* SPDX-License-Identifier: MIT */
/* DS18B20 and MAX31820. */
#include "hal/native/thermometer.h"

static const struct property properties[] = {
	THERMOMETER_ERRATA,
	THERMOMETER_TEMPERATURE("fasttemp", 9),
	THERMOMETER_LATEST,
	THERMOMETER_POWER,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_TEMPERATURE("temperature", CONVERT_TEMPRES),
	THERMOMETER_TEMPERATURE("temperature10", 10),
	THERMOMETER_TEMPERATURE("temperature11", 11),
	THERMOMETER_TEMPERATURE("temperature12", 12),
	THERMOMETER_TEMPERATURE("temperature9", 9),
	THERMOMETER_LIMIT("temphigh", SP_HIGH),
	THERMOMETER_LIMIT("templow", SP_LOW),
	THERMOMETER_TEMPRES,
};

const struct family family_28 = {
	.code = 0x28, .thermometer = true, .alarms = true, .type = "DS18B20",
	PROPERTIES(properties),
};
