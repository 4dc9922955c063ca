/* SPDX-License-Identifier: MIT */
/* The engine's thread: what it does in turn, the bell that wakes it, the counters it publishes. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct host;
struct image_counter;

/* Start the engine's thread: 0, or a negative errno with the reason in why. */
int host_start_engine(struct host *host, int rt_priority, char *why, size_t why_size);
/* Wake the engine, from any thread. */
void host_ring(void *host);
/*
 * The counters that belong to no bus: the host's own, the control room's, then the server's. The
 * caller frees the plan.
 */
struct image_counter *host_plan_counters(const struct host *host, uint32_t *count);
