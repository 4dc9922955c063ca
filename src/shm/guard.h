/* SPDX-License-Identifier: MIT */
/*
 * The guard of a range of memory that maps a file which others may truncate: on a SIGBUS inside the
 * range, the guard maps private zero pages over the whole range, and the thread that touched it
 * goes on. Any other SIGBUS goes to the handler from before the first guard.
 */
#ifndef SHM_GUARD_H
#define SHM_GUARD_H

#include <stdbool.h>
#include <stddef.h>

#define GUARD_MAX 4

/*
 * Returns 0, or -ENOSPC when GUARD_MAX ranges are guarded; with only_default -EBUSY when the
 * process has a SIGBUS handler of its own.
 */
int guard_add(void *base, size_t size, bool only_default);
void guard_remove(const void *base);
/* The file was truncated, and what is behind its end was touched. */
bool guard_lost(const void *base);

#endif
