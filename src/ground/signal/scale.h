/* SPDX-License-Identifier: MIT */
/*
 * Scaling: from the raw value that a bus reads and writes to the engineering value that everybody
 * else sees, and back; and the range that the engineering value can have. Pure functions; no result
 * is NaN or infinite.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define SCALE_POINTS_MAX 32

struct scale_point {
	double raw, value;
};

/*
 * All zero: value = raw, without range.
 *
 * Nobody has calibrated what lies beyond the points. A raw value beyond the first or last point has
 * the value of that point, marked. Where the range says how far values may be believed, the line
 * goes on in the direction of its last piece as far as the range: a transmitter of 4 to 20 mA still
 * measures at 3.9 mA, and the user says so with Min.
 */
struct scale {
	bool linear; /* value = raw * factor + offset; factor is not 0 */
	double factor, offset;
	/* or a line through these, 2 to SCALE_POINTS_MAX; raw rises, value rises or falls */
	const struct scale_point *points;
	unsigned count;
	bool has_min, has_max;
	double min, max; /* of the engineering value */
};

/* Does it change values? A range does not. */
bool scale_changes(const struct scale *scale);
/* Do the two give the same value and quality for every raw value? */
bool scale_same(const struct scale *a, const struct scale *b);

/*
 * The engineering value of a raw value. *quality is OWS_Q_GOOD; OWS_Q_RANGE if the value is beyond
 * min or max; OWS_Q_LOW or OWS_Q_HIGH if it is held at the end of the points, or at the greatest
 * double. raw is finite.
 */
double scale_value(const struct scale *scale, double raw, uint8_t *quality);

/*
 * The raw value of an engineering value. -ERANGE: it lies beyond min or max, beyond points that
 * nothing continues, or has no finite raw value; *raw is unchanged then. value is finite.
 */
int scale_raw(const struct scale *scale, double value, double *raw);

/* The points of "4:0 20:100"; count is their number, or a negative errno when the text is wrong:
 * -EILSEQ not of that form, -E2BIG too many, -EDOM too few, -EINVAL raw values that do not rise,
 * -ERANGE values that neither rise nor fall throughout. */
int scale_parse(const char *text, struct scale_point points[SCALE_POINTS_MAX]);
