/* SPDX-License-Identifier: MIT */
/* The control programs of an endurance run. */
#include <stdio.h>
#include <string.h>

#include "src/daemon/engine/command/controllers.h"
#include "tests/endurance/program.h"
#include "tests/endurance/world.h"
#include "tests/unit/aid/giving.h"

#define BEAT_MS 3000

/* One never beats, and scribbles; the other one beats. */
enum { QUIET, BEATING, PROGRAMS };

static bool beats;
static struct giving programs[PROGRAMS], before[PROGRAMS];
static uint32_t serials;

static void join(struct generation *g, unsigned i)
{
	struct joining_controller controller = {.who = {.uid = 1, .pid = 42},
	                                        .token = {(uint8_t)(i + 1)}};

	/* the serial stays over a reload */
	controller.who.serial = before[i].memory.base ? giving_header(&before[i])->serial
	                                              : ++serials;
	snprintf(controller.who.name, sizeof(controller.who.name), "program%u", i);
	giving_make(&programs[i], &g->layout, controller.who.serial);
	controller.memory = programs[i].memory;
	engine_controller_join(g->engine, i, &controller, station.now);
}

void program_begin(void)
{
	beats = false;
}

void program_join(struct generation *g)
{
	for (unsigned i = 0; i < PROGRAMS; i++) {
		before[i] = programs[i];
		join(g, i);
	}
}

void program_moved(void)
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		giving_free(&before[i]);
}

void program_end(void)
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		giving_free(&programs[i]);
}

static void set_relays(unsigned program, unsigned value)
{
	giving_set(&programs[program], record_of("relays"), value);
	station_ring();
	commanded = (int)value;
}

bool program_beats(void)
{
	return beats;
}

void program_runs(void)
{
	if (beats)
		giving_beat(&programs[BEATING], 1000 * BEAT_MS);
}

void program_sets(unsigned value)
{
	set_relays(QUIET, value);
}

/* It hangs, or its process ends. */
void program_dies(void)
{
	bool hangs = world_random(2);

	world_note(hangs ? "the program hangs" : "the program dies");
	set_relays(BEATING, 1 + world_random(15));
	beats = true;
	program_runs();
	station_run(station.now + (int64_t)world_random(20) * FIELD_S);
	beats = false;
	giving_beat(&programs[BEATING], BEAT_MS);
	station_run(station.now + FIELD_S);
	if (!hangs) {
		engine_controller_left(station.now_serving->engine, BEATING, station.now);
		giving_free(&programs[BEATING]);
	}
	station_run(station.now + 2 * BEAT_MS / 1000 * FIELD_S);
	commanded = 0; /* SafeValue */
	if (!hangs)
		join(station.now_serving, BEATING);
}

static void scribble_slots(struct giving *g, uint32_t records)
{
	for (unsigned i = 0; i < 20; i++) {
		uint32_t record = 1 + world_random(records), word = world_random(16);
		uint32_t *slot = (uint32_t *)(void *)giving_slot(g, record);

		/* a table believes what it is told, also of a temperature */
		if (world->moody && record != record_of("relays") && word == 5)
			continue;
		slot[word] = world_random(2) ? world_random(4) : world_random(1 << 24) << 8;
		giving_mark(g, record);
	}
}

void program_scribbles(void)
{
	struct giving *g = &programs[QUIET];
	uint32_t n = station.now_serving->config->item_count, *words = (void *)g->memory.base;
	uint32_t serial = giving_header(g)->serial;

	world_note("scribbles");
	scribble_slots(g, n);
	for (unsigned i = 0; i < 4; i++)
		words[world_random(256 / 4)] = world_random(1 << 24);
	words[g->memory.layout->header.dirty_off / 4] = world_random(1 << 24);
	words[g->memory.layout->header.shelf_off / 4 + world_random(24)] = world_random(1 << 24);
	giving_header(g)->marked = 1;
	station_ring();
	station_run(station.now + (1 + world_random(30)) * FIELD_S);
	/* and sets it right */
	giving_header(g)->serial = serial;
	giving_header(g)->goodbye = 0;
	giving_beat(g, 0);
	for (uint32_t record = 1; record <= n; record++) {
		bool output = record == record_of("relays");

		giving_enable(&giving_slot(g, record)->read_enable, !output);
		giving_enable(&giving_slot(g, record)->write_enable, output);
		giving_mark(g, record);
	}
	set_relays(QUIET, world_random(16));
	station_run(station.now + FIELD_S);
	invariants_excuse();
}
