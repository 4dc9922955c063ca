/* SPDX-License-Identifier: MIT */
/* The instance as this process holds it: its lock, taken at the start and looked after. */
#ifndef OWSD_INSTANCE_H
#define OWSD_INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/text/log.h"

struct instance {
	const char *name;
	int lock;        /* -1: not held */
	unsigned before; /* a bit for each file that was there before the start */
	int64_t look_ns; /* not sooner */
	struct log_rate rate;
};

/* 0 or a negative errno, the reason then stands in why. Does not wait. */
int instance_take(struct instance *instance, const char *name, struct log *log, char *why,
                  size_t why_size);
/*
 * Look, once a second, whether the lock's file is still there, and take the lock again where it was
 * removed. False, and said: another owsd was first; this one has to end. Two system calls.
 */
bool instance_keep(struct instance *instance, struct log *log);
void instance_leave(struct instance *instance);
/* After a start that failed: take away the files that were not there before it, and leave. */
void instance_abandon(struct instance *instance);

#endif
