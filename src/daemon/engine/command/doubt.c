/* SPDX-License-Identifier: MIT */
/*
 * Writes in doubt: the engine gave them up, or moved their signals to another lane, and they may
 * still reach the device. Until they have ended, nothing else is written to their signals.
 */
#include <string.h>

#include "src/daemon/engine/command/doubt.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/schedule.h"

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

void engine_doubt_ended(struct engine *e, const struct slot *slot)
{
	struct signal *s = &e->table.signals[slot->row];

	s->command.forced = true;
	s->doubts = 0; /* but for what is still lent */
	engine_doubts(e);
	engine_write_check(e, s);
	engine_publish(e, s);
}
