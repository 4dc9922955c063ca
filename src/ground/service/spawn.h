/* SPDX-License-Identifier: MIT */
/* Starts another program. No signal is blocked or ignored there that is here. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

enum { SPAWN_KEPT = -1, SPAWN_NOWHERE = -2 };

struct spawn {
	const char *const *words; /* its command line, with NULL behind it */
	const char *path;         /* NULL: its first word, which PATH finds if it has no slash */
	int streams[3];           /* its standard streams: descriptors, or what stands above */
	char *const *variables;   /* NULL: those of this program */
	bool own_group;           /* it leads a process group of its own */
};

/* 0 and its process, or a negative errno. */
int spawn_begin(const struct spawn *spawn, pid_t *pid);
