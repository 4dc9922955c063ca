/* SPDX-License-Identifier: MIT */
/*
 * Runs another program of owsd for a worker: what needs chips and buses is not in owsd-web. The
 * child has no more rights than owsd-web.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define CHILD_OUT (8u << 20) /* bytes of an output */
#define CHILD_WHY 512

struct child {
	const char *const *argv; /* of a program beside owsd-web, or in bin beside its folder */
	const char *input;       /* what it reads; NULL: nothing */
	size_t input_len;
	int64_t until_ns; /* killed then, CLOCK_BOOTTIME */
	int status;       /* with which it ended; -1: by a signal */
	char *out;        /* what it printed, with NUL behind it; free it in any case */
	size_t out_len;
	char why[CHILD_WHY]; /* its last line on stderr, without its name; "": none */
};

/* Start one that goes on beside this program, with its streams. 0, or a negative errno. */
int child_start(const char *const *argv, pid_t *pid);
/* 0: it ended by itself, with a status; -ETIMEDOUT, -E2BIG, or why it cannot run. Blocking. */
int child_run(struct child *child);
