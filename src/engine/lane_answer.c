/* SPDX-License-Identifier: MIT */
/* What is lent to a bus, until its answer comes or its time is over. */
#include "private.h"

#include <assert.h>
#include <errno.h>
#include <string.h>

static struct slot *slot_of(struct lane *lane, uint32_t id)
{
	struct slot *slot;

	if ((id & 0xffff) >= lane->depth)
		return NULL;
	slot = &lane->slots[id & 0xffff];
	return slot->lent && slot->req.id == id ? slot : NULL;
}

/* The request's time as the table sees it is over: by an answer, or given up. */
static void complete(struct lane *lane, struct slot *slot, const struct bus_answer *answer,
                     int64_t now_ns)
{
	bool counts = failure_of(answer->err) != FAILURE_VOID;
	struct engine *e = lane->engine;
	struct signal *s;

	if (slot->purpose == FOR_GUEST) {
		engine_guest_done(e, lane, slot, answer);
		return;
	}
	e->transactions += counts;
	switch (slot->purpose) {
	case FOR_GUEST:
		break;
	case FOR_STRUCTURE:
		engine_structure_done(e, lane, slot, answer);
		break;
	case FOR_PROBE:
		engine_probe_done(e, lane, slot, answer, now_ns);
		break;
	case FOR_READ:
		s = &e->table.signals[slot->row];
		s->reading = false;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		engine_read_done(e, lane, slot, answer, now_ns);
		engine_publish(e, s);
		alarm_passed(&lane->alarm);
		break;
	case FOR_WRITE:
		s = &e->table.signals[slot->row];
		s->writing = false;
		lane->writes_in_work--;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		engine_write_done(e, lane, slot, answer, now_ns);
		engine_publish(e, s);
		alarm_passed(&lane->alarm);
		break;
	case FOR_ALARM:
		if (slot->row == TABLE_NO_ROW) {
			alarm_answered(&lane->alarm, lane, slot, answer, now_ns);
			break;
		}
		s = &e->table.signals[slot->row];
		s->alarming = false;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		alarm_answered(&lane->alarm, lane, slot, answer, now_ns);
		engine_publish(e, s);
		break;
	}
}

static void give_back(struct lane *lane, struct slot *slot)
{
	slot->lent = false;
	lane->lent--;
	lane->free[lane->free_count++] = (uint16_t)(slot - lane->slots);
	if (lane->alarm_slot == slot)
		lane->alarm_slot = NULL;
}

/* A write of the write step, or of InitValue by the alarm machine. */
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

bool lane_in_doubt(const struct lane *lane, const struct slot *slot)
{
	struct engine *e = lane->engine;

	return slot->lent && (slot->given_up || slot->moved) && lane_writes_output(lane, slot) &&
	       e->table.signals[slot->row].lane != lane->index &&
	       !engine_way(e, lane)->released;
}

/* It may have reached the relay after the engine moved on. */
static void end_doubt(struct engine *e, const struct slot *slot)
{
	struct signal *s = &e->table.signals[slot->row];

	s->forced = true;
	s->doubts = 0; /* but for what is still lent */
	engine_doubts(e);
	engine_write_check(e, s);
	engine_publish(e, s);
}

static void disown(struct lane *lane, struct slot *slot)
{
	struct engine *e = lane->engine;
	struct signal *s;

	slot->moved = true;
	if (slot->row == TABLE_NO_ROW)
		return;
	s = &e->table.signals[slot->row];
	switch (slot->purpose) {
	case FOR_READ:
		s->reading = false;
		break;
	case FOR_WRITE:
		s->writing = false;
		s->one_shot |= slot->one_shot;
		break;
	case FOR_ALARM:
		s->alarming = false;
		break;
	case FOR_STRUCTURE:
	case FOR_PROBE:
	case FOR_GUEST:
		return;
	}
	signal_end(s, e->period, slot->begun);
}

void lane_keep_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];

		slot->kept = slot->lent && !slot->given_up && !slot->moved &&
		             slot->purpose == FOR_READ;
	}
}

void lane_resume_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];
		struct signal *s;

		if (!slot->kept || slot->row == TABLE_NO_ROW)
			continue;
		s = &lane->engine->table.signals[slot->row];
		if (s->lane != lane->index || s->item->fresh != slot->req.fresh || !signal_reads(s))
			continue;
		slot->moved = false;
		due_set_remove(&lane->inputs, slot->row);
		s->reading = true;
		signal_begin(s, slot->begun);
	}
}

void lane_disown(struct lane *lane, bool all)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];

		if (!slot->lent || slot->given_up || slot->moved ||
		    slot->purpose == FOR_STRUCTURE || slot->purpose == FOR_PROBE ||
		    slot->purpose == FOR_GUEST)
			continue;
		if (all || (slot->row != TABLE_NO_ROW &&
		            lane->engine->table.signals[slot->row].lane != lane->index))
			disown(lane, slot);
	}
}

void lane_disown_alarm(struct lane *lane)
{
	struct slot *slot = lane->alarm_slot;

	if (slot && !slot->given_up && !slot->moved)
		disown(lane, slot);
}

void lane_forget_probes(struct lane *lane)
{
	int64_t device;

	while ((device = due_set_next(&lane->probes)) >= 0) {
		due_set_take(&lane->probes, (uint32_t)device);
		lane->engine->table.devices[device].probing = false;
	}
}

static void come_over(struct slot *slot, const uint32_t *successors)
{
	bool of_row = slot->purpose == FOR_READ || slot->purpose == FOR_WRITE ||
	              slot->purpose == FOR_ALARM;

	if (slot->purpose == FOR_GUEST)
		return;
	slot->moved = true;
	slot->row = of_row && slot->row != TABLE_NO_ROW ? successors[slot->row] : TABLE_NO_ROW;
}

void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors)
{
	struct lane own = *lane;

	assert(lane->depth == before->depth && !lane->lent);
	for (unsigned i = 0; i < before->depth; i++)
		if (before->slots[i].lent)
			come_over(&before->slots[i], successors);
	lane->up = before->up;
	lane->was_up = before->was_up;
	lane->stuck = before->stuck;
	lane->open = before->open;
	lane->said_up = before->said_up;
	lane->heard_ns = before->heard_ns;
	lane->slots = before->slots;
	lane->free = before->free;
	lane->free_count = before->free_count;
	lane->look_ns = before->look_ns;
	lane->lent = before->lent;
	lane->writes_in_work = before->writes_in_work;
	lane->list = before->list;
	lane->alarm_slot = before->alarm_slot;
	lane->counters = before->counters;
	before->slots = own.slots;
	before->free = own.free;
	before->free_count = own.free_count;
	before->lent = before->writes_in_work = 0;
	before->list = own.list;
	before->alarm_slot = NULL;
	guests_adopt(lane, before);
}

void lane_answer(struct lane *lane, const struct bus_answer *answer, int64_t now_ns)
{
	struct slot *slot = slot_of(lane, answer->id);
	struct engine *e = lane->engine;

	lane->heard_ns = now_ns;
	if (!slot) {
		lane->counters.unknown_answers++;
		return;
	}
	if (trace_is_on(e->log))
		trace_answer(lane, slot, answer, now_ns);
	give_back(lane, slot);
	if (!slot->given_up && !slot->moved) {
		complete(lane, slot, answer, now_ns);
	} else {
		lane->counters.late_answers += slot->given_up;
		if (!slot->given_up && slot->purpose == FOR_WRITE)
			lane->writes_in_work--;
		if (slot->purpose == FOR_GUEST)
			engine_guest_gone(e, slot);
		else if (lane_writes_output(lane, slot))
			end_doubt(e, slot);
	}
	if (lane->stuck)
		lane_unstuck(lane, now_ns);
}

int64_t lane_timeouts(struct lane *lane, int64_t now_ns)
{
	int64_t next = INT64_MAX;
	bool silent = false;
	unsigned lost = 0;

	if (!lane->lent)
		return next;
	if (now_ns < lane->look_ns)
		return lane->look_ns;
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];
		int64_t end = slot->req.deadline_ns + LANE_GRACE_NS;
		struct bus_answer answer = { .id = slot->req.id, .err = -EINPROGRESS };

		if (!slot->lent)
			continue;
		if (slot->given_up) {
			lost++;
			continue;
		}
		if (end > now_ns) {
			if (end < next)
				next = end;
			continue;
		}
		lost++;
		lane->counters.given_up++;
		if (lane->heard_ns <= slot->begun_ns) {
			answer.err = -ETIMEDOUT;
			silent = true;
		}
		if (trace_is_on(lane->engine->log))
			trace_answer(lane, slot, &answer, now_ns);
		slot->given_up = true;
		if (!slot->moved)
			complete(lane, slot, &answer, now_ns);
		else if (slot->purpose == FOR_WRITE)
			lane->writes_in_work--;
	}
	lane->look_ns = next;
	if (!lane->stuck && (silent || lost == lane->depth))
		lane_stuck(lane, now_ns);
	return next;
}
