/* SPDX-License-Identifier: MIT */
/* What the live table and the plain lines of `owsctl watch` have in common. */
#pragma once

#include "src/tool/owsctl/rows.h"

struct watch {
	struct ctl *ctl;
	struct ows *h;
	char *const *patterns;
	int pattern_count;
	bool driver;
	struct rows rows;
	uint32_t news; /* of ows_wait() */
	uint32_t generation;
	int64_t start_ns; /* of the owsd that has it */
	bool alive;
	int64_t left;   /* changes to show yet; negative: no limit */
	int64_t end_ns; /* INT64_MAX: no limit */
	struct reading *reading;
};

/* What happened to owsd. After a start and a reload the rows are new: all of them changed. */
struct watch_event {
	const char *word; /* in JSON */
	const char *told; /* "was started again"; "": it is not there */
};

extern const struct watch_event watch_lost;

/* Collect the rows of the present owsd. */
const struct watch_event *watch_collect(struct watch *watch, const struct ows_daemon *daemon);
/*
 * Sleep until owsd publishes something, at most timeout_ns, and follow it over restarts. NULL:
 * nothing happened to owsd.
 */
const struct watch_event *watch_sleep(struct watch *watch, int64_t timeout_ns);
/* Is it time to end? */
bool watch_over(const struct watch *watch);
