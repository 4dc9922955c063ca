/* SPDX-License-Identifier: MIT */
/* The engine as a whole: it is made and ended here, stepped, and given answers and events. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>

#include "hal/bus/time.h"
#include "src/engine/alarm_item.h"
#include "src/engine/ask.h"
#include "src/engine/clients.h"
#include "src/engine/counters.h"
#include "src/engine/due.h"
#include "src/engine/engine.h"
#include "src/engine/group.h"
#include "src/engine/guests.h"
#include "src/engine/intake.h"
#include "src/engine/lane.h"
#include "src/engine/lane_answer.h"
#include "src/engine/lane_event.h"
#include "src/engine/place.h"
#include "src/engine/publish.h"
#include "src/engine/routing.h"
#include "src/engine/schedule.h"
#include "src/engine/state.h"
#include "src/text/log.h"

int engine_create(const struct engine_setup *setup, struct engine **engine)
{
	struct engine *e = calloc(1, sizeof(*e));
	int err;

	assert(setup->port_count > 0);
	if (!e)
		return -ENOMEM;
	e->config = setup->config;
	e->image = setup->image;
	e->commands = setup->commands;
	e->log = setup->log;
	e->guests = setup->guests;
	e->time.start_ns = setup->start_ns;
	e->time.now_ns = setup->start_ns;
	e->looks_ns = INT64_MIN / 2; /* all are left */
	err = signal_table_init(&e->table, e->config);
	if (!err)
		err = due_wheel_init(&e->wheel, e->table.count * 2, 0);
	if (!err)
		err = due_wheel_init(&e->limit_wheel, e->table.count, 0);
	if (!err) {
		e->lanes = calloc(setup->port_count, sizeof(*e->lanes));
		err = e->lanes ? 0 : -ENOMEM;
	}
	if (!err)
		err = structure_init(&e->structure, &e->table);
	if (!err)
		err = alarm_items_init(&e->table, &e->alarm_items, &e->alarm_count);
	for (unsigned i = 0; !err && i < setup->port_count; i++) {
		err = lane_init(&e->lanes[i], e, &setup->ports[i], i);
		if (!err)
			e->lane_count++;
	}
	if (!err)
		err = engine_groups_init(e, setup->ports);
	if (!err)
		err = engine_places_init(e);
	if (err) {
		engine_destroy(e);
		return err;
	}
	for (uint32_t row = 0; row < e->table.count; row++) {
		e->table.signals[row].read.known_ns = setup->start_ns;
		lane_take_row(&e->lanes[0], row);
	}
	for (uint32_t i = 0; i < e->alarm_count; i++)
		alarm_take_item(&e->lanes[0].alarm, &e->alarm_items[i], setup->start_ns);
	for (uint32_t row = 0; row < e->table.count; row++) {
		engine_read_now(e, &e->table.signals[row]);
		engine_write_check(e, &e->table.signals[row]);
	}
	engine_resume(e, setup->start_ns);
	for (uint32_t row = 0; row < e->table.count; row++)
		engine_publish(e, &e->table.signals[row]);
	for (unsigned i = 0; i < e->lane_count; i++)
		engine_publish_target(e, &e->lanes[i]);
	engine_publish_driver(e, setup->start_ns);
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
	engine_places_free(e);
	structure_free(&e->structure);
	free(e->alarm_items);
	if (e->wheel.wait)
		due_wheel_free(&e->wheel);
	if (e->limit_wheel.wait)
		due_wheel_free(&e->limit_wheel);
	signal_table_free(&e->table);
	free(e);
}

/* So late nobody ran: the machine was suspended, or owsd stopped. */
#define GAP_NS (2 * NS_PER_S)

static void begin_call(struct engine *e, int64_t now_ns)
{
	if (e->time.next_ns && now_ns - e->time.next_ns > GAP_NS)
		e->time.gap_ns = now_ns;
	e->time.now_ns = now_ns;
}

void engine_answer(struct engine *e, unsigned port, const struct bus_answer *answer, int64_t now_ns)
{
	assert(port < e->lane_count);
	begin_call(e, now_ns);
	lane_answer(&e->lanes[port], answer, now_ns);
	engine_route(e, now_ns);
}

void engine_event(struct engine *e, unsigned port, const struct bus_event *event, int64_t now_ns)
{
	assert(port < e->lane_count);
	begin_call(e, now_ns);
	lane_event(&e->lanes[port], event, now_ns);
	engine_route(e, now_ns);
}

int64_t engine_step(struct engine *e, int64_t now_ns)
{
	uint64_t before = e->time.period;
	int64_t next, groups, deferred;

	begin_call(e, now_ns);
	e->counters.steps++;
	engine_turn(e, now_ns);
	deferred = engine_intake_limited(e, now_ns);
	guests_take(e, now_ns);
	if (e->time.period != before) {
		for (unsigned i = 0; i < e->lane_count; i++)
			if (e->lanes[i].lent.count)
				lane_show_reads(&e->lanes[i]);
		engine_clients(e, now_ns);
		engine_publish_counters(e);
		engine_publish_driver(e, now_ns);
	}
	next = e->time.start_ns +
	       (int64_t)(e->time.period - e->time.first + 1) * e->config->period_ns;
	if (deferred < next)
		next = deferred;
	groups = engine_route_groups(e, now_ns);
	if (groups < next)
		next = groups;
	for (unsigned i = 0; i < e->lane_count; i++) {
		int64_t timeout = lane_timeouts(&e->lanes[i], now_ns);
		int64_t alarm;

		engine_route(e, now_ns);
		lane_fill(&e->lanes[i], now_ns);
		/* what was lent just now included */
		if (e->lanes[i].lent.count &&
		    now_ns + e->config->timeout_ns + LANE_GRACE_NS < timeout)
			timeout = now_ns + e->config->timeout_ns + LANE_GRACE_NS;
		if (timeout < next)
			next = timeout;
		alarm = lane_wake(&e->lanes[i]);
		if (alarm < next)
			next = alarm;
	}
	e->time.next_ns = next;
	return next;
}

bool engine_published(struct engine *e)
{
	bool published = e->published;

	e->published = false;
	return published;
}

void engine_take_commands(struct engine *e, struct commands *commands, int64_t now_ns)
{
	int (*put)(struct commands *, uint32_t, int64_t, const char *, uint32_t);

	engine_intake(e, now_ns);
	e->commands = commands;
	e->counters.lost_commands++;
	for (unsigned i = 0; i < OWS_CLIENTS; i++)
		e->clients[i] = (struct client){0};
	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		s->seen.one_shots = 0;
		s->seen.dgn_resets = 0;
		s->seen.acknowledged = 0;
		s->seen.client = 0;
		if (s->seen.awaited)
			engine_give_up(e, s);
		/* what was commanded stands */
		if (!s->seen.stamp)
			continue;
		put = s->command.safe ? commands_put_safe : commands_put;
		put(commands, s->record, s->command.value,
		    signal_is_string(s) ? s->command_text : NULL, s->command.len);
		commands_stamp(commands, s->record, s->seen.stamp);
	}
	e->driver.resets = 0;
	e->busy_count = 0;
	log_warning(e->log, "a program removed the command segment: owsd made it again");
}
