/* SPDX-License-Identifier: MIT */
/* DS1822: the properties of a DS18B20. */
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_store.h"

static const struct area *const areas[] = {THERMOMETER_AREAS};
static const struct property_how how[] = {THERMOMETER_WAYS};
static const struct property properties[] = {THERMOMETER_PROPERTIES};

const struct family family_22 = {
	.code = 0x22,
	.proof = PROOF_PRESENCE,
	.type = "DS1822",
	.flags = FLAG_ALARM | FLAG_TEMPERATURE,
	SCAN({"temperature12", "temperature"}),
	THERMOMETER_FAMILY,
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
