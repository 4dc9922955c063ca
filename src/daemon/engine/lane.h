/* SPDX-License-Identifier: MIT */
/* A lane, the engine's side of one bus: its slots, and which of them the bus has; its rows. */
#pragma once

#include "src/daemon/engine/state.h"

/* A slot that is not lent, the same until it is; NULL: all are. */
struct slot *slot_next(struct lane *lane);
/* Give the slot's request to the bus; false: the bus takes none now. */
bool slot_lend(struct lane *lane, struct slot *slot);
/* Make its request a look for the device; false: its path has none. */
bool slot_look_for(struct lane *lane, struct slot *slot, enum purpose purpose, uint32_t device);
/* The lent slot with the request of this id, NULL: none has it. */
struct slot *slot_of_id(struct lane *lane, uint32_t id);
/* Does its request count for a row of the table, and which signal is that? */
bool slot_has_row(const struct slot *slot);
struct signal *slot_signal(const struct lane *lane, const struct slot *slot);
/* The request of such a slot is in work for its signal no longer. */
void slot_leaves_signal(const struct lane *lane, const struct slot *slot);
/* The bus is done with the slot. */
void slot_give_back(struct lane *lane, struct slot *slot);

/* Room for every row of the table; 0 or -ENOMEM. */
int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index);
void lane_free(struct lane *lane);

/* The lane serves the row from now on, no longer: rows that are due, writers. */
void lane_take_row(struct lane *lane, uint32_t row);
void lane_drop_row(struct lane *lane, uint32_t row);

/*
 * Requests in flight for signals that another lane serves now (all: every request of the table)
 * count for nothing but their slots any more.
 */
void lane_disown(struct lane *lane, bool all);
/* The request of the alarm machine counts for nothing either; the machine begins anew. */
void lane_disown_alarm(struct lane *lane);

/*
 * keep: mark the readings in flight when a reload begins, before all is disowned. resume: those for
 * signals that stay in this lane go on here, when its signals are known.
 */
void lane_keep_reads(struct lane *lane);
void lane_resume_reads(struct lane *lane);
/*
 * A reload: this lane, which was never filled, goes on where `before` of another engine stands.
 * What is lent comes over and counts for nothing but its slots, and for outputs that it may still
 * reach, until readings are resumed: successors[row] is that row here, TABLE_NO_ROW: it has none.
 */
void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors);
