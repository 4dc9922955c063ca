/* SPDX-License-Identifier: MIT */
/*
 * A lane whose target goes up, fails, is stuck or answers again: what that means to the signals of
 * the lane, and the fact for routing.
 */
#include <errno.h>

#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/alarm/alarm_list.h"
#include "src/daemon/engine/lane_state.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/disown.h"
#include "src/daemon/engine/routing/group.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

/*
 * All signals of the lane are read again, and written if there is something to write. What is not
 * read in the cycle is not good before that: the devices may have lost their supply as well.
 */
static void refresh_signals(struct lane *lane)
{
	struct engine *e = lane->engine;
	const struct signal *first = NULL;
	unsigned unknown = 0;

	alarm_ask_again(&lane->alarm, lane);
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (s->lane != lane->index)
			continue;
		retry_clear(&s->read.retry);
		retry_clear(&s->command.retry);
		due_wheel_cancel(&e->wheel, engine_row(s) * 2 + 1);
		engine_read_now(e, s);
		engine_write_check(e, s);
		if (s->read.held && !signal_reads(s) && s->sample.quality == OWS_Q_TARGET) {
			signal_lapse(s);
			engine_publish(e, s);
			if (s->sample.quality == OWS_Q_LAST_USABLE && !signal_is_read(s) &&
			    !signal_changed(s)) {
				first = first ? first : s;
				unknown++;
			}
		}
		s->read.held = false;
	}
	if (unknown)
		log_notice(e->log,
		           "%s: %u of its outputs (%s%s) %s not read back: what they have after "
		           "this is not known until they are set",
		           lane->port->target, unknown, first->item->name,
		           unknown > 1 ? ", ..." : "", unknown > 1 ? "are" : "is");
}

void lane_up(struct lane *lane, const char *text)
{
	struct engine *e = lane->engine;

	if (lane->state.up)
		return;
	lane->state.up = true;
	engine_group(e, lane)->state.quiet = false;
	engine_way(e, lane)->up = true;
	engine_way(e, lane)->failed = lane->state.stuck;
	engine_way(e, lane)->up_ns = e->time.now_ns;
	if (lane->state.was_up) {
		lane->counters.reconnects++;
		e->driver.reconnects++;
	}
	log_notice(e->log, "%s: from down to up%s%s", lane->port->target, *text ? ": " : "", text);
	lane->state.was_up = true;
	lane->state.why_down.text[0] = '\0';
	engine_publish_target(e, lane);
	engine_publish_driver(e);
	refresh_signals(lane);
	engine_group_asks(lane);
}

void lane_fail(struct lane *lane, int err)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	if (!way->failed)
		way->failed_ns = e->time.now_ns;
	way->failed = true;
	way->up = false;
	engine_probes_forget(lane);
	lane_disown_alarm(lane);
	lane->state.fell = err;
	engine_group_asks(lane);
}

void lane_down(struct lane *lane, int err)
{
	struct engine *e = lane->engine;

	alarm_restart(&lane->alarm);
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (s->lane != lane->index ||
		    (s->sample.quality == OWS_Q_DISABLED && !s->item->output && !signal_reads(s)))
			continue;
		signal_hold(s);
		s->command.lapsed |= s->command.confirmed;
		s->sample.quality = OWS_Q_TARGET;
		s->sample.err = err;
		engine_publish(e, s);
	}
}

void lane_stuck(struct lane *lane)
{
	lane->state.stuck = true;
	if (!lane->state.open)
		return;
	log_err(lane->engine->log, "%s: no answer at all within Timeout", lane->port->target);
	lane->counters.target_failures++;
	lane_fail(lane, -ETIMEDOUT);
}

void lane_unstuck(struct lane *lane)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	lane->state.stuck = false;
	log_notice(e->log, "%s: answers again", lane->port->target);
	if (!lane->state.up)
		return;
	way->failed = false;
	way->up = true;
	way->up_ns = e->time.now_ns;
	refresh_signals(lane);
	engine_group_asks(lane);
}
