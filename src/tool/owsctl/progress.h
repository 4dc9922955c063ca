/* SPDX-License-Identifier: MIT */
/*
 * How far a long reading has come: a bar in one line of stderr, if that is a terminal, from the
 * second second on. It is taken away at the end. Not blocking beyond a write to the terminal.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct progress {
	const char *what; /* "room1" */
	int64_t next_ns;  /* on the clock of ows_now(); INT64_MAX: it is not shown */
	bool shown;
};

/* now_ns: ows_now(). terminal: whether stderr is one; progress_begin() looks. */
struct progress progress_begin(const char *what, int64_t now_ns);
struct progress progress_on(const char *what, int64_t now_ns, bool terminal);
/* so much of all is done, from 0 to all; anything else counts as the nearer of both. */
void progress_show(struct progress *progress, int64_t now_ns, int64_t done, int64_t all);
void progress_end(struct progress *progress);
