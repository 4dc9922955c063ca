/* SPDX-License-Identifier: MIT */
/* What the live table and the plain lines of `owsctl watch` have in common. */
#pragma once

#include "src/tool/owsctl/rows.h"

#define WATCH_BATCH 1024

struct watch {
	struct ctl *ctl;
	struct ows *h;
	char *const *patterns;
	int pattern_count;
	bool driver;
	struct rows rows;
	int *row_of; /* of a signal: its row, -1: it is not watched */
	struct ows_cursor cursor;
	int changed[WATCH_BATCH]; /* signals since the last sleep began */
	int changed_count;        /* -1: all of them */
	uint32_t news;            /* counts sleeps that ended with a change */
	uint32_t generation;
	int64_t start_ns; /* of the owsd that has it */
	bool alive;
	int64_t left;   /* changes to show yet; negative: no limit */
	int64_t end_ns; /* INT64_MAX: no limit */
	struct reading *reading;
};

enum watch_event {
	WATCH_NOTHING,
	WATCH_RESTARTED, /* the rows were collected again: all of them changed */
	WATCH_RELOADED,  /* the same of an owsd that went on */
	WATCH_LOST,      /* owsd stopped, or its heart does not beat */
	WATCH_BACK,      /* the heart beats again */
};
/* Collect the rows of the present owsd. WATCH_RESTARTED or WATCH_RELOADED. */
enum watch_event watch_collect(struct watch *watch, const struct ows_daemon *daemon);
/* Free what watch_collect() made. */
void watch_free(struct watch *watch);
/*
 * Sleep until a signal changes, at least least_ns (below 1 s) and at most timeout_ns, and follow
 * owsd over restarts.
 */
enum watch_event watch_sleep(struct watch *watch, int64_t least_ns, int64_t timeout_ns);
/* Is it time to end? */
bool watch_over(const struct watch *watch);
