/* SPDX-License-Identifier: MIT */
/* The check of types on a lane, once for each property when the lane comes to serve it. */
#pragma once

#include "src/daemon/engine/state.h"

/* The next check that a signal of this lane needs; -1: none. */
int64_t types_next(struct lane *lane);
/* Give that check to the bus; false: the bus takes none now. */
bool types_ask(struct lane *lane, struct slot *slot, uint32_t check);
void types_done(struct lane *lane, const struct slot *slot, const struct bus_answer *answer);
