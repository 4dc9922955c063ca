/* SPDX-License-Identifier: MIT */
/*
 * Presence belongs to the device: whatever has shown that it is lost, or is there again, comes here
 * and counts for all its signals.
 *
 * A signal that is read in each period shows by itself when its device is lost. One that is read
 * seldom (by alarms, with a large PerFactor) or never (an output without ReadBack) does not: its
 * device is looked for when nothing has shown it for WATCH_NS. A look is a search for one id; it
 * reads no value, so it converts nothing and clears nothing, and costs as much as one reading.
 */
#include <errno.h>

#include "hal/base/time.h"
#include "src/daemon/engine/alarm/alarm_arm.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

/* A device that has shown nothing for so long is looked for; or for a period, if that is longer. */
#define WATCH_NS (2 * NS_PER_S)

static int64_t watch_ns(const struct engine *e)
{
	return e->config->period_ns > WATCH_NS ? e->config->period_ns : WATCH_NS;
}

static void watch_at(struct engine *e, uint32_t device, int64_t ns)
{
	due_wheel_at(&e->wheel, engine_device_wait(e, device, WAIT_WATCH), engine_period_at(e, ns));
}

void engine_watch_anew(struct lane *lane, uint32_t device)
{
	struct engine *e = lane->engine;

	if (device == e->table.device_count)
		return;
	retry_clear(&e->table.devices[device].watch);
	if (due_set_has(&lane->watch, device))
		due_set_remove(&lane->watch, device);
	else if (!e->wheel.wait[engine_device_wait(e, device, WAIT_WATCH)]
	                  .waits) /* with the bus, or never watched */
		return;
	watch_at(e, device, e->time.now_ns + watch_ns(e));
}

/* Nothing else would show it of an output that is not read. */
static void lose_output(struct engine *e, struct signal *s)
{
	if (!s->item->output || s->sample.quality == OWS_Q_INITIAL ||
	    s->sample.quality == OWS_Q_NO_DEVICE)
		return;
	signal_hold(s); /* another target may have the device */
	s->sample.quality = OWS_Q_NO_DEVICE;
	s->sample.err = -ENODEV;
	log_warning(e->log, "%s (%s): %s", s->item->name, s->item->path,
	            ows_quality_text(OWS_Q_NO_DEVICE));
	engine_publish(e, s);
}

void engine_device_lost(struct lane *lane, uint32_t index)
{
	struct engine *e = lane->engine;
	struct device *device = &e->table.devices[index];
	bool known = device->absent;

	device->absent = true;
	engine_presence(e, lane, index, ROUTE_ABSENT);
	for (uint32_t i = 0; i < device->count; i++) {
		struct signal *s = device->signals[i];

		if (!signal_is_read(s))
			lose_output(e, s);
		else if (!known)
			engine_read_now(e, s);
	}
}

void engine_device_back(struct lane *lane, struct device *device)
{
	struct engine *e = lane->engine;

	device->absent = false;
	device->por = POR_UNKNOWN;
	engine_watch_anew(lane, (uint32_t)(device - e->table.devices));
	lane->counters.device_returns++;
	for (uint32_t i = 0; i < device->count; i++) {
		struct signal *s = device->signals[i];

		retry_clear(&s->read.retry);
		retry_clear(&s->command.retry);
		due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_WRITE));
		alarm_rearm(&lane->alarm, e, s->device);
		signal_forget_written(s);
		engine_read_now(e, s);
		engine_write_check(e, s);
		/* neither read nor written: what it has is not known */
		if (s->sample.quality == OWS_Q_NO_DEVICE && !signal_is_read(s) &&
		    !signal_changed(s)) {
			signal_lapse(s);
			engine_publish(e, s);
		}
	}
}

/* Between two looks on a lane: the signals that are read come first. */
#define WATCH_APART_NS (100 * NS_PER_MS)

/* By the file alone. */
static bool may_be_overlooked(const struct engine *e, const struct signal *s)
{
	return s->item->alarm || s->item->output ||
	       s->item->per_factor * e->config->period_ns > watch_ns(e);
}

/* Would its own readings show too late, or never, that the device is lost? */
static bool is_overlooked(struct engine *e, struct lane *lane, const struct signal *s)
{
	int64_t back_ns = s->item->read_back_ns;

	if (signal_reads(s))
		return engine_reads_apart(e, lane, s) > engine_periods(e, watch_ns(e));
	return s->item->output && s->sample.count && (!back_ns || back_ns > watch_ns(e));
}

static bool is_to_be_watched(struct engine *e, struct lane *lane, const struct device *d)
{
	bool overlooked = false, read = false;

	for (uint32_t k = 0; k < d->count; k++) {
		overlooked |= is_overlooked(e, lane, d->signals[k]);
		read |= signal_is_read(d->signals[k]);
	}
	/* the return of a lost one is shown by what is tried again */
	return overlooked && !(d->absent && read);
}

void engine_watch_begin(struct engine *e)
{
	for (uint32_t i = 0; i < e->table.device_count; i++) {
		const struct device *d = &e->table.devices[i];
		bool any = false;

		for (uint32_t k = 0; k < d->count; k++)
			any |= may_be_overlooked(e, d->signals[k]);
		if (any)
			watch_at(e, i, e->time.start_ns + watch_ns(e));
	}
}

void engine_watch_due(struct engine *e, uint32_t index)
{
	const struct device *d = &e->table.devices[index];
	struct lane *lane = engine_lane(e, d->signals[0]);
	int64_t due_ns = d->shown_ns + watch_ns(e);

	if (due_ns > e->time.now_ns)
		watch_at(e, index, due_ns);
	else if (lane->state.up && is_to_be_watched(e, lane, d))
		due_set_add(&lane->watch, index);
	else
		watch_at(e, index, e->time.now_ns + watch_ns(e));
}

/* What a cache has says nothing of the device as it is now; nor does a write. */
void engine_watch_heard(struct lane *lane, const struct slot *slot, const struct bus_answer *answer)
{
	struct engine *e = lane->engine;
	const struct signal *s = slot_signal(lane, slot);

	if (slot->req.op != BUS_READ || answer->err || (answer->detail & BUS_DETAIL_CACHED) ||
	    !(slot->req.fresh || lane->port->searches) || !s->shows_device || !signal_has_device(s))
		return;
	e->table.devices[s->device].shown_ns = slot->begun_ns;
	retry_clear(&e->table.devices[s->device].watch);
}

bool engine_watch_ask(struct lane *lane, struct slot *slot)
{
	struct engine *e = lane->engine;
	int64_t device = due_set_next(&lane->watch);

	if (device < 0 || lane->watching || e->time.now_ns < lane->watch_ns ||
	    !slot_look_for(lane, slot, FOR_WATCH, (uint32_t)device) || !slot_lend(lane, slot))
		return false;
	due_set_take(&lane->watch, (uint32_t)device);
	lane->watching = true;
	lane->watch_ns = e->time.now_ns + WATCH_APART_NS;
	lane->counters.watches++;
	return true;
}

/* Signals that are read show by themselves what the matter is. */
static void read_all(struct engine *e, const struct device *d)
{
	for (uint32_t k = 0; k < d->count; k++)
		if (!d->signals[k]->read.retry.failures)
			engine_read_now(e, d->signals[k]);
}

/* Returns when the device is looked for again. */
static int64_t watch_failed(struct lane *lane, uint32_t index, int err)
{
	struct engine *e = lane->engine;
	struct device *d = &e->table.devices[index];
	int64_t wait_ns;
	bool lost;

	if (err != -ENODEV) { /* the wire, or a bridge chip: that is no absence */
		read_all(e, d);
		return watch_ns(e);
	}
	lost = retry_fail(&d->watch, d->absent ? 0 : e->config->max_retries, &wait_ns);
	if (lost)
		engine_device_lost(lane, index);
	else
		read_all(e, d);
	if (lost && lane->port->brief && wait_ns > RETRY_FIRST_NS)
		wait_ns = RETRY_FIRST_NS;
	return lost ? wait_ns : WATCH_APART_NS;
}

void engine_watch_done(struct lane *lane, const struct slot *slot, const struct bus_answer *answer)
{
	struct engine *e = lane->engine;
	struct device *d = &e->table.devices[slot->row];
	int64_t wait_ns = watch_ns(e);

	lane->watching = false;
	if (engine_lane(e, d->signals[0]) == lane && !answer->err) {
		d->shown_ns = slot->begun_ns;
		retry_clear(&d->watch);
		if (d->absent)
			engine_device_back(lane, d);
	} else if (engine_lane(e, d->signals[0]) == lane &&
	           failure_of(answer->err) == FAILURE_ITEM) {
		wait_ns = watch_failed(lane, slot->row, answer->err);
	}
	watch_at(e, slot->row, slot->begun_ns + wait_ns);
}
