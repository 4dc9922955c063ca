/* SPDX-License-Identifier: MIT */
/* A reload: the new engine takes over what stays from the engine that has run until now. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/config.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/origin.h"
#include "src/daemon/engine/command/read_back.h"
#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/device_facts.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/guests.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/limits/limits.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/reload/adopt.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/move.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/daemon/engine/state.h"
#include "src/ground/signal/unarmed.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/shelves.h"

/* What a program has set stays, unless the file says something else than before. */
static uint32_t flag_of(const struct signal *s, const struct signal *was, uint32_t flag,
                        bool configured, bool before)
{
	return configured == before ? was->attrs.flags & flag : s->attrs.flags & flag;
}

static uint32_t flags_of(const struct signal *s, const struct signal *was)
{
	const uint32_t anew = OWS_ATTR_READ_ENABLE | OWS_ATTR_WRITE_ENABLE | OWS_ATTR_LIMITS |
	                      OWS_ATTR_IN_WORK | OWS_ATTR_ALARM_POLLED | OWS_ATTR_ALARM_UNARMED |
	                      OWS_ATTR_ALARM_WHY;
	const struct config_item *item = s->item, *before = was->item;
	uint32_t flags = was->attrs.flags & ~anew & ~(item->alarm ? 0u : OWS_ATTR_ALARM_STANDS);

	flags |= flag_of(s, was, OWS_ATTR_READ_ENABLE, item->readable, before->readable);
	if (config_item_takes_sets(item))
		flags |= flag_of(s, was, OWS_ATTR_WRITE_ENABLE, item->writable, before->writable);
	return flags | (s->attrs.flags & OWS_ATTR_LIMITS);
}

static void adopt_text(char *to, const char *from)
{
	if (to)
		memcpy(to, from, TABLE_TEXT_CAP);
}

bool signal_adopt(struct signal *s, const struct signal *was)
{
	const struct config_item *item = s->item, *before = was->item;
	uint32_t flags = flags_of(s, was);
	bool commanded = was->command.reason != OWS_REASON_NONE &&
	                 was->command.reason != OWS_REASON_INIT;
	bool goes_on = item->output == before->output || commanded;

	s->sample = was->sample;
	s->attrs = was->attrs;
	s->attrs.flags = flags;
	s->read = was->read;
	s->journal = was->journal;
	adopt_text(s->text, was->text);
	if (!signal_reads(s) && !before->output && (signal_reads(was) || signal_lapses(was))) {
		s->sample.quality = OWS_Q_DISABLED;
		s->read.held = false;
	}
	if (goes_on) {
		s->command = was->command;
		adopt_text(s->command_text, was->command_text);
		adopt_text(s->written_text, was->written_text);
	}
	if (s->command.differs && before->read_back_ns && !item->read_back_ns) {
		s->command.differs = s->command.doubted = false;
		s->sample.quality = OWS_Q_LAST_USABLE;
	}
	s->restore = was->restore;
	s->scaling = was->scaling;
	if (item->type != OWS_STRING)
		signal_rescale(s, was);
	if (item->limits.any && before->limits.any) {
		s->limit = was->limit;
	} else if (!item->limits.any) {
		s->attrs.limit_state = 0;
		s->attrs.limit_condition = 0;
		s->attrs.shelved = 0;
	}
	return goes_on;
}

static uint64_t wait_of(const struct engine *e, const struct signal *s, enum row_wait wait)
{
	const struct due_wait *w = &e->wheel.wait[engine_row_wait(s, wait)];

	return w->waits ? w->period : 0;
}

/* The count of periods goes on, though a period may be longer or shorter than before. */
static void take_time(struct engine *e, const struct engine *old, int64_t now_ns)
{
	e->time = old->time;
	e->time.now_ns = now_ns;
	if (e->config->period_ns != old->config->period_ns) {
		e->time.start_ns = now_ns;
		e->time.first = old->time.period;
	}
	/* the wheel stands at 0 still: all that waits is ready at the next period */
}

static void take_counts(struct engine *e, const struct engine *old)
{
	e->driver = old->driver;
	e->counters = old->counters;
	e->counters.reloads++;
	e->refused = old->refused;
	e->shelvings = old->shelvings;
}

/* --- Targets --------------------------------------------------------------------------------- */

static void take_group(struct engine *e, unsigned group, struct engine *old, unsigned before,
                       const uint32_t *successors)
{
	struct group *g = &e->groups[group], *was = &old->groups[before];

	assert(g->state.bar.count == was->state.bar.count);
	g->state = was->state;
	e->states[group] = old->states[before];
	for (unsigned w = 0; w < g->state.bar.count; w++) {
		struct lane *from = &old->lanes[was->first + w];

		g->ways[w] = was->ways[w];
		lane_adopt(&e->lanes[g->first + w], from, successors);
		guests_adopt(&e->lanes[g->first + w], from);
		e->lanes[g->first + w].alarm.list = from->alarm.list;
	}
}

/* --- Devices --------------------------------------------------------------------------------- */

static void serve_device(struct engine *e, uint32_t index, struct lane *lane)
{
	const struct device *d = &e->table.devices[index];

	for (uint32_t k = 0; k < d->count; k++) {
		lane_drop_row(engine_lane(e, d->signals[k]), engine_row(d->signals[k]));
		lane_take_row(lane, engine_row(d->signals[k]));
	}
}

/* Groups that stay keep what they know of the device; the others have not been asked. */
static void adopt_presences(struct engine *e, uint32_t index, const struct engine *old,
                            uint32_t before, const struct adoption *plan)
{
	struct known_presence *to = &e->known[(size_t)index * e->group_count];

	for (unsigned g = 0; g < e->group_count && old->known; g++) {
		int port = plan->ports[e->groups[g].first];

		if (port >= 0)
			to[g] = old->known[(size_t)before * old->group_count +
			                   old->lanes[port].port->group];
	}
}

/* A device of the new table was there before if any of its signals was. */
static void take_device(struct engine *e, uint32_t index, const struct engine *old,
                        const struct adoption *plan)
{
	struct device *d = &e->table.devices[index];
	const struct device *was;
	uint32_t before = ADOPT_NEW;
	int lane;

	for (uint32_t k = 0; k < d->count && before == ADOPT_NEW; k++)
		before = plan->rows[engine_row(d->signals[k])];
	if (before == ADOPT_NEW)
		return;
	before = old->table.signals[before].device == TABLE_NO_DEVICE
	                 ? old->table.device_count
	                 : old->table.signals[before].device;
	was = &old->table.devices[before];
	d->absent = was->absent;
	d->shown_ns = was->shown_ns;
	d->watch = was->watch;
	d->found = was->found;
	d->moved_ns = was->moved_ns;
	if (e->known)
		adopt_presences(e, index, old, before, plan);
	lane = plan->port_successors[old->groups[was->group].first];
	if (lane < 0)
		return;
	d->group = e->lanes[lane].port->group;
	d->por = was->por;
	d->por_ns = was->por_ns;
}

static void take_devices(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	engine_facts_adopt(e, old, plan->port_successors);
	for (uint32_t i = 0; i <= e->table.device_count; i++) {
		struct device *d = &e->table.devices[i];

		if (!d->count)
			continue;
		take_device(e, i, old, plan);
		serve_device(e, i, engine_open_lane(e, d->group));
	}
	engine_presences_check(e);
}

/* --- Signals --------------------------------------------------------------------------------- */

/* A value that another target gave is the last usable one at best. */
static void take_source(struct signal *s, const struct adoption *plan)
{
	uint8_t before = s->sample.target;

	if (before == 255)
		return;
	s->sample.target = (uint8_t)s->lane;
	if (plan->port_successors[before] == (int)s->lane)
		return;
	signal_forget_written(s);
	signal_lapse(s);
}

static void take_schedule(struct engine *e, struct signal *s, const struct engine *old,
                          uint32_t before)
{
	uint32_t row = engine_row(s);
	const struct signal *was = &old->table.signals[before];
	uint64_t read = wait_of(old, was, WAIT_READ), write = wait_of(old, was, WAIT_WRITE);

	engine_read_never(e, s);
	if (read && s->item->per_factor == was->item->per_factor)
		engine_read_at(e, s, read);
	else
		engine_read_now(e, s);
	due_set_remove(&engine_lane(e, s)->outputs, row);
	if (write && s->command.retry.failures)
		engine_write_at(e, s, write);
	else
		engine_write_check(e, s);
	engine_origin_wait(e, s);
}

static void take_signals(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		struct lane *lane = engine_lane(e, s);
		uint32_t before = plan->rows[engine_row(s)];
		const struct signal *was;

		if (before == ADOPT_NEW) {
			s->read.known_ns = e->time.now_ns;
			s->attrs.per_base = (uint32_t)e->time.period;
			engine_origin_begin(e, s);
			engine_read_now(e, s);
			engine_write_check(e, s);
			continue;
		}
		was = &old->table.signals[before];
		lane->writers -= signal_writes(s);
		if (signal_adopt(s, was))
			engine_origin_carry(e, s, old, before + 1);
		else
			engine_origin_begin(e, s);
		if (was->command.differs && !s->command.differs)
			engine_compares_no_more(e, s, s->sample.quality);
		if (!s->item->limits.any)
			engine_limits_end(e, s, was);
		lane->writers += signal_writes(s);
		take_source(s, plan);
		take_schedule(e, s, old, before);
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

static const struct alarm_item *alarm_before(const struct engine *old, uint32_t row)
{
	return row == ADOPT_NEW || !old->alarm_count
	               ? NULL
	               : bsearch(&row, old->alarm_items, old->alarm_count,
	                         sizeof(*old->alarm_items), compare_rows);
}

/* The item has no alarm any more: what the journal has of it ends. */
static void end_alarm(struct engine *e, uint32_t row, const struct alarm_item *was)
{
	struct alarm_item item = {.row = row};

	item.occurrence = was->occurrence;
	engine_alarm_rests(e, &item);
}

static void take_alarm(struct engine *e, struct alarm_item *item, const struct engine *old,
                       const struct adoption *plan)
{
	struct signal *s = &e->table.signals[item->row];
	struct lane *lane = engine_lane(e, s);
	uint32_t before = plan->rows[item->row];
	const struct alarm_item *was = alarm_before(old, before);
	const struct config_item *before_item;
	bool visits, arms, dead = alarm_show_dead(e, item);

	alarm_take_item(&lane->alarm, item, e->time.now_ns);
	if (was)
		item->occurrence = was->occurrence;
	if (lane->alarm.list.polls)
		engine_alarm_polled(e, item);
	if (!was)
		return;
	before_item = old->table.signals[before].item;
	visits = same_text(s->item->por_alarm, before_item->por_alarm) &&
	         same_text(s->item->latch_alarm, before_item->latch_alarm) &&
	         same_text(s->item->reset_latch, before_item->reset_latch);
	arms = same_text(s->item->set_alarm, before_item->set_alarm);
	if (visits)
		item->visit = was->visit;
	if (same_text(s->item->por_alarm, before_item->por_alarm)) {
		item->restart = was->restart;
		item->asks_por = was->restart.known;
	}
	if (arms)
		item->arming = was->arming;
	if (dead ||
	    !(alarm_is_arming(unarmed_of(old->table.signals[before].attrs.flags)) ? arms : visits))
		return;
	s->attrs.flags |= old->table.signals[before].attrs.flags &
	                  (OWS_ATTR_ALARM_UNARMED | OWS_ATTR_ALARM_WHY);
	s->alarm_err = old->table.signals[before].alarm_err;
}

static void take_alarms(struct engine *e, const struct engine *old, const struct adoption *plan)
{
	for (unsigned i = 0; i < e->lane_count; i++)
		for (uint32_t k = 0; k < e->alarm_count; k++)
			alarm_drop_item(&e->lanes[i].alarm, &e->alarm_items[k]);
	for (uint32_t k = 0; k < e->alarm_count; k++)
		take_alarm(e, &e->alarm_items[k], old, plan);
	for (uint32_t row = 0; row < e->table.count; row++) {
		const struct alarm_item *was = alarm_before(old, plan->rows[row]);

		if (was && !e->table.signals[row].item->alarm)
			end_alarm(e, row, was);
	}
}

/* --------------------------------------------------------------------------------------------- */

void engine_adopt(struct engine *e, struct engine *old, const struct adoption *plan, int64_t now_ns)
{
	/* from here on a program's set fails there, so nothing is lost between the two */
	engine_controllers_retire(old, e, now_ns);
	engine_controllers_adopt(e, old, plan->rows);
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
		if (plan->port_successors[i] < 0)
			guests_refuse(&old->lanes[i]);
	take_devices(e, old, plan);
	image_carry_journals(e->image, old->image, plan->successors);
	take_signals(e, old, plan);
	shelves_carry(e->image, old->image->base, old->image->header->size, plan->successors);
	engine_shelves_resume(e);
	take_alarms(e, old, plan);
	for (unsigned i = 0; i < e->lane_count; i++)
		lane_resume_reads(&e->lanes[i]);
	engine_in_force_adopted(e);
	engine_doubts(e);
	for (uint32_t row = 0; row < e->table.count; row++)
		engine_publish(e, &e->table.signals[row]);
	for (unsigned i = 0; i < e->lane_count; i++)
		engine_publish_target(e, &e->lanes[i]);
	engine_publish_counters(e);
	engine_publish_devices(e);
	engine_publish_driver(e);
}

void engine_abandon(struct engine *old)
{
	for (unsigned i = 0; i < old->lane_count; i++)
		guests_release(&old->lanes[i]);
}
