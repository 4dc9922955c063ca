/* SPDX-License-Identifier: MIT */
/* Writes in doubt. */
#pragma once

#include "src/daemon/engine/state.h"

/* Is the request a write of an output: of the write step, or of InitValue by the alarm machine? */
bool lane_writes_output(const struct lane *lane, const struct slot *slot);
/* Writes in doubt ended, or their bus let go: count them anew, and write what waited for that. */
void engine_doubts(struct engine *e);
/*
 * The late end of a write. It may have reached the device after the engine moved on: the present
 * value is written again.
 */
void engine_doubt_ended(struct engine *e, const struct slot *slot);
