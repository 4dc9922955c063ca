/* SPDX-License-Identifier: MIT */
/* The guests of the lanes: which of them wait, and which have a request with the bus. */
#pragma once

#include "src/daemon/engine/state.h"

/* Take the guests that wait at the server's side into the lanes. */
void guests_take(struct engine *e);

/* Is it a guest's turn, where the table has something to ask too (others), or not? */
bool guest_turn(const struct lane *lane, bool others);
/* Give the request of the first one to the bus; false: the bus takes none now. */
bool guest_ask(struct lane *lane, struct slot *slot);
/* A request of the table went before them. */
void guest_passed(struct lane *lane);

/* The request of a guest ended, or was given up. */
void guest_done(struct engine *e, struct lane *lane, struct slot *slot,
                const struct bus_answer *answer);
/* The bus has given back the path and the data of a request that was given up. */
void guest_gone(struct engine *e, struct slot *slot);

/*
 * A reload. adopt: guests that wait on the lane `before`, or have something lent there, go on in a
 * lane that has taken its slots over. refuse: they learn that their target is down. release: they
 * get back what they had lent to buses that have ended.
 */
void guests_adopt(struct lane *lane, struct lane *before);
void guests_refuse(struct lane *lane);
void guests_release(struct lane *lane);
