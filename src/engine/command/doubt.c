/* SPDX-License-Identifier: MIT */
/*
 * Writes in doubt: the engine gave them up, or moved their signals to another lane, and they may
 * still reach the device. Until they have ended, nothing else is written to their signals.
 */
#include <string.h>

#include "src/engine/command/doubt.h"
#include "src/engine/publish.h"
#include "src/engine/schedule.h"

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

/* The slots that are lent say all: few, and looked through only when something moved or ended. */
static void each_output_lent(struct engine *e, void (*visit)(struct lane *, const struct slot *))
{
	for (unsigned i = 0; i < e->lane_count; i++) {
		struct lane *lane = &e->lanes[i];

		for (unsigned k = 0; k < lane->depth; k++)
			if (lane->lent.slots[k].lent &&
			    lane_writes_output(lane, &lane->lent.slots[k]))
				visit(lane, &lane->lent.slots[k]);
	}
}

static void forget_doubts(struct lane *lane, const struct slot *slot)
{
	lane->engine->table.signals[slot->row].doubts = 0;
}

static void count_doubt(struct lane *lane, const struct slot *slot)
{
	lane->engine->table.signals[slot->row].doubts += lane_in_doubt(lane, slot);
}

static void write_undoubted(struct lane *lane, const struct slot *slot)
{
	struct signal *s = &lane->engine->table.signals[slot->row];

	if (!s->doubts)
		engine_write_check(lane->engine, s);
}

void engine_doubts(struct engine *e)
{
	each_output_lent(e, forget_doubts);
	each_output_lent(e, count_doubt);
	each_output_lent(e, write_undoubted);
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
