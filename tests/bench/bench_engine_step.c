/* SPDX-License-Identifier: MIT */
/* The engine's cost of one request, from due to published, for tables of different length. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/engine/counters.h"
#include "src/engine/engine.h"
#include "src/engine/table.h"
#include "tests/bench/aid.h"

#define REQUESTS 200000
#define ROUNDS 7

static struct bus_req *pending;

static int submit(void *ctx, struct bus_req *req)
{
	(void)ctx;
	if (pending)
		return -1;
	pending = req;
	return 0;
}

static void answer(struct engine *engine, int64_t now)
{
	static const char text[] = "     21.4375";
	struct bus_answer a = {.id = pending->id, .len = sizeof(text) - 1, .measured_ns = now};

	memcpy(pending->data, text, sizeof(text) - 1);
	if (strncmp(pending->path, "/structure/", 11) == 0)
		a.err = -2;
	pending = NULL;
	engine_answer(engine, 0, &a, now);
}

static double one_step_ns(unsigned signals)
{
	struct config_target target = {.text = "bench"};
	struct config_item *items = calloc(signals, sizeof(*items));
	struct image_signal *rows = calloc(signals, sizeof(*rows));
	char(*text)[64] = calloc(signals, sizeof(*text));
	struct image_counter counters[64];
	const char *targets[] = {"bench"};
	struct config config = {.file = "bench",
	                        .targets = &target,
	                        .target_count = 1,
	                        .max_retries = 3,
	                        .timeout_ns = 20000000000,
	                        .period_ns = 1000000,
	                        .items = items,
	                        .item_count = signals};
	struct engine_port port = {.target = "bench", .depth = 1, .submit = submit};
	struct bus_event up = {.news = BUS_UP};
	struct engine_setup setup = {.config = &config, .ports = &port, .port_count = 1};
	struct image_plan plan = {.signals = rows,
	                          .signal_count = signals,
	                          .targets = targets,
	                          .target_count = 1,
	                          .counters = counters,
	                          .counter_count = engine_counter_count(1)};
	struct image image;
	struct engine *engine;
	void *image_memory;
	double best[ROUNDS];
	int64_t now = 1000000000;

	for (unsigned i = 0; i < signals; i++) {
		snprintf(text[i], 32, "signal%u", i);
		snprintf(text[i] + 32, 32, "/28.%012X/temperature", i);
		items[i] = (struct config_item){.name = text[i],
		                                .path = text[i] + 32,
		                                .type = OWS_DOUBLE,
		                                .readable = true,
		                                .per_factor = 1,
		                                .init_text = "",
		                                .safe_text = ""};
		signal_table_image(&items[i], &rows[i]);
	}
	engine_counter_plan(1, counters);
	image_memory = aligned_alloc(64, (image_size(&plan) + 63) / 64 * 64);
	memset(image_memory, 0, image_size(&plan));
	image_build(&plan, image_memory, &image);
	setup.image = &image;
	setup.start_ns = now;
	if (engine_create(&setup, &engine))
		exit(1);
	engine_event(engine, 0, &up, now);
	for (unsigned i = 0; i < signals + 10; i++) {
		now += 30000;
		engine_step(engine, now);
		if (pending)
			answer(engine, now);
	}
	for (int round = 0; round < ROUNDS; round++) {
		int64_t begin = bench_now();
		unsigned done = 0;

		/* 30 us a request, as on a fast owserver: small tables idle between periods */
		while (done < REQUESTS) {
			now += 30000;
			engine_step(engine, now);
			if (!pending)
				continue;
			answer(engine, now);
			done++;
		}
		best[round] = (double)(bench_now() - begin) / REQUESTS;
	}
	engine_destroy(engine);
	free(image_memory);
	free(items);
	free(rows);
	free(text);
	return bench_percentile(best, ROUNDS, 50);
}

int main(void)
{
	static const unsigned tables[] = {10, 100, 1000, 10000};
	char name[32];

	bench_pin(0);
	for (unsigned i = 0; i < sizeof(tables) / sizeof(tables[0]); i++) {
		snprintf(name, sizeof(name), "engine_step.%u", tables[i]);
		bench_line(name, one_step_ns(tables[i]), "ns");
	}
	return 0;
}
