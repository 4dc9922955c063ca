/* SPDX-License-Identifier: MIT */
/*
 * The rows of owsd-influx: of each signal the begin of its lines, and what was sent last. A value
 * becomes a line when it differs from that, and every ten minutes. A value that is not good becomes
 * a line that has its quality alone. Allocates in points_make() and pending_add().
 */
#pragma once

#include <stdint.h>

#include "src/faces/influx/pending.h"
#include "src/public/ows.h"

#define POINTS_REPEAT_NS (600 * INT64_C(1000000000))

struct point_row {
	char *series;    /* NULL: no line can have that name */
	uint64_t fields; /* face_value_print() of those that were sent last; 0: none were */
	int64_t sent_ns;
	/* Of the last line of that series, also by an image before. */
	int64_t time_ns;
	uint64_t had;
};
struct points {
	struct point_row *rows;
	int count, left_out; /* those without a series */
};

/*
 * Make the rows of the present image; each value is sent anew. A signal that the rows of before had
 * and the image has not gets a last line, with the quality OWS_Q_NO_PROPERTY alone. 0 or -ENOMEM:
 * no rows.
 */
int points_make(struct points *points, struct ows *ows, const char *measurement,
                const char *instance, struct pending *pending, int64_t now_ns);
void points_free(struct points *points);

/* Signals that changed; signals NULL: look at all. */
void points_changes(struct points *points, struct ows *ows, struct pending *pending,
                    const int *signals, int n, int64_t now_ns);
/* Repeat what was sent last more than ten minutes ago. The rows have to be of the image of ows. */
void points_repeat(struct points *points, struct ows *ows, struct pending *pending, int64_t now_ns);
/* owsd is lost: from now on no value is good. */
void points_lost(struct points *points, struct pending *pending, int64_t now_ns);

/* The fields of a value, with its quality. Pure. */
void points_fields(const struct ows_value *v, const char *text, char *fields, size_t size);
