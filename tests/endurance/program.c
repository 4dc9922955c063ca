/* SPDX-License-Identifier: MIT */
/* The control program of an endurance run. */
#include <string.h>

#include "tests/endurance/program.h"
#include "tests/endurance/world.h"

#define BEAT_MS 3000
#define CLIENT 3

static bool beats;
static uint32_t beat, stamp = 1001;

static struct ows_command_slot *slot_of(uint32_t record)
{
	const struct commands *c = &station.now_serving->commands;

	return (struct ows_command_slot *)(void *)(c->base + c->slot_off) + record;
}

static void mark_dirty(uint32_t record)
{
	const struct commands *c = &station.now_serving->commands;
	uint32_t *dirty = (uint32_t *)(void *)(c->base + c->dirty_off);

	dirty[record / 32] |= 1u << record % 32;
	station_ring();
}

static struct ows_client *client(void)
{
	const struct commands *c = &station.now_serving->commands;

	return (struct ows_client *)(void *)(c->base + c->client_off) + CLIENT;
}

static void set_relays(unsigned value, bool beating)
{
	uint32_t record = record_of("relays");
	struct ows_command_slot *slot = slot_of(record);

	slot->value = value;
	slot->client = beating ? CLIENT + 1 : 0;
	slot->stamp = stamp += 2; /* odd: none that was scribbled */
	mark_dirty(record);
	commanded = (int)value;
}

void program_begin(void)
{
	beats = false;
}

bool program_beats(void)
{
	return beats;
}

void program_runs(void)
{
	if (!beats)
		return;
	*client() = (struct ows_client){.pid = 42, .beat = ++beat, .period_ms = 1000 * BEAT_MS};
}

void program_sets(unsigned value)
{
	set_relays(value, false);
}

void program_dies(void)
{
	world_note("the program dies");
	set_relays(1 + world_random(15), true);
	beats = true;
	program_runs();
	station_run(station.now + (int64_t)world_random(20) * FIELD_S);
	beats = false;
	*client() = (struct ows_client){.pid = 42, .beat = beat, .period_ms = BEAT_MS};
	station_run(station.now + FIELD_S);
	commanded = 0; /* SafeValue */
}

void program_scribbles(void)
{
	const struct commands *c = &station.now_serving->commands;
	uint32_t n = station.now_serving->config->item_count, header = 256 / 4;

	world_note("scribbles");
	for (unsigned i = 0; i < 20; i++) {
		uint32_t record = 1 + world_random(n), word = world_random(8);
		uint32_t *slot = (uint32_t *)(void *)slot_of(record);

		/* a table believes what it is told, also of a temperature */
		if (world->moody && record != record_of("relays") && word == 5)
			continue;
		slot[word] = world_random(2) ? world_random(4) : world_random(1 << 24) << 8;
		mark_dirty(record);
	}
	for (unsigned i = 0; i < 4; i++)
		((uint32_t *)(void *)c->base)[world_random(header)] = world_random(1 << 24);
	((uint32_t *)(void *)(c->base + c->client_off))[world_random(OWS_CLIENTS * 8)] =
		world_random(1 << 24);
	((uint32_t *)(void *)(c->base + c->dirty_off))[0] = world_random(1 << 24);
	station_ring();
	station_run(station.now + (1 + world_random(30)) * FIELD_S);
	/* and sets it right */
	memset(c->base + c->client_off, 0, OWS_CLIENTS * sizeof(struct ows_client));
	for (uint32_t record = 1; record <= n; record++) {
		struct ows_command_slot *slot = slot_of(record);
		bool output = record == record_of("relays");

		slot->read_enable = output ? 1 : 2;
		slot->write_enable = output ? 2 : 1;
		mark_dirty(record);
	}
	set_relays(world_random(16), false);
	station_run(station.now + FIELD_S);
	invariants_excuse();
}
