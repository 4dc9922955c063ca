/* SPDX-License-Identifier: MIT */
/* A reload: the new engine takes over what stays from the engine that has run until now. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "src/engine/adopt.h"
#include "src/engine/alarm_item.h"
#include "src/engine/counters.h"
#include "src/engine/disown.h"
#include "src/engine/doubt.h"
#include "src/engine/due.h"
#include "src/engine/guests.h"
#include "src/engine/intake.h"
#include "src/engine/lane.h"
#include "src/engine/place.h"
#include "src/engine/publish.h"
#include "src/engine/schedule.h"
#include "src/engine/state.h"

static uint64_t wait_of(const struct due_wheel *wheel, uint32_t entry)
{
	return wheel->wait[entry].waits ? wheel->wait[entry].period : 0;
}

/* The count of periods goes on though a period may last otherwise than before. */
static void take_time(struct engine *e, const struct engine *old, int64_t now_ns)
{
	e->period = old->period;
	e->now_ns = now_ns;
	e->next_ns = old->next_ns;
	e->gap_ns = old->gap_ns;
	e->start_ns = old->start_ns;
	e->first = old->first;
	if (e->config->period_ns != old->config->period_ns) {
		e->start_ns = now_ns;
		e->first = old->period;
	}
	for (uint32_t row = 0; row < e->table.count; row++)
		due_wheel_cancel(&e->limit_wheel, row);
	e->wheel.period = e->limit_wheel.period = e->route_wheel.period = e->period;
}

static void take_counts(struct engine *e, const struct engine *old)
{
	e->transactions = old->transactions;
	e->reconnects = old->reconnects;
	e->counters = old->counters;
	e->counters.reloads++;
	memcpy(e->clients, old->clients, sizeof(e->clients));
	e->driver_resets = old->driver_resets;
	e->refused = old->refused;
}

/* --- Targets --------------------------------------------------------------------------------- */

static void take_machine(struct alarm_machine *m, const struct alarm_machine *before)
{
	m->cycle = before->cycle;
	m->polls = before->polls;
	m->told = before->told;
	m->list_ns = before->list_ns;
	m->wait_ns = before->wait_ns;
	m->strangers = before->strangers;
	memcpy(m->stranger, before->stranger, sizeof(m->stranger));
}

static void take_group(struct engine *e, unsigned group, struct engine *old, unsigned before,
                       const uint32_t *successors)
{
	struct group *g = &e->groups[group], *was = &old->groups[before];

	assert(g->bar.count == was->bar.count);
	g->bar = was->bar;
	g->quiet = was->quiet;
	g->rounds = was->rounds;
	e->states[group] = old->states[before];
	for (unsigned w = 0; w < g->bar.count; w++) {
		struct lane *from = &old->lanes[was->first + w];

		g->ways[w] = was->ways[w];
		lane_adopt(&e->lanes[g->first + w], from, successors);
		guests_adopt(&e->lanes[g->first + w], from);
		take_machine(&e->lanes[g->first + w].alarm, &from->alarm);
	}
}

static int new_lane(const struct engine *e, const struct adoption *plan, unsigned before)
{
	for (unsigned i = 0; i < e->lane_count; i++)
		if (plan->ports[i] == (int)before)
			return (int)i;
	return -1;
}

/* --- Devices --------------------------------------------------------------------------------- */

static void serve_device(struct engine *e, uint32_t index, struct lane *lane)
{
	const struct device *d = &e->table.devices[index];

	for (uint32_t k = 0; k < d->count; k++) {
		uint32_t row = e->table.device_rows[d->first + k];

		lane_drop_row(engine_lane(e, &e->table.signals[row]), row);
		lane_take_row(lane, row);
	}
}

static void take_places(struct engine *e, uint32_t index, const struct engine *old, uint32_t before,
                        const struct adoption *plan)
{
	struct route_place *to = &e->places[(size_t)index * e->group_count];

	for (unsigned g = 0; g < e->group_count && old->places; g++) {
		int port = plan->ports[e->groups[g].first];

		if (port >= 0)
			to[g] = old->places[(size_t)before * old->group_count +
			                    old->lanes[port].port->group];
	}
}

static void take_device(struct engine *e, uint32_t index, const struct engine *old,
                        const struct adoption *plan)
{
	struct device *d = &e->table.devices[index];
	const struct device *was;
	uint32_t before = ADOPT_NEW;
	int lane;

	for (uint32_t k = 0; k < d->count && before == ADOPT_NEW; k++)
		before = plan->rows[e->table.device_rows[d->first + k]];
	if (before == ADOPT_NEW)
		return;
	before = old->table.signals[before].device == TABLE_NO_DEVICE
	                 ? old->table.device_count
	                 : old->table.signals[before].device;
	was = &old->table.devices[before];
	d->absent = was->absent;
	d->moved_ns = was->moved_ns;
	if (e->places)
		take_places(e, index, old, before, plan);
	lane = new_lane(e, plan, old->groups[was->group].first);
	if (lane >= 0)
		d->group = e->lanes[lane].port->group;
}

static void take_devices(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	for (uint32_t i = 0; i <= e->table.device_count; i++) {
		struct device *d = &e->table.devices[i];

		if (!d->count)
			continue;
		take_device(e, i, old, plan);
		serve_device(e, i, engine_open_lane(e, d->group));
	}
	engine_places_check(e);
}

/* --- Signals --------------------------------------------------------------------------------- */

static uint32_t flag_of(const struct signal *s, const struct signal *was, uint32_t flag,
                        bool configured, bool before)
{
	/* what the file says counts where it was changed, else what a program has set */
	return configured == before ? was->attrs.flags & flag : s->attrs.flags & flag;
}

static void take_text(char *to, const char *from)
{
	if (to)
		memcpy(to, from, TABLE_TEXT_CAP);
}

static void take_command(struct signal *s, const struct signal *was)
{
	s->commanded = was->commanded;
	s->confirmed = was->confirmed;
	s->agrees = was->agrees;
	s->one_shot = was->one_shot;
	s->forced = was->forced;
	s->safe = was->safe;
	s->write_err = was->write_err;
	s->command = was->command;
	s->written = was->written;
	s->command_stamp = was->command_stamp;
	s->command_len = was->command_len;
	s->written_len = was->written_len;
	s->write_retry = was->write_retry;
	take_text(s->command_text, was->command_text);
	take_text(s->written_text, was->written_text);
}

static void take_signal(struct signal *s, const struct signal *was)
{
	const struct config_item *item = s->item, *before = was->item;
	uint32_t flags = was->attrs.flags &
	                 ~(uint32_t)(OWS_ATTR_READ_ENABLE | OWS_ATTR_LIMITS |
	                             OWS_ATTR_WRITE_ENABLE | OWS_ATTR_IN_WORK |
	                             OWS_ATTR_ALARM_POLLED | OWS_ATTR_ALARM_UNARMED |
	                             OWS_ATTR_ALARM_POR);

	flags |= flag_of(s, was, OWS_ATTR_READ_ENABLE, item->readable, before->readable);
	if (config_item_takes_sets(item))
		flags |= flag_of(s, was, OWS_ATTR_WRITE_ENABLE, item->writable, before->writable);
	flags |= s->attrs.flags & OWS_ATTR_LIMITS;
	s->sample = was->sample;
	s->attrs = was->attrs;
	s->attrs.flags = flags;
	s->known_ns = was->known_ns;
	s->updated_ns = was->updated_ns;
	s->read_retry = was->read_retry;
	s->guard = was->guard;
	s->stamp = was->stamp;
	s->one_shots = was->one_shots;
	s->dgn_resets = was->dgn_resets;
	s->acknowledged = was->acknowledged;
	s->client = was->client;
	s->awaited = was->awaited;
	s->held = was->held;
	s->held_quality = was->held_quality;
	s->held_err = was->held_err;
	if (signal_reads(was) && !signal_reads(s) && !before->output) {
		s->sample.quality = OWS_Q_DISABLED;
		s->held = false;
	}
	take_text(s->text, was->text);
	if (item->output == before->output || was->command_stamp)
		take_command(s, was);
	if (item->limits.any && before->limits.any) {
		s->limit = was->limit;
		s->limit_log = was->limit_log;
		s->limit_said = was->limit_said;
		memcpy(s->limit_value, was->limit_value, sizeof(s->limit_value));
		s->limit_count = was->limit_count;
		s->limit_values = was->limit_values;
	} else if (!item->limits.any) {
		s->attrs.limit_state = 0;
		s->attrs.limit_condition = 0;
	}
}

/* A value that another target gave is the last usable one at best. */
static void take_source(struct engine *e, struct signal *s, const struct adoption *plan)
{
	int lane = s->sample.target == 255 ? -1 : new_lane(e, plan, s->sample.target);

	if (s->sample.target == 255)
		return;
	s->sample.target = (uint8_t)s->lane;
	if (lane == (int)s->lane)
		return;
	s->confirmed = false;
	s->held = false;
	if (s->sample.quality & 0xc0) {
		s->sample.quality = OWS_Q_LAST_USABLE;
		s->sample.err = 0;
	}
}

static void take_turn(struct engine *e, struct signal *s, const struct engine *old, uint32_t before)
{
	uint32_t row = engine_row(s);
	uint64_t read = wait_of(&old->wheel, before * 2),
		 write = wait_of(&old->wheel, before * 2 + 1);

	engine_read_never(e, s);
	if (read && s->item->per_factor == old->table.signals[before].item->per_factor)
		engine_read_at(e, s, read);
	else
		engine_read_now(e, s);
	due_set_remove(&engine_lane(e, s)->outputs, row);
	if (write && s->write_retry.failures)
		engine_write_at(e, s, write);
	else
		engine_write_check(e, s);
}

static void take_signals(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];
		struct lane *lane = engine_lane(e, s);

		if (plan->rows[row] == ADOPT_NEW) {
			s->known_ns = e->now_ns;
			s->attrs.per_base = (uint32_t)e->period;
			engine_read_now(e, s);
			engine_write_check(e, s);
			continue;
		}
		lane->writers -= signal_writes(s);
		take_signal(s, &old->table.signals[plan->rows[row]]);
		lane->writers += signal_writes(s);
		take_source(e, s, plan);
		take_turn(e, s, old, plan->rows[row]);
	}
}

/* --- Alarms ---------------------------------------------------------------------------------- */

static bool same_text(const char *a, const char *b)
{
	return a && b ? strcmp(a, b) == 0 : a == b;
}

static int compare_rows(const void *row, const void *item)
{
	uint32_t a = *(const uint32_t *)row, b = ((const struct alarm_item *)item)->row;

	return (a > b) - (a < b);
}

static void take_alarm(struct engine *e, struct alarm_item *item, const struct engine *old,
                       const struct adoption *plan)
{
	struct signal *s = &e->table.signals[item->row];
	struct lane *lane = engine_lane(e, s);
	uint32_t before = plan->rows[item->row];
	const struct alarm_item *was = NULL;

	alarm_take_item(&lane->alarm, item, e->now_ns);
	if (lane->alarm.polls)
		s->attrs.flags |= OWS_ATTR_ALARM_POLLED;
	if (before != ADOPT_NEW && old->alarm_count)
		was = bsearch(&before, old->alarm_items, old->alarm_count, sizeof(*was),
		              compare_rows);
	if (!was)
		return;
	item->stands = was->stands;
	item->entered = was->entered;
	item->journal = was->journal;
	item->wants_after = was->wants_after;
	memcpy(item->latch_text, was->latch_text, sizeof(item->latch_text));
	if (same_text(s->item->por_alarm, old->table.signals[before].item->por_alarm)) {
		item->restarted = item->asks_por = was->restarted;
		item->differs = was->differs;
	}
	if (!same_text(s->item->set_alarm, old->table.signals[before].item->set_alarm))
		return;
	item->to_arm = was->to_arm;
	item->arm_retry = was->arm_retry;
	item->arm_ns = was->arm_ns;
	s->attrs.flags |= old->table.signals[before].attrs.flags &
	                  (OWS_ATTR_ALARM_UNARMED | OWS_ATTR_ALARM_POR);
	s->alarm_err = old->table.signals[before].alarm_err;
}

static void take_alarms(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	for (unsigned i = 0; i < e->lane_count; i++)
		for (uint32_t k = 0; k < e->alarm_count; k++)
			alarm_drop_item(&e->lanes[i].alarm, &e->alarm_items[k]);
	for (uint32_t k = 0; k < e->alarm_count; k++)
		take_alarm(e, &e->alarm_items[k], old, plan);
	image_carry_alarms(e->image, old->image, plan->successors);
}

/* --------------------------------------------------------------------------------------------- */

void engine_adopt(struct engine *e, struct engine *old, const struct adoption *plan, int64_t now_ns)
{
	/* from here on a program's set fails there, so nothing is lost between the two */
	commands_state(old->commands, OWS_STATE_RETIRED);
	engine_intake(old, now_ns);
	commands_carry_rows(e->commands, old->commands, plan->rows);
	for (unsigned i = 0; i < old->lane_count; i++) {
		lane_keep_reads(&old->lanes[i]);
		lane_disown(&old->lanes[i], true);
	}
	take_time(e, old, now_ns);
	take_counts(e, old);
	for (unsigned g = 0; g < e->group_count; g++) {
		int port = plan->ports[e->groups[g].first];

		if (port >= 0)
			take_group(e, g, old, old->lanes[port].port->group, plan->successors);
	}
	for (unsigned i = 0; i < old->lane_count; i++)
		if (new_lane(e, plan, i) < 0)
			guests_refuse(&old->lanes[i]);
	take_devices(e, old, plan);
	take_signals(e, old, plan);
	take_alarms(e, old, plan);
	for (unsigned i = 0; i < e->lane_count; i++)
		lane_resume_reads(&e->lanes[i]);
	engine_doubts(e);
	for (uint32_t row = 0; row < e->table.count; row++)
		engine_publish(e, &e->table.signals[row]);
	for (unsigned i = 0; i < e->lane_count; i++)
		engine_publish_target(e, &e->lanes[i]);
	engine_publish_counters(e);
	engine_publish_driver(e, now_ns);
}

void engine_abandon(struct engine *old)
{
	for (unsigned i = 0; i < old->lane_count; i++)
		guests_release(&old->lanes[i]);
}
