/* SPDX-License-Identifier: MIT */
/*
 * Stores the last commands of outputs with Start "last", on a thread of its own: at most once a
 * second, all changes since then at once.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/daemon/engine/command/last.h"
#include "src/ground/text/log.h"

struct last;

struct last_setup {
	const char *instance;
	const struct config *config; /* outlives it */
	struct log *log;
	void (*ring)(void *ctx); /* wakes the engine; any thread */
	void *ring_ctx;
};
/*
 * Read what was stored. *last gets NULL if no output has Start "last". A file that cannot be read
 * is logged. 0 or -ENOMEM. Blocking.
 */
int last_make(const struct last_setup *setup, struct last **last);
/* For the engine; NULL if last is. */
const struct engine_last *last_seam(const struct last *last);
/*
 * Start the thread; does nothing if it runs. What the engine puts before that waits. 0 or a
 * negative errno.
 */
int last_start(struct last *last);
/*
 * Store what waits, once, and end the thread. Nothing is put any more. False: the disk did not
 * answer within timeout_ns, and the thread uses all this still. May be called again.
 */
bool last_stop(struct last *last, int64_t timeout_ns);
/* Store nothing, and never start: the thread of a configuration before still holds the file. */
void last_give_up(struct last *last);
/* Tries that failed. */
uint64_t last_failures(const struct last *last);
void last_free(struct last *last);
