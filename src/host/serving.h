/* SPDX-License-Identifier: MIT */
/*
 * What stands on one configuration: the workers of its targets, its shared memory and its engine. A
 * reload makes another one beside it, which takes the workers over that stay. No threads are started
 * here; blocking.
 */
#ifndef HOST_SERVING_H
#define HOST_SERVING_H

#include "src/engine/adopt.h"
#include "src/engine/engine.h"
#include "src/host/memory.h"

struct worker;

struct serving {
	struct config *config; /* its own */
	struct memory memory;
	struct commands *commands; /* as the engine uses them */
	struct engine *engine;
	struct engine_port *ports;
	struct worker **workers;
	bool *taken; /* this worker belongs to the one after */
	unsigned worker_count;
	unsigned *bus_counters; /* how many each worker's bus has */
	unsigned own_counters;  /* index of the first counter that is of no bus and of no lane */
	uint64_t stalls_before, dropped_before; /* of workers that reloads have ended */
};

struct serving_setup {
	struct config *config;
	const char *instance;
	struct log *log;
	void (*ring)(void *ctx); /* wakes the engine; any thread */
	void *ring_ctx;
	const struct engine_guests *guests;   /* NULL: none */
	const struct image_counter *counters; /* of the host */
	uint32_t counter_count;
	/* of a reload: what is there, and what of it stays; NULL: a start */
	struct serving *before;
	const struct adoption *plan;
};

/*
 * Returns 0 or a negative errno, the reason then stands in why and nothing was made or taken, nor is
 * config. The image is not shown.
 */
int serving_make(struct serving *serving, const struct serving_setup *setup, char *why,
                 size_t why_size);
/* The counters of its buses into the image; the caller's stand behind them, from own_counters. */
void serving_publish(struct serving *serving);
/* Of all workers, those that reloads have ended included: messages that had to wait, events dropped. */
uint64_t serving_stalls(const struct serving *serving);
uint64_t serving_dropped(const struct serving *serving);
/* The engine's thread, at a reload: what the workers that do not stay have counted is kept. */
void serving_keep_counts(struct serving *serving, const struct serving *before, const int *ports);
/* End the workers that are not taken. Blocks; false: one did not end within timeout_ns. */
bool serving_stop(struct serving *serving, int64_t timeout_ns);
/* Ends nothing: workers that are not taken have ended. The configuration goes too. */
void serving_free(struct serving *serving);

#endif
