/* SPDX-License-Identifier: MIT */
/* DS1822: the properties of a DS18B20. */
#include "hal/chips/thermometer.h"

static const struct property properties[] = {
	THERMOMETER_ERRATA,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_PROPERTIES,
};

/* clang-format off */
const struct family family_22 = {
	.code = 0x22, .thermometer = true, .alarms = true, .type = "DS1822", PROPERTIES(properties),
};
/* clang-format on */
