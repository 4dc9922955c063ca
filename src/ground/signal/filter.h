/* SPDX-License-Identifier: MIT */
/* A low-pass filter of first order for samples that come at irregular times. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* All zero: not begun; the next sample passes as it is. */
struct filter {
	bool begun;
	double value;
	int64_t at_ns; /* of the newest sample */
};

/*
 * The filtered value after a sample that was measured at that time. After a step the result has
 * gone 63 % of the way in seconds, whatever the times of the samples between. A sample that is not
 * newer than the last one, as one that a cache gave again, changes nothing.
 */
double filter_sample(struct filter *filter, double seconds, double sample, int64_t at_ns);
