/* SPDX-License-Identifier: MIT */
/* Sensors on boards with a DS2438: humidity, pressure, light. */
#ifndef HAL_CHIPS_SENSORS_26_H
#define HAL_CHIPS_SENSORS_26_H

#include "hal/chips/property.h"

int sensor_read_humidity(struct txn *txn); /* arg: enum sensor_humidity */
int sensor_read_pressure(struct txn *txn);
int sensor_read_light(struct txn *txn);   /* arg: 1 in lux */
int sensor_read_setting(struct txn *txn); /* arg: enum sensor_setting */
int sensor_write_setting(struct txn *txn);
int sensor_read_type(struct txn *txn);
bool sensor_is_datanab(const struct device *device);
int sensor_reset_datanab(struct txn *txn);

enum sensor_humidity { HIH3600, HIH4000, HIH5030, HTM1735, DATANAB };
enum sensor_setting { B1_GAIN, B1_OFFSET, S3_GAIN };

#define DS2438_HUMIDITY(text, which) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (which), .read = sensor_read_humidity)
#define DS2438_SETTING(text, kind, which) \
	PROPERTY(text, kind, STABLE, BOTH, .arg = (which), .read = sensor_read_setting, \
	         .write = sensor_write_setting)
#define DS2438_LIGHT(text, lux) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (lux), .read = sensor_read_light)

#endif
