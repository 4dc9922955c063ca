/* SPDX-License-Identifier: MIT */
/* What a bus reports by itself. */
#ifndef ENGINE_LANE_EVENT_H
#define ENGINE_LANE_EVENT_H

#include "src/engine/state.h"

void lane_event(struct lane *lane, const struct bus_event *event, int64_t now_ns);

#endif
