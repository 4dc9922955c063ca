/* SPDX-License-Identifier: MIT */
/* The end of a request that is lent to a bus. */
#pragma once

#include "src/daemon/engine/state.h"

void lane_answer(struct lane *lane, const struct bus_answer *answer);
/* Give requests up whose time is over; returns when the next one's is. */
int64_t lane_timeouts(struct lane *lane);
