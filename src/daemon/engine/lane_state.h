/* SPDX-License-Identifier: MIT */
/* A lane whose target goes up and fails, and what its bus reports by itself. */
#pragma once

#include "src/daemon/engine/state.h"

/* The target of an open lane went up; the bus has reported that now or before. */
void lane_up(struct lane *lane, const char *text);
/* The signals that no other lane has taken over go bad. */
void lane_down(struct lane *lane, int err);
/*
 * The bus has reported nothing at all since a request began, or all that it takes was given up: the
 * bus is stuck, not one device slow. And it answers again.
 */
void lane_stuck(struct lane *lane);
void lane_unstuck(struct lane *lane);
/* What the bus reports by itself. */
void lane_event(struct lane *lane, const struct bus_event *event);
