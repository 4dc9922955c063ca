/* SPDX-License-Identifier: MIT */
/*
 * The roll-ups of the minute and the hour that are under way, of all signals. Values and gaps come
 * in the order of their ids; a minute or an hour that is over is given out once, all its signals in
 * their order. Allocates, touches no file.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/*
 * What a signal was over a stretch of time: its least, most, mean and last good value, for how long
 * it was good or known. Pure.
 */

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

/* begin: of the stretch, as an id; until which the sum was held. */
struct rolling_part {
	int64_t begin, at;
	struct rollup sum;
};
struct rolling_row {
	struct rollup_state state;
	struct rolling_part minute, hour;
};
/* state: at the end of the stretch. What it returns other than 0 ends the call and is returned. */
typedef int rolling_give(void *ctx, bool hour, int64_t bucket, uint32_t signal,
                         const struct rollup *sum, const struct rollup_state *state);
struct rolling {
	rolling_give *give;
	void *ctx;
	/* the rest is rolling.c's */
	struct rolling_row *rows; /* by the number of the signal */
	uint32_t count;
	int64_t minute; /* the one under way */
	uint32_t known; /* signals that have a state */
	bool minute_touched, hour_touched;
};

/* Nothing is known; the minute under way is that of the id. */
void rolling_begin(struct rolling *rolling, int64_t id);
void rolling_free(struct rolling *rolling);
/* It has become so late: 0, -ENOMEM or what give() returned. So do the others. */
int rolling_advance(struct rolling *rolling, int64_t id);
int rolling_value(struct rolling *rolling, int64_t id, uint32_t signal,
                  const struct rollup_state *state);
/* signal 0: of all. */
int rolling_gap(struct rolling *rolling, int64_t id, uint32_t signal);
/* Would rolling_advance() give an hour out? */
bool rolling_is_due(const struct rolling *rolling, int64_t id);
