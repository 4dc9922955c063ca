/* SPDX-License-Identifier: MIT */
/*
 * What a measured property of a chip family can be: the range that the chip can measure, the
 * decimals that it gives, and whether a power fault looks like a value. By data sheet; degrees
 * Celsius, volts, percent, millibars.
 */
#ifndef SIGNAL_QUANTITY_H
#define SIGNAL_QUANTITY_H

#include <stdbool.h>

struct quantity {
	double least, most; /* nothing outside is ever true */
	int decimals;       /* of its resolution */
	bool starves;       /* a thermometer that says 85 or 127.94 when it lacks power */
};

/*
 * What the property at path can be; false: nothing is known of it. An alias may be any chip: then
 * the property's name decides, and only what no chip can measure is out of range.
 */
bool quantity_of(const char *path, struct quantity *quantity);

/* Is the number one that the chip cannot have measured? */
bool quantity_excludes(const struct quantity *quantity, double number);

#endif
