/* SPDX-License-Identifier: MIT */
/*
 * A serving is everything that stands on one configuration: the workers of its targets, its shared
 * memory and its engine. A reload makes a second serving beside the first, which takes over the
 * workers that stay. No threads are started here; blocking.
 */
#pragma once

#include "src/daemon/engine/engine.h"
#include "src/daemon/engine/reload/adopt.h"
#include "src/daemon/host/memory.h"

struct last;
struct worker;

/* Messages that had to wait, and events that were dropped, of workers; commands not stored. */
struct serving_counts {
	uint64_t stalls, dropped, unstored;
};

struct serving {
	struct config *config; /* owned by the serving */
	struct memory memory;
	struct engine *engine;
	struct last *last; /* Start "last"; NULL: no output has it */
	struct engine_port *ports;
	struct worker **workers;
	bool *taken; /* for each worker: the serving after this one owns it now */
	unsigned worker_count;
	unsigned *bus_counters; /* how many each worker's bus has */
	unsigned own_counters;  /* index of the first counter that belongs to no bus and no lane */
	struct serving_counts before; /* of what reloads have ended */
};

struct porter;

struct serving_setup {
	struct config *config;
	const char *instance;
	const struct shm_dir *dir;
	struct log *log;
	struct porter *porter;
	void (*ring)(void *ctx); /* wakes the engine; any thread */
	void *ring_ctx;
	const struct engine_guests *guests;   /* NULL: none */
	const struct image_counter *counters; /* the host's */
	uint32_t counter_count;
	/* a reload: what is served now, and what of it stays; NULL: a start */
	struct serving *before;
	const struct adoption *plan;
};

/*
 * Returns 0, or a negative errno with the reason in why; then nothing was made or taken over, and
 * the caller still owns config. The image is not yet shown to consumers.
 */
int serving_make(struct serving *serving, const struct serving_setup *setup, char *why,
                 size_t why_size);
/*
 * Write the counters of the buses into the image; the caller's counters follow from own_counters
 * on.
 */
void serving_publish(struct serving *serving);
/* Of all, including what reloads have ended. */
struct serving_counts serving_counts(const struct serving *serving);
/* Keep the counts of what does not stay. Called by the engine's thread at a reload. */
void serving_keep_counts(struct serving *serving, const struct serving *before,
                         const struct adoption *plan);
/* End the workers that are not taken. Blocks; false: a worker did not end within timeout_ns. */
bool serving_stop(struct serving *serving, int64_t timeout_ns);
/* Free all, the configuration too. The workers that are not taken have ended before. */
void serving_free(struct serving *serving);
