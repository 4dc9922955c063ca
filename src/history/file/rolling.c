/* SPDX-License-Identifier: MIT */
/* Minutes and hours under way: what was not touched costs nothing until the hour is over. */
#include "src/history/file/rolling.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/record.h"
#include "src/history/file/schema.h"
#include "src/public/ows.h"

/* Good values from least to most, of which `last` came last. */
static void widen(struct rollup *sum, double least, double most, double last)
{
	if (!sum->has_value || least < sum->least)
		sum->least = least;
	if (!sum->has_value || most > sum->most)
		sum->most = most;
	sum->last = last;
	sum->has_value = true;
}

static void see_state(struct rollup *sum, const struct rollup_state *state)
{
	if (!state->known)
		return;
	if (!sum->has_quality || state->quality < sum->worst)
		sum->worst = state->quality;
	sum->has_quality = true;
	if (ows_good(state->quality) && !isnan(state->value))
		widen(sum, state->value, state->value, state->value);
}

void rollup_hold(struct rollup *sum, const struct rollup_state *state, int64_t us)
{
	if (us <= 0 || !state->known)
		return;
	see_state(sum, state);
	sum->known_us += us;
	if (!ows_good(state->quality))
		return;
	sum->good_us += us;
	if (isnan(state->value))
		return;
	sum->sum += state->value * (double)us;
	sum->sum_us += us;
}

void rollup_value(struct rollup *sum, const struct rollup_state *state)
{
	see_state(sum, state);
	sum->count++;
}

void rollup_add(struct rollup *sum, const struct rollup *later)
{
	if (later->has_quality && (!sum->has_quality || later->worst < sum->worst))
		sum->worst = later->worst;
	sum->has_quality |= later->has_quality;
	if (later->has_value)
		widen(sum, later->least, later->most, later->last);
	sum->sum += later->sum;
	sum->sum_us += later->sum_us;
	sum->good_us += later->good_us;
	sum->known_us += later->known_us;
	sum->count += later->count;
}

double rollup_mean(const struct rollup *sum)
{
	if (!sum->has_value)
		return NAN;
	return sum->sum_us > 0 ? sum->sum / (double)sum->sum_us : sum->last;
}

/* --- The sums under way ---------------------------------------------------------------------- */

#define PER_HOUR 60

void rolling_begin(struct rolling *rolling, int64_t id)
{
	if (rolling->rows)
		memset(rolling->rows, 0, rolling->count * sizeof(*rolling->rows));
	rolling->minute = id / MINUTE_US;
	rolling->known = 0;
	rolling->minute_touched = rolling->hour_touched = false;
}

void rolling_free(struct rolling *rolling)
{
	free(rolling->rows);
	rolling->rows = NULL;
	rolling->count = 0;
}

/* The state lasts until then, in a stretch that may be a new one. */
static void hold_part(struct rolling_part *part, int64_t begin, const struct rollup_state *state,
                      int64_t id)
{
	if (part->begin != begin)
		*part = (struct rolling_part){.begin = begin, .at = begin};
	rollup_hold(&part->sum, state, id - part->at);
	if (id > part->at)
		part->at = id;
}

static int64_t minute_begin(const struct rolling *rolling)
{
	return rolling->minute * MINUTE_US;
}

static int64_t hour_begin(const struct rolling *rolling)
{
	return rolling->minute / PER_HOUR * HOUR_US;
}

static int close_minute(struct rolling *rolling)
{
	int err = 0;

	for (uint32_t i = 0; !err && rolling->minute_touched && i < rolling->count; i++) {
		struct rolling_row *row = &rolling->rows[i];

		if (row->minute.begin != minute_begin(rolling))
			continue;
		hold_part(&row->minute, row->minute.begin, &row->state,
		          row->minute.begin + MINUTE_US);
		err = rolling->give(rolling->ctx, false, rolling->minute, i, &row->minute.sum,
		                    &row->state);
	}
	rolling->minute_touched = false;
	return err;
}

static int close_hour(struct rolling *rolling)
{
	int64_t begin = hour_begin(rolling);
	int err = 0;

	for (uint32_t i = 0; !err && i < rolling->count; i++) {
		struct rolling_row *row = &rolling->rows[i];

		if (row->hour.begin != begin && !row->state.known)
			continue;
		hold_part(&row->hour, begin, &row->state, begin + HOUR_US);
		err = rolling->give(rolling->ctx, true, begin / HOUR_US, i, &row->hour.sum,
		                    &row->state);
	}
	rolling->hour_touched = false;
	return err;
}

int rolling_advance(struct rolling *rolling, int64_t id)
{
	int err = 0;

	while (!err && id >= minute_begin(rolling) + MINUTE_US) {
		err = close_minute(rolling);
		if (!err && (rolling->minute + 1) % PER_HOUR == 0)
			err = close_hour(rolling);
		rolling->minute++;
		/* years without a recorder have no minutes to write */
		if (!rolling->known && !rolling->hour_touched)
			rolling->minute = id / MINUTE_US;
	}
	return err;
}

bool rolling_is_due(const struct rolling *rolling, int64_t id)
{
	return (rolling->known || rolling->hour_touched) && id >= hour_begin(rolling) + HOUR_US;
}

static int room_for_signal(struct rolling *rolling, uint32_t signal)
{
	uint32_t count = rolling->count ? rolling->count : 64;
	struct rolling_row *rows;

	if (signal < rolling->count)
		return 0;
	while (count <= signal)
		count *= 2;
	rows = reallocarray(rolling->rows, count, sizeof(*rows));
	if (!rows)
		return -ENOMEM;
	memset(rows + rolling->count, 0, (count - rolling->count) * sizeof(*rows));
	rolling->rows = rows;
	rolling->count = count;
	return 0;
}

static void touch(struct rolling *rolling, struct rolling_row *row, int64_t id)
{
	hold_part(&row->minute, minute_begin(rolling), &row->state, id);
	hold_part(&row->hour, hour_begin(rolling), &row->state, id);
	rolling->minute_touched = rolling->hour_touched = true;
}

int rolling_value(struct rolling *rolling, int64_t id, uint32_t signal,
                  const struct rollup_state *state)
{
	struct rolling_row *row;
	int err = signal > HISTORY_SIGNALS ? -E2BIG : room_for_signal(rolling, signal);

	if (!err)
		err = rolling_advance(rolling, id);
	if (err)
		return err;
	row = &rolling->rows[signal];
	touch(rolling, row, id);
	rolling->known += !row->state.known;
	row->state = *state;
	rollup_value(&row->minute.sum, state);
	rollup_value(&row->hour.sum, state);
	return 0;
}

int rolling_gap(struct rolling *rolling, int64_t id, uint32_t signal)
{
	int err = rolling_advance(rolling, id);

	for (uint32_t i = signal; !err && i < rolling->count && (!signal || i == signal); i++) {
		struct rolling_row *row = &rolling->rows[i];

		if (!row->state.known)
			continue;
		touch(rolling, row, id);
		row->state = (struct rollup_state){0};
		rolling->known--;
	}
	return err;
}
