/* SPDX-License-Identifier: MIT */
/* The only place where a signal's lane changes. */
#pragma once

#include "src/daemon/engine/state.h"

/* All signals of the device, TABLE_NO_DEVICE's too (devices[device_count]). */
void engine_move_device(struct engine *e, struct device *device, struct lane *to, const char *why);
/* All signals of the lane; it is not open any more. */
void engine_move_lane(struct engine *e, struct lane *from, struct lane *to, const char *why);
