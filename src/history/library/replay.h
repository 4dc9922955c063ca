/* SPDX-License-Identifier: MIT */
/*
 * All that a history has, in the order of recording: for a program that sends it somewhere else.
 * Not part of the library's interface.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows.h"

struct ows_history;

/* A moment that stays the same when the clock is set. */
struct replay_point {
	int64_t boot;    /* as history_boot_present() */
	int64_t us;      /* boot time */
	int64_t wall_us; /* the clock then, for a boot that the history does not know */
};
struct replay_row {
	struct replay_point at;
	int64_t wall_us; /* since 1970, by what is known now of the clock at that boot */
	bool dated;      /* that clock is known to have been right */
	int signal;      /* as of ows_history_signal(); -1: nothing is known of any from then on */
	struct ows_value v;
	char *text; /* of a string: of malloc(); else NULL */
};

/*
 * Where a moment is in the order. -ENOENT: no recorder was there in this boot yet. Of an earlier
 * boot that is not known it is the begin of the first run that is later by the clock, or the end.
 */
int64_t replay_place(const struct ows_history *h, const struct replay_point *point);
/* The place behind all that was there when the history was opened or refreshed. */
int64_t replay_end(const struct ows_history *h);
/* Up to n rows of the places from first up to but without end: how many, or a negative errno. */
int replay_rows(struct ows_history *h, int64_t first, int64_t end, struct replay_row *rows, int n);
