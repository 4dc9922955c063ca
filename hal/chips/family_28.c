/* SPDX-License-Identifier: MIT */
/* DS18B20 and MAX31820. */
#include "hal/chips/thermometer.h"

static const struct area *const areas[] = {THERMOMETER_AREAS};
static const struct property_how how[] = {THERMOMETER_WAYS};
static const struct property properties[] = {THERMOMETER_PROPERTIES};

const struct family family_28 = {
	.code = 0x28,
	.type = "DS18B20",
	THERMOMETER_FAMILY,
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
