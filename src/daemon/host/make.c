/* SPDX-License-Identifier: MIT */
/*
 * What a start and a reload make: what serves a configuration, and its threads beside the engine's.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/worker.h"
#include "src/daemon/host/engine_thread.h"
#include "src/daemon/host/indicator.h"
#include "src/daemon/host/make.h"
#include "src/daemon/host/private.h"
#include "src/daemon/serve/serve.h"

int host_make_serving(struct host *h, struct config *config, const struct adoption *plan,
                      struct serving **serving, char *why, size_t why_size)
{
	struct serving_setup setup = {
		.config = config,
		.instance = h->instance,
		.dir = h->dir,
		.log = h->log,
		.porter = h->porter,
		.ring = host_ring,
		.ring_ctx = h,
		.guests = h->serve ? serve_guests(h->serve) : NULL,
		.before = h->now,
		.plan = plan,
	};
	struct image_counter *counters = host_plan_counters(h, &setup.counter_count);
	int err = -ENOMEM;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	*serving = calloc(1, sizeof(**serving));
	setup.counters = counters;
	if (counters && *serving)
		err = serving_make(*serving, &setup, why, why_size);
	free(counters);
	if (!err)
		return 0;
	free(*serving);
	*serving = NULL;
	return err;
}

int host_start_indicator(struct host *h, char *why, size_t why_size)
{
	int err = indicator_create(h->now->config, &h->now->memory.image, h->log, &h->indicator);

	if (!err)
		err = indicator_start(h->indicator);
	if (!err)
		return 0;
	snprintf(why, why_size, "cannot start the thread of AlarmLine and HeartbeatLine: %s",
	         strerror(-err));
	indicator_destroy(h->indicator);
	h->indicator = NULL;
	return err;
}

int host_start_workers(struct serving *s, char *why, size_t why_size)
{
	int first = 0;

	for (unsigned i = 0; i < s->worker_count; i++) {
		int err = worker_started(s->workers[i]) ? 0 : worker_start(s->workers[i]);

		if (err && !first)
			snprintf(why, why_size, "cannot start the thread of target %s: %s",
			         s->config->targets[i].text, strerror(-err));
		first = first ? first : err;
	}
	return first;
}
