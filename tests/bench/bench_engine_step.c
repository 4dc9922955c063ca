/* SPDX-License-Identifier: MIT */
/*
 * The engine's cost of one request, from due to published, and of a step when nothing is due, for
 * tables of different length, with 1 to 64 targets.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/engine.h"
#include "src/daemon/engine/table.h"
#include "tests/bench/aid.h"

#define REQUESTS 200000
#define ROUNDS 7
#define TARGETS 64

static struct bus_req *pending[TARGETS];

static int submit(void *ctx, struct bus_req *req)
{
	struct bus_req **mine = ctx;

	if (*mine)
		return -1;
	*mine = req;
	return 0;
}

static void answer(struct engine *engine, unsigned target, int64_t now)
{
	static const char text[] = "     21.4375";
	struct bus_req *req = pending[target];
	struct bus_answer a = {.id = req->id, .len = sizeof(text) - 1, .measured_ns = now};

	memcpy(req->data, text, sizeof(text) - 1);
	if (strncmp(req->path, "/structure/", 11) == 0)
		a.err = -2;
	pending[target] = NULL;
	engine_answer(engine, target, &a, now);
}

/* So many steps, 30 us apart, as on a fast owserver; returns how many requests were answered. */
static unsigned steps(struct engine *engine, unsigned targets, unsigned count, int64_t *now)
{
	unsigned answered = 0;

	while (count--) {
		*now += 30000;
		engine_step(engine, *now);
		for (unsigned i = 0; i < targets; i++)
			if (pending[i]) {
				answer(engine, i, *now);
				answered++;
			}
	}
	return answered;
}

/* Of a request; quiet: of a step, when each signal is read every half hour. */
static double one_step_ns(unsigned signals, unsigned targets, bool quiet)
{
	struct config_target target[TARGETS];
	struct config_item *items = calloc(signals, sizeof(*items));
	struct image_signal *rows = calloc(signals, sizeof(*rows));
	char(*text)[64] = calloc(signals, sizeof(*text));
	struct image_counter counters[2048];
	const char *names[TARGETS];
	struct config config = {.file = "bench",
	                        .targets = target,
	                        .target_count = targets,
	                        .max_retries = 3,
	                        .timeout_ns = 20000000000,
	                        .period_ns = 1000000,
	                        .items = items,
	                        .item_count = signals};
	struct engine_port port[TARGETS];
	struct bus_event up = {.news = BUS_UP};
	struct engine_setup setup = {.config = &config, .ports = port, .port_count = targets};
	struct image_plan plan = {.signals = rows,
	                          .signal_count = signals,
	                          .targets = names,
	                          .target_count = targets,
	                          .counters = counters,
	                          .counter_count = engine_counter_count(targets)};
	struct image image;
	struct engine *engine;
	void *image_memory;
	double best[ROUNDS];
	int64_t now = 1000000000;

	for (unsigned i = 0; i < targets; i++) {
		names[i] = "bench";
		target[i] = (struct config_target){.text = "bench"};
		port[i] = (struct engine_port){.target = "bench",
		                               .depth = 1,
		                               .ctx = &pending[i],
		                               .group = i,
		                               .submit = submit};
		pending[i] = NULL;
	}
	for (unsigned i = 0; i < signals; i++) {
		snprintf(text[i], 32, "signal%u", i);
		snprintf(text[i] + 32, 32, "/28.%012X/temperature", i);
		items[i] = (struct config_item){.name = text[i],
		                                .path = text[i] + 32,
		                                .type = OWS_DOUBLE,
		                                .readable = true,
		                                .per_factor = quiet ? 1800000 : 1,
		                                .init_text = "",
		                                .safe_text = ""};
		signal_table_image(&items[i], &rows[i]);
	}
	engine_counter_plan(targets, counters);
	image_memory = aligned_alloc(64, (image_size(&plan) + 63) / 64 * 64);
	memset(image_memory, 0, image_size(&plan));
	image_build(&plan, image_memory, &image);
	setup.image = &image;
	setup.start_ns = now;
	if (engine_create(&setup, &engine))
		exit(1);
	for (unsigned i = 0; i < targets; i++)
		engine_event(engine, i, &up, now);
	while (steps(engine, targets, 100, &now) && quiet)
		;
	steps(engine, targets, signals + 10, &now);
	for (int round = 0; round < ROUNDS; round++) {
		int64_t begin = bench_now();
		unsigned done = 0;

		/* small tables idle between periods */
		if (quiet)
			steps(engine, targets, done = REQUESTS, &now);
		while (done < REQUESTS)
			done += steps(engine, targets, 1, &now);
		best[round] = (double)(bench_now() - begin) / REQUESTS;
	}
	engine_destroy(engine);
	free(image_memory);
	free(items);
	free(rows);
	free(text);
	return bench_percentile(best, ROUNDS, 50);
}

static void measure(const char *what, unsigned signals, unsigned targets, bool quiet)
{
	char name[48];

	snprintf(name, sizeof(name), "engine_step.%s", what);
	bench_line(name, one_step_ns(signals, targets, quiet), "ns");
}

int main(void)
{
	bench_pin(0);
	measure("10", 10, 1, false);
	measure("100", 100, 1, false);
	measure("1000", 1000, 1, false);
	measure("10000", 10000, 1, false);
	measure("targets.8", 1000, 8, false);
	measure("targets.16", 1000, 16, false);
	measure("targets.64", 1000, 64, false);
	measure("quiet.10", 10, 1, true);
	measure("quiet.10000", 10000, 1, true);
	measure("quiet.targets.16", 1000, 16, true);
	measure("quiet.targets.64", 1000, 64, true);
	return 0;
}
