/* SPDX-License-Identifier: MIT */
/* What is known and counted of each device: taken from answers, carried over, published. */
#include <string.h>

#include "src/daemon/engine/device_facts.h"
#include "src/daemon/engine/retry.h"
#include "src/memory/shm/entries.h"
#include "src/public/ows.h"

_Static_assert((int)BUS_SUPPLY_PARASITE == (int)OWS_POWER_PARASITE &&
                       (int)BUS_SUPPLY_EXTERNAL == (int)OWS_POWER_EXTERNAL,
               "the image has the numbers of the bus");

int engine_facts_init(struct engine *e)
{
	int err = due_set_init(&e->facts, e->table.device_count + 1);

	for (uint32_t i = 0; !err && i < e->table.device_count; i++) {
		e->table.devices[i].facts.lane = UINT32_MAX;
		due_set_add(&e->facts, i);
	}
	return err;
}

void engine_facts_free(struct engine *e)
{
	due_set_free(&e->facts);
}

static struct device_facts *facts_of(struct engine *e, const struct signal *s)
{
	if (!signal_has_device(s))
		return NULL;
	due_set_add(&e->facts, s->device);
	return &e->table.devices[s->device].facts;
}

void engine_facts_answer(struct engine *e, const struct lane *lane, uint32_t row,
                         const struct bus_answer *answer)
{
	struct device_facts *facts = facts_of(e, &e->table.signals[row]);

	if (!facts)
		return;
	facts->answers += failure_of(answer->err) != FAILURE_VOID;
	facts->retries += answer->retries;
	facts->wire_us += answer->wire_us;
	if (facts->lane != lane->index)
		facts->wire = 0;
	facts->lane = lane->index;
	if (answer->wire)
		facts->wire = answer->wire;
	if (answer->identity)
		facts->identity = answer->identity;
	if (answer->supply != BUS_SUPPLY_UNKNOWN)
		facts->supply = answer->supply;
}

void engine_facts_good(struct engine *e, const struct signal *s)
{
	struct device_facts *facts = facts_of(e, s);

	if (facts)
		facts->ok_ns = e->time.now_ns;
}

void engine_facts_failed(struct engine *e, const struct signal *s)
{
	struct device_facts *facts = facts_of(e, s);

	if (facts)
		facts->errors++;
}

/* Both tables have their devices in the order of the ROM ids. */
void engine_facts_adopt(struct engine *e, const struct engine *old, const int *lanes)
{
	uint32_t before = 0;

	for (uint32_t i = 0; i < e->table.rom_count; i++) {
		struct device *d = &e->table.devices[i];
		int order = -1;

		while (before < old->table.rom_count &&
		       (order = memcmp(old->table.devices[before].rom, d->rom, sizeof(d->rom))) < 0)
			before++;
		if (before == old->table.rom_count || order != 0)
			continue;
		d->facts = old->table.devices[before].facts;
		due_set_add(&e->facts, i);
		if (d->facts.lane != UINT32_MAX)
			d->facts.lane = (uint32_t)lanes[d->facts.lane];
	}
}

static void publish(struct engine *e, uint32_t device)
{
	const struct device_facts *facts = &e->table.devices[device].facts;
	struct ows_device_entry entry = {
		.target = facts->lane,
		.answers = facts->answers,
		.errors = facts->errors,
		.retries = facts->retries,
		.wire_us = facts->wire_us,
		.ok_ns = facts->ok_ns,
		.power = facts->supply,
		.wire = facts->wire,
	};
	const char *identity = facts->identity ? facts->identity : "";
	size_t len = strlen(identity);

	memcpy(entry.identity, identity, len < OWS_IDENTITY ? len : OWS_IDENTITY - 1);
	image_device(e->image, device, &entry);
}

/* Those with a ROM id stand first in the table; the image has no others. */
void engine_publish_devices(struct engine *e)
{
	int64_t device;

	while ((device = due_set_next(&e->facts)) >= 0) {
		due_set_take(&e->facts, (uint32_t)device);
		if ((uint32_t)device < e->image->device_count)
			publish(e, (uint32_t)device);
	}
}
