/* SPDX-License-Identifier: MIT */
/* The events that an endurance run draws by its seed, and carries out. */
#include "tests/endurance/happen.h"
#include "tests/endurance/program.h"
#include "tests/endurance/world.h"

static uint64_t faults;
static unsigned variant;

void happen_begin(void)
{
	faults = 0;
	variant = 0;
}

uint64_t happened(void)
{
	return faults;
}

static void reload(unsigned next)
{
	variant = next;
	station_reload(world_configuration(variant));
	accounts_reloaded();
	invariants_excuse();
}

static unsigned any_variant(void)
{
	return world_random(VARIANTS);
}

static void storm(void)
{
	unsigned n = 5 + world_random(25);

	world_note("a storm of reloads");
	while (n--) {
		reload(any_variant());
		station_run(station.now + (1 + world_random(100)) * FIELD_MS);
	}
}

static void come_back(void *ctx)
{
	struct field_device *d = ctx;

	d->away = false;
	for (unsigned i = 0; i < station.part_count; i++)
		if (station.part[i].wire == d->wire)
			station.part[i].ops->plug(&station.part[i], (unsigned)(d - field.device),
			                          true);
}

static void go_away(unsigned device, int64_t ns)
{
	struct field_device *d = &field.device[device];

	if (d->away)
		return;
	world_note(d->name);
	d->away = true;
	for (unsigned i = 0; i < station.part_count; i++)
		if (station.part[i].wire == d->wire)
			station.part[i].ops->plug(&station.part[i], device, false);
	world_after(ns, come_back, d);
}

static void each_part(void (*act)(struct part *part))
{
	for (unsigned i = 0; i < station.part_count; i++)
		act(&station.part[i]);
}

static void tell_pins(struct part *part)
{
	part->ops->pins(part);
}

void happen_pin(void)
{
	field_set_pins(field_pins() ^ 1u << world_random(4), station.now);
	each_part(tell_pins);
}

void happen_over(void)
{
	if (variant)
		reload(0);
}

static void gap(void)
{
	int64_t ns = (1 + world_random(3600)) * FIELD_S;

	world_note("suspend");
	station_gap(ns);
	invariants_excuse();
}

void happen(void)
{
	int64_t ns = (1 + world_random(ALONE / FIELD_S)) * FIELD_S;
	struct part *part = &station.part[world_random(station.part_count)];
	unsigned device = world_random(field.devices), what = world_random(100);

	faults++;
	if (what < 45) {
		world_note(part->ops->fault(part, ns));
	} else if (what < 55) {
		go_away(device, ns);
	} else if (what < 60) {
		world_note("a restart");
		if (!field.device[device].away && field.device[device].wire == part->wire)
			part->ops->restart(part, device);
	} else if (what < 70) {
		happen_pin();
	} else if (what < 80) {
		program_sets(world_random(16));
	} else if (what < 84) {
		program_dies();
	} else if (what < 89) {
		program_scribbles();
	} else if (what < 96) {
		world_note("a reload");
		reload(any_variant());
	} else if (what < 98) {
		storm();
	} else {
		gap();
	}
}
