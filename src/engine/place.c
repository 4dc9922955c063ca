/* SPDX-License-Identifier: MIT */
/* What is known of where each device is, and looking for those that are nowhere. */
#include "private.h"

#include "hal/path.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int engine_places_init(struct engine *e)
{
	uint32_t devices = e->table.device_count;

	if (e->group_count == 1)
		return 0;
	e->places = calloc((size_t)(devices + 1) * e->group_count, sizeof(*e->places));
	if (!e->places || due_set_init(&e->routes, devices + 1) ||
	    due_wheel_init(&e->route_wheel, devices + 1, 0))
		return -ENOMEM;
	return 0;
}

void engine_places_free(struct engine *e)
{
	free(e->places);
	due_set_free(&e->routes);
	if (e->route_wheel.wait)
		due_wheel_free(&e->route_wheel);
}

static struct route_place *places_of(struct engine *e, uint32_t device)
{
	return &e->places[(size_t)device * e->group_count];
}

static void know(struct engine *e, uint32_t device, unsigned group, enum route_presence presence)
{
	struct route_place *place = places_of(e, device) + group;

	if (place->presence == presence)
		return;
	*place = (struct route_place){ presence, e->now_ns };
	due_set_add(&e->routes, device);
}

void engine_place(struct engine *e, const struct lane *lane, uint32_t device,
                  enum route_presence presence)
{
	if (e->places && device != TABLE_NO_DEVICE)
		know(e, device, lane->port->group, presence);
}

static bool is_doubted(struct engine *e, uint32_t device, unsigned group)
{
	const struct route_place *place = places_of(e, device) + group;

	return place->presence == ROUTE_FAILING && e->now_ns < place->since_ns + ROUTE_DOUBT_NS;
}

void engine_place_claimed(struct engine *e, const struct lane *lane, uint32_t device)
{
	if (e->places && device != TABLE_NO_DEVICE && !is_doubted(e, device, lane->port->group))
		know(e, device, lane->port->group, ROUTE_PRESENT);
}

void engine_place_found(struct engine *e, const struct lane *lane, uint32_t device)
{
	if (!e->places || device == TABLE_NO_DEVICE || is_doubted(e, device, lane->port->group))
		return;
	for (unsigned g = 0; g < e->group_count; g++)
		if (g != lane->port->group && places_of(e, device)[g].presence == ROUTE_PRESENT)
			know(e, device, g, ROUTE_UNKNOWN);
	know(e, device, lane->port->group, ROUTE_PRESENT);
}

void engine_places_check(struct engine *e)
{
	if (!e->places)
		return;
	for (uint32_t i = 0; i <= e->table.device_count; i++)
		due_set_add(&e->routes, i);
}

static int64_t back_off(const struct device *d)
{
	return d->probe_doublings < 6 ? RETRY_FIRST_NS << d->probe_doublings : RETRY_MAX_NS;
}

/* Returns when it is to be looked for next; INT64_MAX: it need not be, or is just now. */
static int64_t look_for(struct engine *e, uint32_t index, int64_t now_ns)
{
	struct device *d = &e->table.devices[index];
	int group = route_probe(places_of(e, index), e->states, e->group_count, d->group, d->probed);

	if (d->probing)
		return INT64_MAX;
	if (group < 0) {
		d->probe_ns = 0;
		d->probe_doublings = 0;
		return INT64_MAX;
	}
	/* what was never tried is tried at once */
	if (!d->probe_ns)
		d->probe_ns = places_of(e, index)[group].presence == ROUTE_UNKNOWN
		                      ? now_ns
		                      : now_ns + back_off(d);
	if (now_ns < d->probe_ns)
		return d->probe_ns;
	d->probing = true;
	d->probed = (unsigned)group;
	due_set_add(&engine_open_lane(e, (unsigned)group)->probes, index);
	return INT64_MAX;
}

static struct route_choice choose(struct engine *e, uint32_t index, int64_t now_ns)
{
	const struct device *d = &e->table.devices[index];

	if (index == e->table.device_count)
		return route_path(e->states, e->group_count, d->group, now_ns);
	return route_device(places_of(e, index), e->states, e->group_count, d->group, d->moved_ns,
	                    now_ns);
}

static void route(struct engine *e, uint32_t index, int64_t now_ns)
{
	struct device *d = &e->table.devices[index];
	struct route_choice choice = choose(e, index, now_ns);
	int64_t next;

	if (!d->count)
		return;
	if (choice.group != d->group) {
		struct lane *to = engine_open_lane(e, choice.group);

		d->group = choice.group;
		d->moved_ns = now_ns;
		engine_move_device(e, d, to, choice.why, now_ns);
		choice = choose(e, index, now_ns);
	}
	next = choice.again_ns;
	if (index < e->table.device_count) {
		int64_t look = look_for(e, index, now_ns);

		if (look < next)
			next = look;
	}
	if (next == INT64_MAX)
		due_wheel_cancel(&e->route_wheel, index);
	else
		due_wheel_at(&e->route_wheel, index, engine_period_at(e, next));
}

static void ready(void *ctx, uint32_t device)
{
	struct engine *e = ctx;

	due_set_add(&e->routes, device);
}

void engine_places_turn(struct engine *e, int64_t now_ns)
{
	int64_t device;

	if (!e->places)
		return;
	due_wheel_turn(&e->route_wheel, e->period, ready, e);
	while ((device = due_set_next(&e->routes)) >= 0) {
		due_set_take(&e->routes, (uint32_t)device);
		route(e, (uint32_t)device, now_ns);
	}
}

bool engine_probe_next(struct engine *e, struct lane *lane, struct slot *slot, int64_t now_ns)
{
	int64_t device = due_set_next(&lane->probes);
	const struct device *d;
	const char *text;
	struct path path;

	(void)now_ns;
	if (device < 0)
		return false;
	d = &e->table.devices[device];
	text = e->table.signals[e->table.device_rows[d->first]].item->path;
	if (path_split(text, strlen(text), &path))
		return false;
	snprintf(slot->path, sizeof(slot->path), "%.*s",
	         (int)(path.device.text + path.device.len - text), text);
	slot->purpose = FOR_PROBE;
	slot->row = (uint32_t)device;
	slot->req = (struct bus_req){ .op = BUS_PROBE,
		                      .prio = BUS_INPUT,
		                      .fresh = true,
		                      .path = slot->path,
		                      .len = sizeof(slot->data) };
	return true;
}

void engine_probe_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer, int64_t now_ns)
{
	struct device *d = &e->table.devices[slot->row];

	lane->probing = false;
	d->probing = false;
	d->probe_ns = now_ns + back_off(d);
	if (d->probe_doublings < 6)
		d->probe_doublings++;
	if (!answer->err)
		engine_place_claimed(e, lane, slot->row);
	else if (answer->err == -ENODEV)
		engine_place(e, lane, slot->row, ROUTE_ABSENT);
	due_set_add(&e->routes, slot->row);
}
