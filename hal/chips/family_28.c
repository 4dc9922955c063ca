/* SPDX-License-Identifier: MIT */
/* DS18B20 and MAX31820, and the clones of the DS18B20 (clone.c). */
#include "hal/chips/clone.h"
#include "hal/chips/identity.h"
#include "hal/chips/thermometer.h"
#include "hal/chips/thermometer_store.h"

static const struct area *const areas[] = {THERMOMETER_AREAS};
enum { WAY_IDENTITY = AFTER_THERMOMETER_WAYS };
static const struct property_how how[] = {
	THERMOMETER_WAYS,
	[WAY_IDENTITY] = {.read = clone_read_identity},
};
static const struct property properties[] = {
	THERMOMETER_ERRATA,
	THERMOMETER_TEMPERATURE("fasttemp", 9, 1),
	IDENTITY_ROW(WAY_IDENTITY, .convert = CONVERT_TEMPRES),
	THERMOMETER_LATEST,
	THERMOMETER_POWER,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_TEMPERATURES,
};

const struct family family_28 = {
	.code = 0x28,
	.proof = PROOF_PRESENCE,
	.type = "DS18B20",
	.flags = FLAG_ALARM | FLAG_TEMPERATURE,
	SCAN({"temperature12", "temperature"}),
	.name = clone_name,
	THERMOMETER_FAMILY,
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
