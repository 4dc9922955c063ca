/* SPDX-License-Identifier: MIT */
/* The sensors behind bridges: the file that names them, and what family a device is by it. */
#pragma once

#include "hal/chips/bridges/sensor.h"

/* As bus_ops.option: the file takes the place of an earlier one. */
int sensors_read(struct sensor_table *table, const char *file, char *why, size_t why_size);
/* The family of a device: that of its code, unless the table names it as a bridge. */
const struct family *sensors_family(const struct sensor_table *table, const uint8_t rom[8]);
/* Does the table name a bridge with this family code? */
bool sensors_has(const struct sensor_table *table, uint8_t code);
