/* SPDX-License-Identifier: MIT */
/*
 * The values that a measured property of a chip family can have, by data sheet: the range that the
 * chip can measure, unit and decimals of its results, and whether a power fault looks like a value.
 */
#ifndef SIGNAL_QUANTITY_H
#define SIGNAL_QUANTITY_H

#include <stdbool.h>

struct quantity {
	double least, most; /* a number outside is never a true measurement */
	int decimals;       /* of its resolution */
	bool starves;       /* a thermometer that reports 85 or 127.94 when it lacks power */
	const char *unit;   /* "" for a plain number; UTF-8 */
};

/*
 * The quantity of the property at path; false: nothing is known of that property. An alias may name
 * any chip: then the property's name decides, and only what no chip can measure is out of range.
 */
bool quantity_of(const char *path, struct quantity *quantity);

/* Is the number one that the chip cannot have measured? */
bool quantity_excludes(const struct quantity *quantity, double number);

#endif
