/* SPDX-License-Identifier: MIT */
/*
 * Clients of the events of owsd-web at its Unix socket, in a thread: they count what comes, and
 * note how old the probe (many.h) is when they have it.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define STREAMS_MOST 100

/* Connect so many. Returns how many did. */
unsigned streams_open(const char *path, unsigned count);
/* Forget what was counted. */
void streams_begin(void);
/* Bytes that have come since; and latencies in ms, at most so many. */
uint64_t streams_bytes(void);
size_t streams_latencies(double *ms, size_t most);
void streams_close(void);
