/* SPDX-License-Identifier: MIT */
/*
 * The signals that end the program (SIGTERM, SIGINT) and those that have it load its file again
 * (SIGHUP). They are blocked in all threads, and one thread takes them while it waits: no code runs
 * in a handler.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct unix_signals {
	int fd;
	int end;     /* the first signal that ends the program; 0: none has come */
	bool reload; /* SIGHUP has come; the caller sets this to false before it loads the file */
};

/*
 * Before any other thread runs, because threads inherit what is blocked. SIGPIPE is ignored from
 * here on. Returns 0 or a negative errno.
 */
int unix_signals_open(struct unix_signals *signals);

/* Takes all that have come, for a caller that has waited for signals->fd itself. Never blocks. */
void unix_signals_take(struct unix_signals *signals);
/*
 * Sleeps until a signal comes or one of two descriptors is readable, at most so long; then takes
 * all signals that have come.
 */
void unix_signals_wait(struct unix_signals *signals, const int fds[2], int64_t at_most_ns);
