/* SPDX-License-Identifier: MIT */
/*
 * A lane whose target goes up, fails, is stuck or answers again, and what else its bus reports by
 * itself: what that means to the signals of the lane, and the facts for routing.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/engine/alarm/alarm.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/lane_state.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/move.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"
#include "src/ground/text/printable.h"

/* A fact of the lane's way changed: the next engine_route() acts on the group. */
static void group_asks(struct lane *lane)
{
	struct group *g = engine_group(lane->engine, lane);

	lane->engine->asking += !g->asks;
	g->asks = true;
}

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
		due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_WRITE));
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

static void keep_note(struct lane *lane, struct lane_note *note, const char *text)
{
	size_t len = printable_cut(text, sizeof(note->text) - 1);

	memcpy(note->text, text, len);
	note->text[printable(note->text, len)] = '\0';
	note->since_ns = lane->engine->time.now_ns;
	engine_publish_target(lane->engine, lane);
}

static const char no_answer[] = "no answer at all within Timeout";

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
	keep_note(lane, &lane->state.why_down, lane->state.stuck ? no_answer : "");
	engine_publish_driver(e);
	refresh_signals(lane);
	group_asks(lane);
}

/* Its signals stay as they are until routing has acted on that. */
static void lane_fail(struct lane *lane, int err)
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
	group_asks(lane);
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
	log_err(lane->engine->log, "%s: %s", lane->port->target, no_answer);
	lane->counters.target_failures++;
	keep_note(lane, &lane->state.why_down, no_answer);
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
	keep_note(lane, &lane->state.why_down, "");
	refresh_signals(lane);
	group_asks(lane);
}

/*
 * A server with a cache may give the same value again and again without a sign of it. The log
 * names, once for each target, the signals that are read more often than the server looks.
 */
static void report_cached(const struct lane *lane, int64_t cache_ns)
{
	const struct engine *e = lane->engine;
	const struct signal *first = NULL;
	unsigned count = 0;

	for (const struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (s->lane != lane->index || !signal_has_device(s) || !signal_reads(s) ||
		    s->item->fresh || s->item->alarm ||
		    e->config->period_ns >= cache_ns / s->item->per_factor)
			continue;
		first = first ? first : s;
		count++;
	}
	if (count)
		log_notice(e->log,
		           "%s: may answer from a cache of %lld s, and %u of its signals (%s%s) "
		           "are read more often: Uncached on reads the device each time, "
		           "timeout_volatile in owfs.conf shortens the cache",
		           lane->port->target, (long long)(cache_ns / NS_PER_S), count,
		           first->item->name, count > 1 ? ", ..." : "");
}

static void trouble_event(struct lane *lane, const char *text)
{
	struct lane_note *note = &lane->state.trouble;

	if (*text)
		log_notice(lane->engine->log, "%s: %s", lane->port->target, text);
	else
		log_notice(lane->engine->log, "%s: this is over: %s", lane->port->target,
		           note->text);
	keep_note(lane, note, text);
}

/*
 * What the signals of a lost target have as their error. Most are of an adapter that does not open,
 * and would mean something else of a device.
 */
static int error_of_loss(int err)
{
	static const int known[] = {-ECONNREFUSED, -ECONNRESET, -EPIPE, -ETIMEDOUT, -EPROTO};

	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		if (err == known[i])
			return err;
	return -ENOTCONN;
}

static void down_event(struct lane *lane, int err, const char *text)
{
	struct engine *e = lane->engine;
	bool quiet = engine_group(e, lane)->state.quiet && err == lane->state.down_err;

	lane->state.down_err = err;
	log_at(e->log, quiet ? LOG_LEVEL_DEBUG : LOG_LEVEL_WARNING, "%s: %s: %s",
	       lane->port->target, lane->state.up ? "from up to down" : "down",
	       *text ? text : strerror(-err));
	lane->state.up = false;
	lane->counters.target_failures++;
	keep_note(lane, &lane->state.why_down, *text ? text : strerror(-err));
	lane_fail(lane, error_of_loss(err));
}

static void device_event(struct lane *lane, const struct bus_event *event)
{
	struct engine *e = lane->engine;
	uint32_t index = table_device(&e->table, event->rom);
	struct device *device;

	if (index == TABLE_NO_DEVICE)
		return;
	device = &e->table.devices[index];
	if (event->news == BUS_FOUND)
		engine_presence_found(e, lane, index);
	if (engine_open_lane(e, device->group) != lane) {
		if (event->news == BUS_LOST)
			engine_presence(e, lane, index, ROUTE_ABSENT);
	} else if (event->news == BUS_LOST) {
		engine_device_lost(lane, index);
	} else if (event->news == BUS_POR || device->absent) {
		engine_device_back(lane, device);
	}
}

static void up_event(struct lane *lane, const struct bus_event *event)
{
	struct route_way *way = engine_way(lane->engine, lane);

	lane->state.reported_up = true;
	if (lane->state.open) {
		bool first = !lane->state.was_up;

		lane_up(lane, event->text);
		if (first && event->cache_ns)
			report_cached(lane, event->cache_ns);
	} else if (!lane->port->suspend &&
	           !way->back) { /* without suspend, BUS_UP is the only sign of that */
		way->back = true;
		way->back_ns = lane->engine->time.now_ns;
	}
}

/* What a way says that was asked to let go is of no interest, but for these two. */
static void suspended_event(struct lane *lane, const struct bus_event *event)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	if (lane->state.open)
		return;
	if (event->news == BUS_BACK) {
		way->back = true;
		way->back_ns = e->time.now_ns;
		keep_note(lane, &lane->state.why_down, "");
		log_debug(e->log, "%s: can be reached, and is kept closed", lane->port->target);
	} else if (!way->released) {
		way->released = true;
		engine_publish_target(e, lane);
		engine_doubts(e);
	}
	group_asks(lane);
}

void lane_event(struct lane *lane, const struct bus_event *event)
{
	lane->state.heard_ns = lane->engine->time.now_ns;
	switch ((enum bus_news)event->news) {
	case BUS_UP:
		up_event(lane, event);
		break;
	case BUS_DOWN:
		lane->state.reported_up = false;
		if (lane->state.open)
			down_event(lane, event->err, event->text);
		break;
	case BUS_FOUND:
	case BUS_POR:
	case BUS_LOST:
		if (lane->state.open)
			device_event(lane, event);
		break;
	case BUS_RELEASED:
	case BUS_BACK:
		suspended_event(lane, event);
		break;
	case BUS_NOTE:
		log_notice(lane->engine->log, "%s: %s", lane->port->target, event->text);
		break;
	case BUS_TROUBLE:
		trouble_event(lane, event->text);
		break;
	}
}
