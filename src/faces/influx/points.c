/* SPDX-License-Identifier: MIT */
/* From values of libows to lines: what of a signal is sent, and when it is sent again. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/influx/points.h"
#include "src/faces/show/newest.h"
#include "src/ground/text/influx.h"

#define FIELDS (INFLUX_FIELDS + 16) /* and the quality */
/* A repetition has a time before any measurement that is still under way */
#define REPEATED_NS (60 * NS_PER_S)

void points_free(struct points *points)
{
	for (int i = 0; i < points->count; i++)
		free(points->rows[i].series);
	free(points->rows);
	*points = (struct points){0};
}

void points_fields(const struct ows_value *v, const char *text, char *fields, size_t size)
{
	char value[INFLUX_FIELDS];
	bool has = ows_good(v->quality) && influx_fields((enum ows_type)v->type, v->number,
	                                                 v->integer, text, strlen(text), value);

	snprintf(fields, size, "%s%squality=%di", has ? value : "", has ? "," : "", v->quality);
}

static void points_send(struct point_row *row, struct pending *pending, int64_t time_ns,
                        const struct ows_value *v, const char *text, int64_t now_ns)
{
	uint64_t hash = face_value_print(v, text);
	char fields[FIELDS];

	/* A value of before, after a time in which it was not known, is known again from now on. */
	if (time_ns < row->time_ns || (time_ns == row->time_ns && hash != row->had))
		time_ns = now_ns > row->time_ns ? now_ns : row->time_ns + 1;
	points_fields(v, text, fields, sizeof(fields));
	pending_add(pending, time_ns, row->series, fields);
	row->time_ns = time_ns;
	row->fields = row->had = hash;
	row->sent_ns = now_ns;
}

/* A line that has that quality alone, of each signal whose last line has something else. */
static void send_quality(struct points *points, struct pending *pending, uint8_t quality,
                         int64_t now_ns)
{
	const struct ows_value v = {.quality = quality};
	uint64_t hash = face_value_print(&v, "");

	for (int i = 0; i < points->count; i++) {
		struct point_row *row = &points->rows[i];

		if (row->series && row->fields && row->fields != hash)
			points_send(row, pending, now_ns, &v, "", now_ns);
	}
}

/* What an image before sent of the same series; mostly it was at the same index. */
static void take_over(struct point_row *row, struct points *old, int at)
{
	for (int i = 0; i < old->count; i++) {
		struct point_row *before = &old->rows[(at + i) % old->count];

		if (before->series && strcmp(before->series, row->series) == 0) {
			row->time_ns = before->time_ns;
			row->had = before->had;
			free(before->series);
			before->series = NULL;
			return;
		}
	}
}

int points_make(struct points *points, struct ows *ows, const char *measurement,
                const char *instance, struct pending *pending, int64_t now_ns)
{
	char series[INFLUX_SERIES];
	int count = ows_count(ows);
	struct points old = *points;
	struct ows_info info;
	int err = 0;

	*points = (struct points){.rows = calloc((size_t)count + 1, sizeof(*points->rows))};
	if (!points->rows) {
		points_free(&old);
		return -ENOMEM;
	}
	points->count = count;
	for (int i = 0; i < count && !err; i++) {
		ows_info(ows, i, &info);
		if (!influx_series(measurement, info.identity, instance, info.name, info.unit,
		                   series)) {
			points->left_out++;
			continue;
		}
		points->rows[i].series = strdup(series);
		if (points->rows[i].series)
			take_over(&points->rows[i], &old, i);
		else
			err = -ENOMEM;
	}
	if (!err)
		send_quality(&old, pending, OWS_Q_NO_PROPERTY, now_ns);
	points_free(&old);
	if (err)
		points_free(points);
	return err;
}

void points_changes(struct points *points, struct ows *ows, struct pending *pending,
                    const int *signals, int n, int64_t now_ns)
{
	int count = signals ? n : points->count;
	struct face_value value;

	for (int i = 0; i < count; i++) {
		int signal = signals ? signals[i] : i;
		struct point_row *row;

		if (signal < 0 || signal >= points->count)
			continue;
		row = &points->rows[signal];
		if (!row->series)
			continue;
		face_value(ows, signal, true, now_ns, &value);
		/* FACE_LOST, or the next look at the changes, says why one is not known */
		if (value.known && face_value_print(&value.v, value.text) != row->fields)
			points_send(row, pending, face_value_time(&value.v, now_ns), &value.v,
			            value.text, now_ns);
	}
}

void points_repeat(struct points *points, struct ows *ows, struct pending *pending, int64_t now_ns)
{
	struct face_value value;
	int64_t time_ns;

	for (int i = 0; i < points->count; i++) {
		struct point_row *row = &points->rows[i];

		if (!row->series || now_ns - row->sent_ns < POINTS_REPEAT_NS)
			continue;
		face_value(ows, i, true, now_ns, &value);
		if (!value.known)
			continue;
		time_ns = face_value_time(&value.v, now_ns);
		if (face_value_print(&value.v, value.text) == row->fields &&
		    time_ns < now_ns - REPEATED_NS)
			time_ns = now_ns - REPEATED_NS;
		points_send(row, pending, time_ns, &value.v, value.text, now_ns);
	}
}

void points_lost(struct points *points, struct pending *pending, int64_t now_ns)
{
	send_quality(points, pending, OWS_Q_NO_OWSD, now_ns);
}
