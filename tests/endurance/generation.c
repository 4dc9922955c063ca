/* SPDX-License-Identifier: MIT */
/* What belongs to one configuration: made, put in the place of another, ended. */
#include <stdlib.h>
#include <string.h>

#include "src/config/check/know.h"
#include "src/config/read/load.h"
#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/table.h"
#include "tests/endurance/memory.h"
#include "tests/endurance/program.h"
#include "tests/endurance/station_private.h"
#include "tests/unit/aid/giving.h"

static void free_generation(struct generation *g)
{
	engine_destroy(g->engine);
	controller_layout_free(&g->layout);
	config_free(g->config);
	free(g->image_memory);
	free(g);
}

/* Of the generations that were replaced, those whose buses have ended. */
void station_leave(void)
{
	for (unsigned i = 0; i < station.leaving_count;) {
		struct generation *g = station.leaving[i];
		bool ended = true;

		for (unsigned k = 0; k < g->ending_count; k++)
			ended &= g->ending[k]->fiber.ended && !station_bus_speaks(g->ending[k]);
		if (!ended) {
			i++;
			continue;
		}
		for (unsigned k = 0; k < g->ending_count; k++)
			station_bus_free(g->ending[k]);
		memory_watch(true);
		engine_abandon(g->engine);
		memory_watch(false);
		free_generation(g);
		station.leaving[i] = station.leaving[--station.leaving_count];
	}
}

static void say(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	if (is_error)
		world_fails("its configuration was refused", message);
}

static void *aligned(size_t size)
{
	size_t room = (size + 63) / 64 * 64;
	void *memory = aligned_alloc(64, room);

	if (!memory)
		world_fails("no memory", "");
	memset(memory, 0, room);
	return memory;
}

static void make_memory(struct generation *g)
{
	struct config *c = g->config;
	const char *targets[STATION_PARTS];
	uint32_t groups[STATION_PARTS];
	struct image_signal *rows = calloc(c->item_count, sizeof(*rows));
	uint8_t *types = calloc(c->item_count, sizeof(*types));
	struct image_counter *counters = calloc(engine_counter_count(c->target_count),
	                                        sizeof(*counters));
	struct image_plan plan = {.signals = rows,
	                          .signal_count = c->item_count,
	                          .targets = targets,
	                          .target_count = c->target_count,
	                          .groups = groups,
	                          .counters = counters,
	                          .counter_count = engine_counter_count(c->target_count),
	                          .generation = (uint32_t)station.reloads + 1,
	                          .start_id = 7,
	                          .pid = 1,
	                          .start_ns = station.start,
	                          .period_ns = c->period_ns};

	if (!rows || !types || !counters)
		world_fails("no memory", "");
	for (unsigned i = 0; i < c->item_count; i++) {
		signal_table_image(&c->items[i], &rows[i]);
		types[i] = (uint8_t)c->items[i].type;
	}
	for (unsigned i = 0; i < c->target_count; i++) {
		targets[i] = c->targets[i].text;
		groups[i] = c->targets[i].group;
	}
	engine_counter_plan(c->target_count, counters);
	g->image_memory = aligned(image_size(&plan));
	image_build(&plan, g->image_memory, &g->image);
	giving_layout(&g->layout, types, c->item_count);
	free(rows);
	free(types);
	free(counters);
}

/* Those of `before` that go on, the others made anew. */
static void make_ports(struct generation *g, const struct generation *before,
                       const struct adoption *plan)
{
	const struct config *c = g->config;

	g->port_count = c->target_count;
	for (unsigned i = 0; i < c->target_count; i++) {
		bool first = i == 0 || c->targets[i].group != c->targets[i - 1].group;
		struct station_bus *b = before && plan->ports[i] >= 0
		                                ? before->bus[plan->ports[i]]
		                                : station_bus_open(&c->targets[i], !first);

		g->bus[i] = b;
		g->ports[i] = (struct engine_port){
			.target = c->targets[i].text,
			.depth = bus_depth(b->bus),
			.searches = b->bus->ops->searches,
			.brief = b->bus->ops->brief,
			.submit = station_submit,
			.ctx = b,
			.group = c->targets[i].group,
			.suspend = b->bus->ops->suspend ? station_suspend : NULL,
		};
	}
}

static struct generation *make_generation(const char *rio, const struct generation *before,
                                          struct adoption *plan)
{
	struct generation *g = calloc(1, sizeof(*g));
	struct config_report report = {.line = say};
	struct engine_setup setup;

	if (!g || config_parse("world.rio", rio, strlen(rio), &report, &g->config))
		world_fails("no memory", "");
	config_know(g->config);
	if (before && adoption_plan(plan, g->config, before->config))
		world_fails("no memory", "");
	make_memory(g);
	make_ports(g, before, plan);
	setup = (struct engine_setup){.config = g->config,
	                              .ports = g->ports,
	                              .port_count = g->port_count,
	                              .image = &g->image,
	                              .log = station.log,
	                              .start_ns = station.now};
	if (engine_create(&setup, &g->engine))
		world_fails("no memory", "");
	program_join(g);
	return g;
}

void station_begin(const char *rio)
{
	for (unsigned i = 0; i < STATION_BUSES; i++)
		station.bus[i].fd = -1;
	station_log_begin();
	station.now_serving = make_generation(rio, NULL, NULL);
	program_moved();
	for (unsigned i = 0; i < station.now_serving->port_count; i++)
		station.now_serving->bus[i]->port = i;
	station.engine_ns = station.now;
}

void station_reload(const char *rio)
{
	struct generation *before = station.now_serving, *g;
	struct adoption plan;

	if (station.leaving_count == STATION_LEAVING)
		return;
	g = make_generation(rio, before, &plan);
	memory_watch(true);
	engine_adopt(g->engine, before->engine, &plan, station.now);
	memory_watch(false);
	program_moved();
	for (unsigned i = 0; i < before->port_count; i++)
		before->bus[i]->port = STATION_GONE;
	for (unsigned i = 0; i < g->port_count; i++)
		g->bus[i]->port = i;
	for (unsigned i = 0; i < before->port_count; i++) {
		struct station_bus *b = before->bus[i];

		if (b->port != STATION_GONE)
			continue;
		b->stopping = true;
		b->orders = 0;
		if (!b->in_kernel)
			b->wake_ns = station.now;
		before->ending[before->ending_count++] = b;
	}
	station.leaving[station.leaving_count++] = before;
	station.now_serving = g;
	station.reloads++;
	station.engine_ns = station.now;
	adoption_free(&plan);
}

void station_end(void)
{
	struct generation *g = station.now_serving;

	for (unsigned i = 0; i < g->port_count; i++) {
		struct station_bus *b = g->bus[i];

		b->stopping = true;
		b->port = STATION_GONE;
		if (!b->in_kernel)
			b->wake_ns = station.now;
		while (!b->fiber.ended) {
			if (b->wake_ns > station.now)
				station.now = b->wake_ns;
			station.running = b;
			fiber_enter(&b->fiber);
		}
		station.running = NULL;
		station.message_count = 0;
		station_bus_free(b);
	}
	free_generation(g);
	program_end();
	for (unsigned i = 0; i < station.part_count; i++)
		station.part[i].ops->end(&station.part[i]);
	memset(&station, 0, sizeof(station));
}
