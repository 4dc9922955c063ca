/* SPDX-License-Identifier: MIT */
/* Sensors on boards with a DS2438: humidity, pressure, light. */
#pragma once

#include "hal/chips/property.h"

int sensor_read_humidity(struct txn *txn); /* arg: enum sensor_humidity */
int sensor_read_pressure(struct txn *txn);
int sensor_read_light(struct txn *txn);   /* arg: 1 in lux */
int sensor_read_setting(struct txn *txn); /* arg: enum sensor_setting */
int sensor_write_setting(struct txn *txn);
int sensor_read_type(struct txn *txn);

enum sensor_humidity { HIH3600, HIH4000, HIH5030, HTM1735, DATANAB };
enum sensor_setting { B1_GAIN, B1_OFFSET, S3_GAIN };

/* What stands first in the list of the family. */
enum {
	WAY_HUMIDITY = 1,
	WAY_PRESSURE,
	WAY_LIGHT,
	WAY_SETTING,
	WAY_SENSOR_TYPE,
	WAY_RESET_DATANAB,
	AFTER_SENSOR_WAYS
};
/* clang-format off */
#define SENSOR_WAYS \
	[WAY_HUMIDITY] = {.read = sensor_read_humidity}, \
	[WAY_PRESSURE] = {.read = sensor_read_pressure}, \
	[WAY_LIGHT] = {.read = sensor_read_light}, \
	[WAY_SETTING] = {.read = sensor_read_setting, .write = sensor_write_setting}, \
	[WAY_SENSOR_TYPE] = {.read = sensor_read_type}, \
	[WAY_RESET_DATANAB] = {.write = property_refuse}
/* clang-format on */

/* Sensors of 0 to 100 %RH within 5, and as much again for their ageing in wet air */
#define DS2438_HUMIDITY(text, which) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (which), MEASURES(-10, 110, 2, "%"), \
	         .how = WAY_HUMIDITY)
#define DS2438_SETTING(text, kind, which, unit_) \
	PROPERTY(text, kind, STABLE, BOTH, .arg = (which), unit_, .how = WAY_SETTING)
#define DS2438_LIGHT(text, lux, ...) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (lux), .how = WAY_LIGHT, __VA_ARGS__)
