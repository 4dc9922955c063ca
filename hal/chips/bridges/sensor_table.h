/* SPDX-License-Identifier: MIT */
/* Reads a table of sensors (sensor.h). */
#pragma once

#include "hal/chips/bridges/sensor.h"

/*
 * Read the text, which ends with a zero. 0, -ENOMEM, or -EINVAL with "NAME:LINE: reason" in why. A
 * table that failed is to be freed too.
 */
int sensor_table_parse(struct sensor_table *table, const char *name, const char *text, char *why,
                       size_t why_size);
void sensor_table_free(struct sensor_table *table);
