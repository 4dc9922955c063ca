/* SPDX-License-Identifier: MIT */
/*
 * Lines that wait in memory to be sent, with boot times, as the wall clock may not be known yet. A
 * batch is lines with their wall-clock times. Bounded; allocates in pending_add() alone.
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
	uint64_t dropped; /* lines: the oldest ones, for which there was no room */
};

void pending_free(struct pending *pending);
/* A line without its time: series, blank, fields. Without room the oldest quarter goes. */
void pending_add(struct pending *pending, int64_t time_ns, const char *series, const char *fields);
/*
 * Move the oldest lines to a batch, as many as one may have. Returns its length; 0: nothing waits.
 * offset_ns: wall clock minus boot time.
 */
size_t pending_cut(struct pending *pending, int64_t offset_ns, char batch[BATCH_BYTES]);
/* The same, and they stay: *lines is how many there are, for pending_remove(). */
size_t pending_copy(const struct pending *pending, int64_t offset_ns, char batch[BATCH_BYTES],
                    unsigned *lines);
/* Remove the oldest lines. */
void pending_remove(struct pending *pending, unsigned lines);
/* There is a whole batch. */
bool pending_is_full(const struct pending *pending);
unsigned batch_lines(const char *batch, size_t len);
