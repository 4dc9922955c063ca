/* SPDX-License-Identifier: MIT */
/* What is known of where each device is, and the looks for devices that are nowhere. */
#include <errno.h>
#include <stdlib.h>

#include "hal/base/time.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/route.h"

/* Between two looks for devices that are not there: the signals that are come first. */
#define PROBE_APART_NS (200 * NS_PER_MS)

int engine_presences_init(struct engine *e)
{
	uint32_t devices = e->table.device_count;

	if (e->group_count == 1)
		return 0;
	e->known = calloc((size_t)(devices + 1) * e->group_count, sizeof(*e->known));
	return e->known ? due_set_init(&e->routes, devices + 1) : -ENOMEM;
}

void engine_presences_free(struct engine *e)
{
	free(e->known);
	due_set_free(&e->routes);
}

static void know_presence(struct engine *e, uint32_t device, unsigned group,
                          enum route_presence presence)
{
	struct known_presence *known = engine_presences(e, device) + group;

	if (presence == ROUTE_PRESENT)
		e->table.devices[device].found = true;
	if (known->presence == presence)
		return;
	*known = (struct known_presence){presence, e->time.now_ns};
	due_set_add(&e->routes, device);
}

void engine_presence(struct engine *e, const struct lane *lane, uint32_t device,
                     enum route_presence presence)
{
	if (e->known && device != TABLE_NO_DEVICE)
		know_presence(e, device, lane->port->group, presence);
}

static bool is_doubted(struct engine *e, uint32_t device, unsigned group)
{
	const struct known_presence *known = engine_presences(e, device) + group;

	return known->presence == ROUTE_FAILING &&
	       e->time.now_ns < known->since_ns + ROUTE_DOUBT_NS;
}

/* A claim is no evidence: it does not bring a device back that was seen to fail just now. */
void engine_presence_claimed(struct engine *e, const struct lane *lane, uint32_t device)
{
	if (e->known && device != TABLE_NO_DEVICE && !is_doubted(e, device, lane->port->group))
		know_presence(e, device, lane->port->group, ROUTE_PRESENT);
}

/* One wire has a device: what another group was known to have of it may be old. */
void engine_presence_found(struct engine *e, const struct lane *lane, uint32_t device)
{
	if (!e->known || device == TABLE_NO_DEVICE || is_doubted(e, device, lane->port->group))
		return;
	for (unsigned g = 0; g < e->group_count; g++)
		if (g != lane->port->group &&
		    engine_presences(e, device)[g].presence == ROUTE_PRESENT)
			know_presence(e, device, g, ROUTE_UNKNOWN);
	know_presence(e, device, lane->port->group, ROUTE_PRESENT);
}

void engine_presences_check(struct engine *e)
{
	if (!e->known)
		return;
	for (uint32_t i = 0; i <= e->table.device_count; i++)
		due_set_add(&e->routes, i);
}

bool engine_probe_ask(struct lane *lane, struct slot *slot)
{
	int64_t now_ns = lane->engine->time.now_ns, device = due_set_next(&lane->probes);

	if (device < 0 || lane->probing || now_ns < lane->probe_ns ||
	    !slot_look_for(lane, slot, FOR_PROBE, (uint32_t)device) || !slot_lend(lane, slot))
		return false;
	due_set_take(&lane->probes, slot->row);
	lane->probing = true;
	lane->probe_ns = now_ns + PROBE_APART_NS;
	lane->counters.probes++;
	return true;
}

void engine_probe_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer)
{
	struct device *d = &e->table.devices[slot->row];
	int64_t wait_ns;

	lane->probing = false;
	d->probing = false;
	retry_fail(&d->probe, 0, &wait_ns);
	d->probe_ns = e->time.now_ns + wait_ns;
	if (!answer->err)
		engine_presence_claimed(e, lane, slot->row);
	else if (answer->err == -ENODEV)
		engine_presence(e, lane, slot->row, ROUTE_ABSENT);
	due_set_add(&e->routes, slot->row);
}

void engine_probes_forget(struct lane *lane)
{
	int64_t device;

	while ((device = due_set_next(&lane->probes)) >= 0) {
		due_set_take(&lane->probes, (uint32_t)device);
		lane->engine->table.devices[device].probing = false;
	}
}
