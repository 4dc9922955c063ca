/* SPDX-License-Identifier: MIT */
/* Makes, stops and frees what stands on one configuration: workers, shared memory, engine. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/worker.h"
#include "src/config/read/load.h"
#include "src/daemon/engine/counters.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/serving.h"
#include "src/daemon/host/target.h"
#include "src/public/ows.h"

static int submit(void *ctx, struct bus_req *req)
{
	return worker_submit(ctx, req);
}

static void suspend(void *ctx, bool yes)
{
	worker_suspend(ctx, yes);
}

static int new_worker(struct serving *s, const struct serving_setup *setup, unsigned i, char *why,
                      size_t why_size)
{
	const char *target = s->config->targets[i].text;
	char reason[256] = "", name[24];
	int err;

	snprintf(name, sizeof(name), "owsd-bus%u", i);
	err = worker_create(target, name, setup->ring, setup->ring_ctx, &s->workers[i], reason,
	                    sizeof(reason));
	if (err) {
		snprintf(why, why_size, "target %s: %s", target, *reason ? reason : strerror(-err));
		return err;
	}
	err = target_options(worker_bus(s->workers[i]), s->config, target, reason, sizeof(reason));
	if (err) {
		snprintf(why, why_size, "target %s: %s", target, reason);
		worker_destroy(s->workers[i]);
		return err;
	}
	/* of several ways to one wire only the first is open at the start */
	if (s->config->targets[i].relation == CONFIG_BAR)
		worker_suspend(s->workers[i], true);
	return 0;
}

static int make_workers(struct serving *s, const struct serving_setup *setup, char *why,
                        size_t why_size)
{
	unsigned count = s->config->target_count;

	s->workers = calloc(count, sizeof(*s->workers));
	s->taken = calloc(count, sizeof(*s->taken));
	s->ports = calloc(count, sizeof(*s->ports));
	s->bus_counters = calloc(count, sizeof(*s->bus_counters));
	if (!s->workers || !s->taken || !s->ports || !s->bus_counters)
		return -ENOMEM;
	for (unsigned i = 0; i < count; i++) {
		int from = setup->plan ? setup->plan->ports[i] : -1, err = 0;
		size_t n = 0;

		if (from >= 0)
			s->workers[i] = setup->before->workers[from];
		else
			err = new_worker(s, setup, i, why, why_size);
		if (err)
			return err;
		s->worker_count++;
		bus_counters(worker_bus(s->workers[i]), &n);
		s->bus_counters[i] = (unsigned)n;
		s->ports[i] = (struct engine_port){
			.target = s->config->targets[i].text,
			.depth = bus_depth(worker_bus(s->workers[i])),
			.searches = worker_bus(s->workers[i])->ops->searches,
			.brief = worker_bus(s->workers[i])->ops->brief,
			.submit = submit,
			.ctx = s->workers[i],
			.group = s->config->targets[i].group,
			.suspend = suspend,
		};
	}
	return 0;
}

/* The counters in the image: the engine's, then each bus's, then the host's. */
static int make_memory(struct serving *s, const struct serving_setup *setup, char *why,
                       size_t why_size)
{
	unsigned count = engine_counter_count(s->worker_count), first = count;
	struct image_counter *plan;
	char(*names)[48];
	int err;

	s->own_counters = count;
	for (unsigned i = 0; i < s->worker_count; i++)
		s->own_counters += s->bus_counters[i];
	plan = calloc(s->own_counters + setup->counter_count, sizeof(*plan));
	names = calloc(s->own_counters - count + 1, sizeof(*names));
	if (!plan || !names) {
		free(plan);
		free(names);
		return -ENOMEM;
	}
	engine_counter_plan(s->worker_count, plan);
	for (unsigned i = 0; i < s->worker_count; i++) {
		size_t n;
		const struct bus_counter *c = bus_counters(worker_bus(s->workers[i]), &n);

		for (size_t k = 0; k < s->bus_counters[i]; k++, count++) {
			snprintf(names[count - first], sizeof(*names), "bus_%s", c[k].name);
			plan[count] = (struct image_counter){names[count - first], i};
		}
	}
	memcpy(plan + count, setup->counters, setup->counter_count * sizeof(*plan));
	count += setup->counter_count;
	err = memory_make(&s->memory,
	                  &(struct memory_setup){
				  .instance = setup->instance,
				  .dir = setup->dir,
				  .config = s->config,
				  .counters = plan,
				  .counter_count = count,
				  .log = setup->log,
				  .porter = setup->porter,
				  .before = setup->before ? &setup->before->memory : NULL,
			  },
	                  why, why_size);
	free(plan);
	free(names);
	return err;
}

static int make_engine(struct serving *s, const struct serving_setup *setup)
{
	struct engine_setup engine = {
		.config = s->config,
		.ports = s->ports,
		.port_count = s->worker_count,
		.image = &s->memory.image,
		.force = &s->memory.force,
		.left = s->memory.has_left ? &s->memory.left : NULL,
		.last = last_seam(s->last),
		.log = setup->log,
		.guests = setup->guests,
		.start_ns = s->memory.start_ns,
	};

	int err = engine_create(&engine, &s->engine);

	memory_resumed(&s->memory);
	return err;
}

int serving_make(struct serving *s, const struct serving_setup *setup, char *why, size_t why_size)
{
	int err;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	*s = (struct serving){.config = setup->config};
	err = make_workers(s, setup, why, why_size);
	if (!err)
		err = make_memory(s, setup, why, why_size);
	if (!err)
		err = last_make(&(struct last_setup){.instance = setup->instance,
		                                     .config = s->config,
		                                     .log = setup->log,
		                                     .ring = setup->ring,
		                                     .ring_ctx = setup->ring_ctx},
		                &s->last);
	if (!err)
		err = make_engine(s, setup);
	if (!err)
		return 0;
	for (unsigned i = 0; i < s->worker_count; i++)
		s->taken[i] = setup->plan && setup->plan->ports[i] >= 0; /* still the other's */
	s->config = NULL; /* the caller owns it again */
	serving_free(s);
	return err;
}

void serving_publish(struct serving *s)
{
	uint32_t index = engine_counter_count(s->worker_count);

	for (unsigned i = 0; i < s->worker_count; i++) {
		size_t n;
		const struct bus_counter *c = bus_counters(worker_bus(s->workers[i]), &n);

		for (size_t k = 0; k < s->bus_counters[i]; k++)
			image_counter(&s->memory.image, index++, bus_counted(&c[k]));
	}
}

static void add_counts(struct serving_counts *counts, const struct worker *worker)
{
	counts->stalls += worker_stalls(worker);
	counts->dropped += worker_dropped(worker);
}

struct serving_counts serving_counts(const struct serving *s)
{
	struct serving_counts counts = s->before;

	counts.unstored += last_failures(s->last);
	for (unsigned i = 0; i < s->worker_count; i++)
		add_counts(&counts, s->workers[i]);
	return counts;
}

void serving_keep_counts(struct serving *s, const struct serving *before,
                         const struct adoption *plan)
{
	s->before = before->before;
	s->before.unstored += last_failures(before->last);
	for (unsigned i = 0; i < before->worker_count; i++)
		if (plan->port_successors[i] < 0)
			add_counts(&s->before, before->workers[i]);
}

bool serving_stop(struct serving *s, int64_t timeout_ns)
{
	int64_t until_ns = ows_now() + timeout_ns;
	bool ended = true;

	/* ask all workers to end before waiting for any of them */
	for (unsigned i = 0; i < s->worker_count; i++)
		if (!s->taken[i])
			worker_stop(s->workers[i], 0);
	for (unsigned i = 0; i < s->worker_count; i++) {
		int64_t left_ns = until_ns - ows_now();

		if (!s->taken[i])
			ended &= worker_stop(s->workers[i], left_ns > 0 ? left_ns : 0) == 0;
	}
	return ended;
}

void serving_free(struct serving *s)
{
	engine_destroy(s->engine);
	for (unsigned i = 0; i < s->worker_count; i++)
		if (!s->taken[i])
			worker_destroy(s->workers[i]);
	memory_end(&s->memory);
	last_free(s->last);
	free(s->workers);
	free(s->taken);
	free(s->ports);
	free(s->bus_counters);
	config_free(s->config);
	*s = (struct serving){0};
}
