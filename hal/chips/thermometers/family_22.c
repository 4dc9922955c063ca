/* SPDX-License-Identifier: MIT */
/* DS1822: the properties of a DS18B20. */
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_store.h"

static const struct area *const areas[] = {THERMOMETER_AREAS};
static const struct property_how how[] = {THERMOMETER_WAYS};
static const struct property properties[] = {THERMOMETER_PROPERTIES};

CHIP_FAMILY(22, "DS1822", PRESENCE, .flags = FLAG_ALARM | FLAG_TEMPERATURE,
            SCAN({"temperature12", "temperature"}), THERMOMETER_FAMILY, AREAS(areas), HOW(how),
            PROPERTIES(properties));
