/* SPDX-License-Identifier: MIT */
/*
 * Lines that wait in memory to be sent, with boot times, as the wall clock may not be known yet.
 * Those of an earlier boot have wall-clock times, which the clock of this boot does not change. A
 * batch is a copy of the oldest lines with their wall-clock times; they stay until the server has
 * them. Bounded; allocates when a line is added.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a server takes at once. */
#define BATCH_LINES 5000u
#define BATCH_BYTES (1u << 20)
#define PENDING_BYTES (4u << 20)

struct pending {
	char *data;
	size_t len, room;
	unsigned lines;
	uint64_t first;     /* the number of the oldest line */
	uint64_t dropped;   /* lines: the oldest ones, for which there was no room */
	int64_t dropped_ns; /* the newest time of these, but of dated ones */
};

void pending_free(struct pending *pending);
/* A line without its time: series, blank, fields. Without room the oldest quarter goes. */
void pending_add(struct pending *pending, int64_t time_ns, const char *series, const char *fields);
/* The same with a wall-clock time. */
void pending_add_dated(struct pending *pending, int64_t wall_ns, const char *series,
                       const char *fields);
/*
 * Copy the oldest lines, whole ones, at most most bytes of them (and BATCH_BYTES), but one at
 * least. Returns the length; 0: nothing waits. *lines is how many there are. offset_ns: wall clock
 * minus boot time.
 */
size_t pending_copy(const struct pending *pending, int64_t offset_ns, size_t most,
                    char batch[BATCH_BYTES], unsigned *lines);
/* Remove what is there yet of the lines before that number. */
void pending_remove(struct pending *pending, uint64_t before);
/* There is a whole batch. */
bool pending_is_full(const struct pending *pending);
