/* SPDX-License-Identifier: MIT */
/*
 * The signals in the order of their last change. Each change has a cursor: the time at which
 * owsd-web saw it, in microseconds of CLOCK_BOOTTIME, made greater than that of the change before
 * it. So a cursor still means the same to an owsd-web that was started again.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct recent {
	int count;
	struct recent_change {
		uint64_t cursor;  /* of the last change of a signal; 0: none yet */
		uint64_t mark;    /* of what the signal had then */
		int older, newer; /* neighbours; -1: there is none */
	} * of;
	int first, last; /* the oldest and the newest */
	uint64_t newest; /* cursor of all that is known */
};

/* A table of that many signals, without changes. False: no memory, and the table is empty. */
bool recent_make(struct recent *recent, int count);
void recent_free(struct recent *recent);
/* The cursor for what happens now. */
uint64_t recent_next(struct recent *recent, int64_t now_ns);
/* mark: of what the signal has now; one that has the same as at its last change has not changed. */
void recent_change(struct recent *recent, int signal, uint64_t mark, int64_t now_ns);
/* The first signal that changed after the cursor; -1: none has. */
int recent_after(const struct recent *recent, uint64_t cursor);
