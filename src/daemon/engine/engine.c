/* SPDX-License-Identifier: MIT */
/* The engine as a whole: it is made and ended here, stepped, and given answers and events. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>

#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/ask.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/intake.h"
#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/device_facts.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/engine.h"
#include "src/daemon/engine/guests.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/lane_answer.h"
#include "src/daemon/engine/lane_state.h"
#include "src/daemon/engine/limits/limits.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/routing.h"
#include "src/daemon/engine/schedule.h"
#include "src/daemon/engine/state.h"

/* All rows begin: what was in force comes back, and the image is filled. */
static void engine_begin(struct engine *e, const struct engine_setup *setup)
{
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		s->read.known_ns = setup->start_ns;
		lane_take_row(&e->lanes[0], engine_row(s));
		engine_read_now(e, s);
		engine_write_check(e, s);
	}
	for (uint32_t i = 0; i < e->alarm_count; i++) {
		alarm_take_item(&e->lanes[0].alarm, &e->alarm_items[i], setup->start_ns);
		alarm_show_dead(e, &e->alarm_items[i]);
	}
	engine_shelves_resume(e);
	engine_resume(e, setup->left);
	for (uint32_t row = 0; row < e->table.count; row++)
		engine_publish(e, &e->table.signals[row]);
	for (unsigned i = 0; i < e->lane_count; i++)
		engine_publish_target(e, &e->lanes[i]);
	engine_publish_devices(e);
	engine_publish_driver(e);
}

static int make_lanes(struct engine *e, const struct engine_setup *setup)
{
	e->lanes = calloc(setup->port_count, sizeof(*e->lanes));
	for (unsigned i = 0; e->lanes && i < setup->port_count; i++) {
		if (lane_init(&e->lanes[i], e, &setup->ports[i], i))
			return -ENOMEM;
		e->lane_count++;
	}
	return e->lanes ? 0 : -ENOMEM;
}

int engine_create(const struct engine_setup *setup, struct engine **engine)
{
	struct engine *e = calloc(1, sizeof(*e));

	assert(setup->port_count > 0);
	if (!e)
		return -ENOMEM;
	e->config = setup->config;
	e->image = setup->image;
	e->force = setup->force;
	e->last = setup->last;
	e->log = setup->log;
	e->guests = setup->guests;
	e->time.start_ns = setup->start_ns;
	e->time.now_ns = setup->start_ns;
	if (signal_table_init(&e->table, e->config) ||
	    due_wheel_init(&e->wheel, engine_device_wait(e, e->table.device_count + 1, WAIT_WATCH),
	                   0) ||
	    engine_facts_init(e) || alarm_items_init(&e->table, &e->alarm_items, &e->alarm_count) ||
	    make_lanes(e, setup) || engine_groups_init(e, setup->ports) ||
	    engine_presences_init(e)) {
		engine_destroy(e);
		return -ENOMEM;
	}
	engine_watch_begin(e);
	engine_begin(e, setup);
	*engine = e;
	return 0;
}

void engine_destroy(struct engine *e)
{
	if (!e)
		return;
	for (unsigned i = 0; i < e->lane_count; i++)
		lane_free(&e->lanes[i]);
	free(e->lanes);
	engine_groups_free(e);
	engine_presences_free(e);
	engine_facts_free(e);
	free(e->alarm_items);
	due_wheel_free(&e->wheel);
	signal_table_free(&e->table);
	free(e);
}

void engine_answer(struct engine *e, unsigned port, const struct bus_answer *answer, int64_t now_ns)
{
	assert(port < e->lane_count);
	engine_begin_call(e, now_ns);
	lane_answer(&e->lanes[port], answer);
	engine_route(e);
}

void engine_event(struct engine *e, unsigned port, const struct bus_event *event, int64_t now_ns)
{
	assert(port < e->lane_count);
	engine_begin_call(e, now_ns);
	lane_event(&e->lanes[port], event);
	engine_route(e);
}

/* Does something of the lane wait for the next period, and for no event? */
static bool waits_for_period(const struct lane *lane)
{
	if (lane->guests.first || (lane->lent.count && lane->lent.unshown))
		return true;
	return lane->state.up && !lane->lent.count &&
	       (lane->inputs.count || lane->outputs.count || lane->restarts.count);
}

static void entry_ready(void *ctx, uint32_t entry)
{
	struct engine *e = ctx;
	uint32_t rows = engine_device_wait(e, 0, WAIT_WATCH),
		 device = (entry - rows) / DEVICE_WAITS;

	if (entry < rows)
		engine_row_due(e, &e->table.signals[entry / ROW_WAITS],
		               (enum row_wait)(entry % ROW_WAITS));
	else if ((entry - rows) % DEVICE_WAITS == WAIT_WATCH)
		engine_watch_due(e, device);
	else
		due_set_add(&e->routes, device);
}

int64_t engine_step(struct engine *e, int64_t now_ns)
{
	int64_t next;
	bool turned, soon;

	engine_begin_call(e, now_ns);
	e->counters.steps++;
	turned = engine_tick(e, entry_ready);
	next = engine_intake_limited(e);
	engine_look_stored(e);
	guests_take(e);
	if (turned) {
		for (unsigned i = 0; i < e->lane_count; i++)
			if (e->lanes[i].lent.count)
				lane_show_reads(&e->lanes[i]);
		engine_look_controllers(e);
		engine_publish_counters(e);
		engine_publish_devices(e);
		engine_publish_driver(e);
	}
	next = earlier_ns(next, engine_route_groups(e));
	soon = !e->controllers_quiet;
	soon |= engine_route(e);
	for (unsigned i = 0; i < e->lane_count; i++) {
		int64_t timeout;

		if (lane_rests(&e->lanes[i]))
			continue;
		timeout = lane_timeouts(&e->lanes[i]);
		/* what it leads to later, and in lanes before this one, is looked at soon */
		soon |= engine_route(e);
		lane_fill(&e->lanes[i]);
		/* what was lent just now included */
		if (e->lanes[i].lent.count)
			timeout = earlier_ns(timeout,
			                     now_ns + e->config->timeout_ns + LANE_GRACE_NS);
		next = earlier_ns(next, earlier_ns(timeout, lane_wake(&e->lanes[i])));
	}
	/* a lane that was filled may have got devices of a later one */
	for (unsigned i = 0; i < e->lane_count; i++)
		soon |= waits_for_period(&e->lanes[i]);
	/* what was done since the last tick is shown at the next */
	soon |= engine_driver_changed(e);
	e->time.next_ns = earlier_ns(next, engine_next_tick(e, soon ? 0 : ENGINE_BEAT_NS));
	return e->time.next_ns;
}

bool engine_published(struct engine *e)
{
	bool published = e->published;

	e->published = false;
	return published;
}
