/* SPDX-License-Identifier: MIT */
/*
 * What is lent to a bus while its signal moves to another lane, or while a reload goes on: the
 * answer only frees the slot.
 */
#include <assert.h>

#include "src/engine/due.h"
#include "src/engine/routing/disown.h"

static void disown_slot(struct lane *lane, struct slot *slot)
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
		s->command.one_shot |= slot->one_shot;
		break;
	case FOR_ALARM:
		s->alarming = false;
		break;
	case FOR_STRUCTURE:
	case FOR_PROBE:
	case FOR_RESTART:
	case FOR_GUEST:
		return;
	}
	signal_end(s, e->time.period, slot->begun);
}

void lane_disown(struct lane *lane, bool all)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		if (!slot->lent || slot->given_up || slot->moved ||
		    slot->purpose == FOR_STRUCTURE || slot->purpose == FOR_PROBE ||
		    slot->purpose == FOR_RESTART || slot->purpose == FOR_GUEST)
			continue;
		if (all || (slot->row != TABLE_NO_ROW &&
		            lane->engine->table.signals[slot->row].lane != lane->index))
			disown_slot(lane, slot);
	}
}

void lane_disown_alarm(struct lane *lane)
{
	struct slot *slot = lane->lent.alarm;

	if (slot && !slot->given_up && !slot->moved)
		disown_slot(lane, slot);
}

void lane_keep_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		slot->kept = slot->lent && !slot->given_up && !slot->moved &&
		             slot->purpose == FOR_READ;
	}
}

void lane_resume_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];
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
	struct lane_lent own = lane->lent;

	assert(lane->depth == before->depth && !lane->lent.count);
	for (unsigned i = 0; i < before->depth; i++)
		if (before->lent.slots[i].lent)
			come_over(&before->lent.slots[i], successors);
	lane->state = before->state;
	lane->counters = before->counters;
	lane->lent = before->lent;
	before->lent = own;
}
