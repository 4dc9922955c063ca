/* SPDX-License-Identifier: MIT */
/* The slots of a lane: rooms for requests, and which of them the bus has. */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * Rooms for as many requests as the bus takes. 0, or -ENOMEM: slots_free() takes back what is
 * there.
 */
int slots_init(struct lane *lane);
void slots_free(struct lane *lane);

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
