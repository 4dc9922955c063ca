/* SPDX-License-Identifier: MIT */
/* The end of a request that is lent to a bus: by its answer, or because its time is over. */
#include <errno.h>

#include "hal/base/time.h"
#include "src/daemon/engine/alarm/alarm.h"
#include "src/daemon/engine/command/read_back.h"
#include "src/daemon/engine/completion.h"
#include "src/daemon/engine/device_facts.h"
#include "src/daemon/engine/guests.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/lane_answer.h"
#include "src/daemon/engine/lane_state.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/move.h"
#include "src/daemon/engine/trace.h"

static void apply_answer(struct lane *lane, struct slot *slot, const struct bus_answer *answer)
{
	struct engine *e = lane->engine;

	switch (slot->purpose) {
	case FOR_GUEST:
		guest_done(e, lane, slot, answer);
		break;
	case FOR_PROBE:
		engine_probe_done(e, lane, slot, answer);
		break;
	case FOR_RESTART:
		engine_restart_done(lane, slot, answer);
		break;
	case FOR_WATCH:
		engine_watch_done(lane, slot, answer);
		break;
	case FOR_READ:
		engine_read_done(e, lane, slot, answer);
		alarm_passed(&lane->alarm);
		break;
	case FOR_WRITE:
		lane->lent.writes--;
		engine_write_done(e, lane, slot, answer);
		alarm_passed(&lane->alarm);
		break;
	case FOR_ALARM:
		alarm_answered(&lane->alarm, lane, slot, answer);
		break;
	}
}

/* The request's time as the table sees it is over: by an answer, or given up. */
static void complete_request(struct lane *lane, struct slot *slot, const struct bus_answer *answer)
{
	bool counts = failure_of(answer->err) != FAILURE_VOID;
	struct engine *e = lane->engine;
	struct signal *s;

	e->driver.transactions += counts && slot->purpose != FOR_GUEST;
	if (!slot_has_row(slot)) {
		apply_answer(lane, slot, answer);
		return;
	}
	s = slot_signal(lane, slot);
	/* a write of the signal may have begun since */
	s->sample.tried_ns = later_ns(s->sample.tried_ns, slot->begun_ns);
	s->attrs.transactions += counts;
	slot_leaves_signal(lane, slot);
	apply_answer(lane, slot, answer);
	engine_publish(e, s);
}

/*
 * A reading that was given up may be newer than what the signal has: a slow machine gets its values
 * late, not never. Its bus may have stamped it when it came: what was asked for later is newer.
 */
static void apply_late_reading(struct lane *lane, const struct slot *slot,
                               const struct bus_answer *answer)
{
	struct engine *e = lane->engine;
	struct signal *s;
	int64_t wait_ns;

	if (answer->err || slot->purpose != FOR_READ || slot->moved || !lane->state.open)
		return;
	s = &e->table.signals[slot->row];
	if (!signal_reads(s) || s->lane != lane->index || slot->begun_ns < s->read.begun_ns ||
	    (answer->measured_ns && answer->measured_ns <= s->sample.measured_ns))
		return;
	engine_apply_reading(e, lane, s, slot, answer, &wait_ns);
	engine_publish(e, s);
}

/* What a bus refuses, of signals and guests alike. */
static void count_refused(struct lane *lane, const struct slot *slot,
                          const struct bus_answer *answer)
{
	if (slot->req.op != BUS_READ)
		return;
	lane->counters.out_of_range += answer->err == -EDOM;
	lane->counters.power_faults += answer->err == -ERANGE;
}

void lane_answer(struct lane *lane, const struct bus_answer *answer)
{
	struct slot *slot = slot_of_id(lane, answer->id);
	struct engine *e = lane->engine;

	lane->state.heard_ns = e->time.now_ns;
	if (!slot) {
		lane->counters.unknown_answers++;
		return;
	}
	if (trace_is_on(e->log))
		trace_answer(lane, slot, answer);
	count_refused(lane, slot, answer);
	slot_give_back(lane, slot);
	if (!slot->moved && slot_has_row(slot)) {
		engine_facts_answer(e, lane, slot->row, answer);
		engine_watch_heard(lane, slot, answer);
	}
	if (!slot->given_up && !slot->moved) {
		complete_request(lane, slot, answer);
	} else {
		lane->counters.late_answers += slot->given_up;
		apply_late_reading(lane, slot, answer);
		if (!slot->given_up && slot->purpose == FOR_WRITE)
			lane->lent.writes--;
		if (slot->purpose == FOR_GUEST)
			guest_gone(e, slot);
		else if (lane_writes_output(lane, slot))
			engine_doubt_ended(e, slot, answer->err);
	}
	if (lane->state.stuck)
		lane_unstuck(lane);
}

/* A bus that did not run either, as in a suspend, has the grace for its answer when both do. */
static int64_t patience_ends(const struct engine *e, const struct slot *slot)
{
	return later_ns(slot->req.deadline_ns, e->time.resumed_ns) + LANE_GRACE_NS;
}

int64_t lane_timeouts(struct lane *lane)
{
	int64_t next = INT64_MAX, now_ns = lane->engine->time.now_ns;
	bool silent = false;
	unsigned lost = 0;

	if (!lane->lent.count)
		return next;
	if (now_ns < lane->lent.look_ns)
		return lane->lent.look_ns;
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];
		int64_t end = patience_ends(lane->engine, slot);
		struct bus_answer answer = {.id = slot->req.id, .err = -EINPROGRESS};

		if (!slot->lent)
			continue;
		if (slot->given_up) {
			lost++;
			continue;
		}
		if (end > now_ns) {
			next = earlier_ns(next, end);
			continue;
		}
		lost++;
		lane->counters.given_up++;
		if (lane->state.heard_ns <= slot->begun_ns) {
			answer.err = -ETIMEDOUT;
			silent = true;
		}
		if (trace_is_on(lane->engine->log))
			trace_answer(lane, slot, &answer);
		slot->given_up = true;
		if (!slot->moved)
			complete_request(lane, slot, &answer);
		else if (slot->purpose == FOR_WRITE)
			lane->lent.writes--;
	}
	lane->lent.look_ns = next;
	if (!lane->state.stuck && (silent || lost == lane->depth))
		lane_stuck(lane);
	return next;
}
