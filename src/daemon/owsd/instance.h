/* SPDX-License-Identifier: MIT */
/*
 * The instance as this process holds it: its lock is taken at the start and checked every second.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/ground/text/log.h"
#include "src/memory/shm/dir.h"

struct instance {
	const char *name;
	struct shm_dir dir; /* open as long as the lock is held */
	int lock;           /* -1: not held */
	unsigned before;    /* a bit for each file that was there before the start */
	int64_t look_ns;    /* not sooner */
	struct log_rate rate;
};

/*
 * Open the directory, made if missing, and take the lock. Returns 0, or a negative errno with the
 * reason in why. Does not wait.
 */
int instance_take(struct instance *instance, const char *name, struct log *log, char *why,
                  size_t why_size);
/*
 * Check, once a second, that the lock's file still exists, and take the lock again if the file was
 * removed. Returns false, after logging why, when another owsd was first: then this owsd has to
 * end. Two system calls.
 */
bool instance_keep(struct instance *instance, struct log *log);
void instance_leave(struct instance *instance);
/* After a start that failed: remove the files that did not exist before the start, and leave. */
void instance_abandon(struct instance *instance);
