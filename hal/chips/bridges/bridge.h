/* SPDX-License-Identifier: MIT */
/* The bridges from 1-Wire to I2C, and the sensors behind them as their properties. */
#pragma once

#include "hal/chips/bridges/sensor.h"

/* Is it a whole number or a yesno? Then its type bounds it, and anything beyond is refused. */
bool bridge_bounded(uint8_t type);
/* What such a one of a table can be. */
void bridge_bounds(uint8_t type, double *least, double *most);
/* "DS28E17"; NULL: devices with this family code are no bridges. */
const char *bridge_type(uint8_t code);
/*
 * One more sensor of this kind behind the bridge; its values are properties, below the prefix if
 * that is not empty. 0, -ENOMEM, -EEXIST: there is a property of that name, -ENAMETOOLONG.
 */
int bridge_place(const struct sensor_table *table, struct sensor_bridge *bridge, unsigned kind,
                 uint8_t address, const char *prefix);
/* The table is whole: each bridge becomes a family. */
void bridges_finish(struct sensor_table *table);
/* NULL: the table does not name that device. */
const struct family *bridge_family(const struct sensor_table *table, const uint8_t rom[8]);
