/* SPDX-License-Identifier: MIT */
/*
 * What is lent to a bus while its signal moves to another lane, or while a reload goes on: the
 * answer only frees the slot.
 */
#include <assert.h>

#include "src/daemon/engine/due.h"
#include "src/daemon/engine/routing/disown.h"
#include "src/daemon/engine/slots.h"

static void disown_slot(struct lane *lane, struct slot *slot)
{
	slot->moved = true;
	if (!slot_has_row(slot))
		return;
	if (slot->purpose == FOR_WRITE)
		slot_signal(lane, slot)->command.one_shot |= slot->one_shot;
	slot_leaves_signal(lane, slot);
}

void lane_disown(struct lane *lane, bool all)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		if (!slot->lent || slot->given_up || slot->moved)
			continue;
		if (all ? slot_has_row(slot) || slot->purpose == FOR_ALARM
		        : slot_has_row(slot) && slot_signal(lane, slot)->lane != lane->index)
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
	if (slot->purpose == FOR_GUEST)
		return;
	slot->moved = true;
	slot->row = slot_has_row(slot) ? successors[slot->row] : TABLE_NO_ROW;
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
