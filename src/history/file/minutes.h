/* SPDX-License-Identifier: MIT */
/*
 * The minutes of an hour of a signal as one text, which is JSON, so that a view can take it apart:
 *
 *     [BASE, STEP, MINUTES...]
 *     of each: [MINUTE, COUNT, LAST, LEAST, MOST, MEAN, GOOD, KNOWN, QUALITY, WORST]
 *
 * All numbers are whole. A value is (BASE + STEP * NUMBER) / 1000000, MEAN has three digits more;
 * GOOD and KNOWN are microseconds, a quality of -1 is not known. LAST is null without a good value.
 * What is missing at the end of a minute is what it mostly is: LAST for LEAST, MOST and MEAN, a
 * minute for GOOD and KNOWN, good for the qualities. Minutes in which nothing came are missing.
 * Pure.
 */
#pragma once

#include "src/history/file/rolling.h"

#define MINUTES 60
#define MINUTES_TEXT (MINUTES * 192)

/* A sum as the file has it, of a minute or an hour. */
struct minute {
	double least, most, mean, last; /* NaN: no good value */
	int64_t good_us, known_us;
	uint32_t count;
	int16_t quality, worst; /* at its end, and the worst one; -1: not known */
	bool there;
};

/* state: at the end. */
struct minute minute_of(const struct rollup *sum, const struct rollup_state *state);
/* The way back; the numbers may be any. most_us: how long it is. */
void minute_take(const struct minute *minute, int64_t most_us, struct rollup *sum,
                 struct rollup_state *state);
/* False: a value has more than six decimals, or is too large for them. */
bool minutes_pack(const struct minute minutes[MINUTES], char text[MINUTES_TEXT]);
/* 0 or -EBADMSG. */
int minutes_unpack(const char *text, struct minute minutes[MINUTES]);
