/* SPDX-License-Identifier: MIT */
/* The only place where a signal's lane changes, and the writes that are in doubt after it. */
#pragma once

#include "src/daemon/engine/state.h"

/* Is the request a write of an output: of the write step, or of InitValue by the alarm machine? */
bool lane_writes_output(const struct lane *lane, const struct slot *slot);
/* Writes in doubt ended, or their bus let go: count them anew, and write what waited for that. */
void engine_doubts(struct engine *e);
/*
 * The late end of a write, well or with err. It may have reached the device after the engine moved
 * on: the present value of an output is written again.
 */
void engine_doubt_ended(struct engine *e, const struct slot *slot, int err);

/* All signals of the device, TABLE_NO_DEVICE's too (devices[device_count]). */
void engine_move_device(struct engine *e, struct device *device, struct lane *to, const char *why);
/* All signals of the lane; it is not open any more. */
void engine_move_lane(struct engine *e, struct lane *from, struct lane *to, const char *why);
