/* SPDX-License-Identifier: MIT */
/*
 * What a signal was over a stretch of time: its least, most, mean and last good value, for how long
 * it was good or known. Pure.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* What a signal has at a moment. All zero: nothing is known. */
struct rollup_state {
	double value; /* NaN: no number */
	uint8_t quality;
	bool known;
};
/* All zero: nothing yet. */
struct rollup {
	double least, most, last; /* of good values, if there is one */
	double sum;               /* value times microseconds, of good numbers */
	int64_t sum_us;           /* these microseconds */
	int64_t good_us, known_us;
	uint32_t count; /* values that came */
	uint8_t worst;  /* the lowest quality, if something was known */
	bool has_value, has_quality;
};

/* The state lasts for so long. */
void rollup_hold(struct rollup *sum, const struct rollup_state *state, int64_t us);
/* A value came. */
void rollup_value(struct rollup *sum, const struct rollup_state *state);
/* What came after it joins. */
void rollup_add(struct rollup *sum, const struct rollup *later);
double rollup_mean(const struct rollup *sum); /* NaN: no good value */
