/* SPDX-License-Identifier: MIT */
/* DS18B20 and MAX31820. */
#include "hal/chips/thermometer.h"

static const struct property properties[] = {
	THERMOMETER_ERRATA,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_PROPERTIES,
};

/* clang-format off */
const struct family family_28 = {
	.code = 0x28, .thermometer = true, .alarms = true, .type = "DS18B20",
	PROPERTIES(properties),
};
/* clang-format on */
