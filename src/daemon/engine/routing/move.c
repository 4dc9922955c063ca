/* SPDX-License-Identifier: MIT */
/*
 * A signal moves to another lane here and nowhere else. A value from before the move is never shown
 * as good, what was written is forgotten, and requests that the old bus still has count for
 * nothing.
 *
 * Writes are in doubt that the engine gave up, or whose signals moved: they may still reach the
 * device. Until they have ended, nothing else is written to their signals.
 */
#include <errno.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/move.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

bool lane_writes_output(const struct lane *lane, const struct slot *slot)
{
	const struct engine *e = lane->engine;

	if (slot->row == TABLE_NO_ROW)
		return false;
	if (slot->purpose == FOR_ALARM)
		return slot->req.op == BUS_WRITE &&
		       strcmp(slot->req.path, e->table.signals[slot->row].item->path) == 0;
	return slot->purpose == FOR_WRITE;
}

static bool lane_in_doubt(const struct lane *lane, const struct slot *slot)
{
	struct engine *e = lane->engine;

	return slot->lent && (slot->given_up || slot->moved) && lane_writes_output(lane, slot) &&
	       e->table.signals[slot->row].lane != lane->index && !engine_way(e, lane)->released;
}

enum doubt_round { FORGET_DOUBTS, COUNT_DOUBTS, WRITE_UNDOUBTED, DOUBT_ROUNDS };

/* The slots that are lent say all: few, and looked through only when something moved or ended. */
static void look_at_lent(struct lane *lane, enum doubt_round round)
{
	for (unsigned k = 0; k < lane->depth; k++) {
		const struct slot *slot = &lane->lent.slots[k];
		struct signal *s;

		if (!slot->lent || !lane_writes_output(lane, slot))
			continue;
		s = &lane->engine->table.signals[slot->row];
		if (round == FORGET_DOUBTS)
			s->doubts = 0;
		else if (round == COUNT_DOUBTS)
			s->doubts += lane_in_doubt(lane, slot);
		else if (!s->doubts)
			engine_write_check(lane->engine, s);
	}
}

void engine_doubts(struct engine *e)
{
	for (int round = 0; round < DOUBT_ROUNDS; round++)
		for (unsigned i = 0; i < e->lane_count; i++)
			look_at_lent(&e->lanes[i], (enum doubt_round)round);
}

/* A set of an input was an event: done late it is done, and nothing follows it but a newer set. */
static void set_was_done(struct engine *e, struct signal *s, const struct slot *slot)
{
	s->command.confirmed = true;
	s->command.written = slot->value;
	if (signal_is_string(s)) {
		memcpy(s->written_text, slot->data, slot->req.len);
		s->command.written_len = slot->req.len;
	}
	s->command.err = 0;
	engine_settle_earlier(e, s, slot);
	engine_settle(e, s);
	engine_read_now(e, s);
}

void engine_doubt_ended(struct engine *e, const struct slot *slot, int err)
{
	struct signal *s = &e->table.signals[slot->row];

	if (signal_repeats(s))
		s->command.forced = true;
	else if (err || s->command.confirmed)
		signal_forget_written(s);
	else
		set_was_done(e, s, slot);
	s->doubts = 0; /* but for what is still lent */
	engine_doubts(e);
	engine_write_check(e, s);
	engine_publish(e, s);
}

static void move_signal(struct engine *e, struct signal *s, struct lane *to)
{
	struct lane *from = engine_lane(e, s);
	uint32_t row = engine_row(s);

	lane_drop_row(from, row);
	from->counters.moves_out++;
	due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_READ));
	due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_WRITE));
	retry_clear(&s->read.retry);
	retry_clear(&s->command.retry);
	s->command.err = 0;
	signal_forget_written(s);
	s->attrs.flags &= ~(uint32_t)OWS_ATTR_ALARM_POLLED;
	s->sample.target = (uint8_t)to->index;
	signal_lapse(s); /* until the new target has answered */
	lane_take_row(to, row);
	to->counters.moves_in++;
}

/* Call it when the old lane has disowned its requests for the signal. */
static void signal_goes_on(struct engine *e, struct signal *s)
{
	if (s->doubts) {
		s->command.err = -EINPROGRESS;
		log_warning(e->log, "%s (%s): a write is in doubt: not written until it has ended",
		            s->item->name, s->item->path);
	}
	engine_read_now(e, s);
	engine_write_check(e, s);
	engine_publish(e, s);
}

static void move_alarms(struct engine *e, struct lane *from, struct lane *to, uint32_t device)
{
	for (uint32_t i = 0; i < e->alarm_count; i++) {
		struct alarm_item *item = &e->alarm_items[i];

		if (item->device != device)
			continue;
		if (alarm_drop_item(&from->alarm, item) && from->lent.alarm)
			from->lent.alarm->moved = true;
		alarm_take_item(&to->alarm, item, e->time.now_ns);
		if (to->alarm.list.polls)
			engine_alarm_polled(e, item);
	}
}

static bool has_alarms(const struct device *d)
{
	for (uint32_t k = 0; k < d->count; k++)
		if (d->signals[k]->item->alarm)
			return true;
	return false;
}

/* Is it moved only to learn whether it is there? With many targets that are many moves. */
static bool is_looked_for(struct engine *e, const struct device *d, const struct lane *from,
                          const struct lane *to)
{
	uint32_t index = (uint32_t)(d - e->table.devices);

	if (!from->state.up || !e->known || index == e->table.device_count)
		return false;
	return !d->found || engine_presences(e, index)[to->port->group].presence == ROUTE_UNKNOWN;
}

static void report_move(struct engine *e, const struct device *d, const struct lane *from,
                        const struct lane *to, const char *why)
{
	const struct signal *s = d->signals[0];

	log_at(e->log, is_looked_for(e, d, from, to) ? LOG_LEVEL_DEBUG : LOG_LEVEL_NOTICE,
	       "%s%s (%u signal%s): from %s to %s: %s", s->item->path, d->count > 1 ? " ..." : "",
	       d->count, d->count == 1 ? "" : "s", from->port->target, to->port->target, why);
}

static void move_signals(struct engine *e, struct device *d, struct lane *from, struct lane *to)
{
	uint32_t index = (uint32_t)(d - e->table.devices);

	d->absent = false;
	for (uint32_t k = 0; k < d->count; k++)
		move_signal(e, d->signals[k], to);
	engine_watch_anew(from, index);
	if (has_alarms(d))
		move_alarms(e, from, to, index);
}

void engine_move_device(struct engine *e, struct device *d, struct lane *to, const char *why)
{
	struct lane *from = engine_lane(e, d->signals[0]);

	report_move(e, d, from, to, why);
	move_signals(e, d, from, to);
	lane_disown(from, false);
	engine_publish_target(e, to);
	engine_doubts(e);
	for (uint32_t k = 0; k < d->count; k++)
		signal_goes_on(e, d->signals[k]);
}

void engine_move_lane(struct engine *e, struct lane *from, struct lane *to, const char *why)
{
	uint32_t moved = 0;

	for (uint32_t i = 0; i <= e->table.device_count; i++) {
		struct device *d = &e->table.devices[i];

		if (!d->count || d->group != from->port->group)
			continue;
		move_signals(e, d, from, to);
		moved += d->count;
	}
	log_at(e->log, engine_group(e, to)->state.quiet ? LOG_LEVEL_DEBUG : LOG_LEVEL_NOTICE,
	       "%u signal%s: from %s to %s: %s", moved, moved == 1 ? "" : "s", from->port->target,
	       to->port->target, why);
	engine_probes_forget(from);
	lane_disown(from, true);
	alarm_restart(&from->alarm);
	engine_publish_target(e, to);
	engine_doubts(e);
	for (uint32_t row = 0; row < e->table.count; row++)
		if (e->table.signals[row].lane == to->index)
			signal_goes_on(e, &e->table.signals[row]);
}
