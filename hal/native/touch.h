/* SPDX-License-Identifier: MIT */
/* Keys that touch a wire: families 01 and 81 are searched for all the time, where that is asked. */
#pragma once

#include "hal/native/state.h"

/* One pass of such a search; true: did one. */
bool touch_step(struct native *native, int64_t now, int64_t *next);
/* Has such a search just seen this key? Then no other look for it is needed. */
bool touch_knows(const struct native *native, const struct device *device, int64_t now);

/* Are ids of this family searched for all the time? */
bool touch_seeks(const struct native *native, const uint8_t rom[8]);
