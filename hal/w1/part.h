/* SPDX-License-Identifier: MIT */
/*
 * What a driver of the kernel's gives of a chip: the areas (hal/chips/area.h), by their names
 * there, that its attributes stand for, and the properties that can be had of these.
 */
#pragma once

#include "hal/w1/slave.h"

/* Bytes of an area as driver_ops.area_read and area_write have them; NULL: they cannot be had. */
struct w1_part {
	const char *area;
	int (*read)(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n);
	int (*write)(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n);
};

struct w1_property {
	const char *name;
	const char *file;     /* there is no such property without it; NULL: the driver's first */
	uint8_t first, count; /* these elements only; count 0: all */
};

struct w1_driver {
	const char *files[2]; /* one of them shows that the driver has the slave */
	const struct w1_part *parts;
	const struct w1_property *properties;
	unsigned part_count, property_count;
	/* As driver_ops.convert, of one; NULL: it does not measure. */
	int (*convert)(struct w1_slave *slave, const char *what);
	/* Would the conditional search find it? 1, 0, or an error. NULL: that cannot be told. */
	int (*alarm)(struct w1_slave *slave);
	uint8_t family; /* 0: ends a table */
};

#define W1_PARTS(table) .parts = (table), .part_count = sizeof(table) / sizeof((table)[0])
#define W1_PROPERTIES(table) \
	.properties = (table), .property_count = sizeof(table) / sizeof((table)[0])
