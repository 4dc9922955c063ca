/* SPDX-License-Identifier: MIT */
/* The slots of a lane: rooms for requests, and which of them the bus has. */
#pragma once

#include "src/engine/state.h"

/*
 * Rooms for as many requests as the bus takes. 0, or -ENOMEM: slots_free() takes back what is
 * there.
 */
int slots_init(struct lane *lane);
void slots_free(struct lane *lane);

/* A slot that is not lent, the same until it is; NULL: all are. */
struct slot *slot_next(struct lane *lane);
/* Give the slot's request to the bus; false: the bus takes none now. */
bool slot_lend(struct lane *lane, struct slot *slot, int64_t now_ns);
/* The lent slot whose request has this id, NULL: none has. */
struct slot *slot_of_id(struct lane *lane, uint32_t id);
/* The bus is done with the slot. */
void slot_give_back(struct lane *lane, struct slot *slot);
