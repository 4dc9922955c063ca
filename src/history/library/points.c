/* SPDX-License-Identifier: MIT */
/* A signal as points to draw: of hours and minutes where these are enough, else of its values. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/minutes.h"
#include "src/history/file/schema.h"
#include "src/history/file/sql.h"
#include "src/history/library/open.h"
#include "src/history/library/steps.h"

#define STEPS 512
#define PER_POINT 2     /* hours that a point needs at least; a minute is enough */
#define NOTICED_US 1000 /* less than that is no gap */

struct draw {
	struct ows_history *h;
	const struct known_signal *signal;
	const struct session *session; /* whose ids are drawn */
	struct ows_history_point *points;
	struct rollup *sums;
	int64_t *unknown_us, *seen_us;
	int n;
	int64_t from_us, until_us; /* wall clock */
};

static int64_t border(const struct draw *d, int i)
{
	int64_t whole = (d->until_us - d->from_us) / d->n, rest = (d->until_us - d->from_us) % d->n;

	return d->from_us + whole * i + rest * i / d->n;
}

/* The point that a time of the wall clock is in; it is within the limits. */
static int point_of(const struct draw *d, int64_t us)
{
	int i = (int)((double)(us - d->from_us) / (double)(d->until_us - d->from_us) * d->n);

	i = i < 0 ? 0 : i >= d->n ? d->n - 1 : i;
	while (i > 0 && us < border(d, i))
		i--;
	while (i + 1 < d->n && us >= border(d, i + 1))
		i++;
	return i;
}

/* Of that time the run looked, with whatever result. */
static void see_span(struct draw *d, int64_t from, int64_t until)
{
	from += d->session->date;
	until += d->session->date;
	while (from < until) {
		int i = point_of(d, from);
		int64_t end = border(d, i + 1) < until ? border(d, i + 1) : until;

		d->seen_us[i] += end - from;
		from = end;
	}
}

/* The state lasts from one id to another. */
static void hold_state(struct draw *d, const struct rollup_state *state, int64_t from,
                       int64_t until)
{
	from += d->session->date;
	until += d->session->date;
	while (from < until) {
		int i = point_of(d, from);
		int64_t end = border(d, i + 1) < until ? border(d, i + 1) : until;

		rollup_hold(&d->sums[i], state, end - from);
		d->unknown_us[i] += state->known ? 0 : end - from;
		d->points[i].quality = state->known ? state->quality : 0;
		d->points[i].trusted &= d->session->trusted;
		from = end;
	}
}

static struct rollup_state state_of_step(const struct step *step)
{
	return (struct rollup_state){
		.value = step->text ? NAN : step->number,
		.quality = step->quality,
		.known = step->known,
	};
}

/* --- Of its values --------------------------------------------------------------------------- */

static int draw_steps(struct draw *d, int64_t first, int64_t end)
{
	struct step held, *steps = malloc(STEPS * sizeof(*steps));
	struct rollup_state state;
	int64_t at = first;
	int got = steps ? handle_held(d->h, d->signal, first - 1, &held) : -ENOMEM;

	if (got < 0) {
		free(steps);
		return got;
	}
	state = state_of_step(&held);
	free(held.text);
	while ((got = handle_steps(d->h, d->signal, first, end, steps, STEPS)) > 0) {
		for (int i = 0; i < got; i++) {
			int point = point_of(d, steps[i].id + d->session->date);

			hold_state(d, &state, at, steps[i].id);
			at = steps[i].id;
			state = state_of_step(&steps[i]);
			if (state.known)
				rollup_value(&d->sums[point], &state);
			free(steps[i].text);
		}
		first = at + 1;
	}
	hold_state(d, &state, at, end);
	free(steps);
	return got;
}

/* --- Of roll-ups ----------------------------------------------------------------------------- */

static int64_t column_us(sqlite3_stmt *from, int column)
{
	double seconds = sqlite3_column_double(from, column);

	return !(seconds > 0) ? 0 : seconds < 3600 ? (int64_t)(seconds * 1e6 + 0.5) : HOUR_US;
}

static int16_t column_quality(sqlite3_stmt *from, int column)
{
	bool known = sqlite3_column_type(from, column) != SQLITE_NULL;

	return known ? (uint8_t)sqlite3_column_int(from, column) : -1;
}

/*
 * A row of its own. Columns: least, most, mean, last, good, known, count, quality, worst. 1; 0:
 * there is none.
 */
static int read_sum(const struct draw *d, enum handle_statement which, int64_t id,
                    struct minute *row)
{
	sqlite3_stmt *from = d->h->statements[which];
	int got = sql_run(from, "i", id);

	if (got == 1)
		*row = (struct minute){
			.least = sqlite3_column_type(from, 0) == SQLITE_NULL
		                         ? NAN
		                         : sqlite3_column_double(from, 0),
			.most = sqlite3_column_double(from, 1),
			.mean = sqlite3_column_double(from, 2),
			.last = sqlite3_column_double(from, 3),
			.good_us = column_us(from, 4),
			.known_us = column_us(from, 5),
			.count = (uint32_t)sqlite3_column_int64(from, 6),
			.quality = column_quality(from, 7),
			.worst = column_quality(from, 8),
			.there = true,
		};
	sqlite3_reset(from);
	return got;
}

/* The minutes of an hour: of the row that has them all, or each of its own. */
static int read_minutes(const struct draw *d, int64_t hour, struct minute minutes[MINUTES])
{
	sqlite3_stmt *from = d->h->statements[H_MINUTES];
	uint32_t signal = d->signal->number;
	int got = sql_run(from, "i", schema_minutes(hour, signal));
	const char *text = got == 1 ? (const char *)sqlite3_column_text(from, 0) : NULL;

	if (text) {
		got = minutes_unpack(text, minutes);
		sqlite3_reset(from);
		return got;
	}
	sqlite3_reset(from);
	memset(minutes, 0, MINUTES * sizeof(*minutes));
	for (int i = 0; got >= 0 && i < MINUTES; i++)
		got = read_sum(d, H_MINUTE, schema_minute(hour * MINUTES + i, signal), &minutes[i]);
	return got < 0 ? got : 0;
}

/*
 * One that reaches over a border is of the point, and of the run, that its middle is in. What is
 * before all runs is of the first, what is after them of the last.
 */
static void add_rollup(struct draw *d, const struct rollup *sum, const struct rollup_state *end,
                       int64_t begin, int64_t length)
{
	const struct session *first = d->h->sessions, *last = first + d->h->session_count - 1;
	int64_t middle = begin + length / 2;
	bool other = (d->session != first && middle < d->session->start) ||
	             (d->session != last && middle >= d->session->end);
	int i;

	middle += d->session->date;
	if (other || middle < d->from_us || middle >= d->until_us)
		return;
	i = point_of(d, middle);
	rollup_add(&d->sums[i], sum);
	d->unknown_us[i] += length - sum->known_us;
	d->points[i].quality = end->known ? end->quality : 0;
	d->points[i].trusted &= d->session->trusted;
}

static int draw_hours(struct draw *d, int64_t first, int64_t end)
{
	int got = 0;

	for (int64_t hour = first / HOUR_US; got >= 0 && hour * HOUR_US < end; hour++) {
		struct rollup_state last = {0};
		struct rollup sum = {0};
		struct minute row;

		got = read_sum(d, H_HOUR, schema_hour(hour, d->signal->number), &row);
		if (got == 1)
			minute_take(&row, HOUR_US, &sum, &last);
		if (got >= 0)
			add_rollup(d, &sum, &last, hour * HOUR_US, HOUR_US);
	}
	return got < 0 ? got : 0;
}

/* A minute in which nothing came is as the one before it ended, up to an hour before. */
static int draw_minutes(struct draw *d, int64_t first, int64_t end)
{
	int64_t minute = (first - LOOK_BACK_US > 0 ? first - LOOK_BACK_US : 0) / MINUTE_US;
	struct minute minutes[MINUTES];
	struct rollup_state state = {0};
	int err = read_minutes(d, minute / MINUTES, minutes);

	for (; !err && minute * MINUTE_US < end; minute++) {
		const struct minute *row = &minutes[minute % MINUTES];
		struct rollup sum = {0};

		if (minute % MINUTES == 0)
			err = read_minutes(d, minute / MINUTES, minutes);
		if (row->there)
			minute_take(row, MINUTE_US, &sum, &state);
		else
			rollup_hold(&sum, &state, MINUTE_US);
		if (!err && (minute + 1) * MINUTE_US > first)
			add_rollup(d, &sum, &state, minute * MINUTE_US, MINUTE_US);
	}
	return err;
}

/* --- All of it ------------------------------------------------------------------------------- */

/* Where hours end and minutes begin, and where these end: of what there is, of what is enough. */
static void choose_sources(const struct draw *d, int64_t *hours, int64_t *minutes)
{
	const struct ows_history *h = d->h;
	int64_t width = (d->until_us - d->from_us) / d->n;
	int64_t oldest = h->session_count ? h->sessions[0].start : 0;
	int64_t raw = h->raw_first, minute = h->minute_first;

	/* what is left of the oldest hour may lack what held in it */
	raw = raw == INT64_MAX              ? h->minute_end
	      : raw < oldest + LOOK_BACK_US ? oldest
	                                    : raw + HOUR_US;
	minute = minute < oldest + HOUR_US ? 0 : minute + HOUR_US;
	*minutes = width >= MINUTE_US ? h->minute_end : raw;
	*hours = width >= PER_POINT * HOUR_US ? h->hour_end : minute < *minutes ? minute : *minutes;
	if (*minutes < *hours)
		*minutes = *hours;
}

static int draw_session(struct draw *d, int64_t first, int64_t end, int64_t hours, int64_t minutes)
{
	int err = 0;

	see_span(d, first, end);
	if (first < hours) {
		int64_t part = end < hours ? end : hours;

		err = draw_hours(d, first, part);
		first = part;
	}
	if (!err && first < minutes && first < end) {
		int64_t part = end < minutes ? end : minutes;

		err = draw_minutes(d, first, part);
		first = part;
	}
	return !err && first < end ? draw_steps(d, first, end) : err;
}

static void finish_points(struct draw *d)
{
	for (int i = 0; i < d->n; i++) {
		struct ows_history_point *p = &d->points[i];
		const struct rollup *sum = &d->sums[i];
		int64_t length = border(d, i + 1) - border(d, i);

		p->from_ns = border(d, i) * NS_PER_US;
		p->until_ns = border(d, i + 1) * NS_PER_US;
		p->min = sum->has_value ? sum->least : NAN;
		p->max = sum->has_value ? sum->most : NAN;
		p->last = sum->has_value ? sum->last : NAN;
		p->mean = rollup_mean(sum);
		p->good_ns = sum->good_us * NS_PER_US;
		p->known_ns = sum->known_us * NS_PER_US;
		p->count = sum->count;
		p->worst = sum->worst;
		p->gap = d->unknown_us[i] > NOTICED_US || length - d->seen_us[i] > NOTICED_US;
	}
}

int ows_history_points(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns,
                       struct ows_history_point *points, int n)
{
	struct draw d = {.h = h, .points = points, .n = n};
	int64_t hours, minutes, first, end;
	int err = 0;

	open_allow(h);
	h->read.on = false;
	d.from_us = from_ns / NS_PER_US;
	d.until_us = until_ns / NS_PER_US;
	if (n < 1 || signal < 0 || signal >= h->signal_count || from_ns < 0 ||
	    d.until_us > MOST_US || d.until_us <= d.from_us)
		return -EINVAL;
	d.signal = &h->signals[signal];
	d.sums = calloc((size_t)n, sizeof(*d.sums));
	d.unknown_us = calloc((size_t)n, sizeof(*d.unknown_us));
	d.seen_us = calloc((size_t)n, sizeof(*d.seen_us));
	if (!d.sums || !d.unknown_us || !d.seen_us)
		err = -ENOMEM;
	for (int i = 0; !err && i < n; i++)
		points[i] = (struct ows_history_point){.trusted = 1};
	choose_sources(&d, &hours, &minutes);
	if (!err)
		err = sql_exec(h->db, "begin"); /* one look at the file, and fewer locks */
	for (int i = 0; !err && i < h->session_count; i++) {
		d.session = &h->sessions[i];
		if (handle_range(d.session, d.from_us, d.until_us, &first, &end))
			err = draw_session(&d, first, end, hours, minutes);
	}
	sqlite3_exec(h->db, "commit", NULL, NULL, NULL);
	if (!err)
		finish_points(&d);
	free(d.sums);
	free(d.unknown_us);
	free(d.seen_us);
	return err ? err : n;
}
