/* SPDX-License-Identifier: MIT */
/*
 * What a start and a reload make: what serves a configuration, and its threads beside the engine's.
 */
#pragma once

#include <stddef.h>

struct adoption;
struct config;
struct host;
struct serving;

/* Returns 0, or a negative errno with the reason in why; plan NULL: a start. */
int host_make_serving(struct host *host, struct config *config, const struct adoption *plan,
                      struct serving **serving, char *why, size_t why_size);
/* Start all workers that do not run yet; returns the error of the first that cannot be started. */
int host_start_workers(struct serving *serving, char *why, size_t why_size);
int host_start_indicator(struct host *host, char *why, size_t why_size);
