/* SPDX-License-Identifier: MIT */
/*
 * The signals that end owsd (SIGTERM, SIGINT) and those that have it load its file again (SIGHUP).
 * They are blocked in all threads, and the supervisor takes them while it waits: no code of owsd
 * runs in a handler.
 */
#ifndef OWSD_UNIX_SIGNALS_H
#define OWSD_UNIX_SIGNALS_H

#include <stdbool.h>
#include <stdint.h>

struct unix_signals {
	int fd;
	int end;     /* the first signal that ends owsd; 0: none has come */
	bool reload; /* SIGHUP has come; whoever loads the file sets this to false before */
};

/*
 * Before any other thread runs, because threads inherit what is blocked. SIGPIPE is ignored from
 * here on. Returns 0 or a negative errno.
 */
int unix_signals_open(struct unix_signals *signals);

/* Sleeps until a signal comes or fd is readable, at most so long; then takes all that have come. */
void unix_signals_wait(struct unix_signals *signals, int fd, int64_t at_most_ns);

#endif
