/* SPDX-License-Identifier: MIT */
/* A device that is lost, or there again: what that means to all its signals. */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * The device was looked for, and is not there. Its signals that are read are due at once, and bad
 * by the first "no such device"; an output that is not read is bad at once.
 */
void engine_device_lost(struct lane *lane, uint32_t device);
/*
 * The device is there again, and may have restarted: read its signals on this lane, write its
 * outputs again and arm its alarms.
 */
void engine_device_back(struct lane *lane, struct device *device);
