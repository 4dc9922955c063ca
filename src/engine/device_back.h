/* SPDX-License-Identifier: MIT */
/* A device that came back. */
#pragma once

#include "src/engine/state.h"

/*
 * The device is there again, and may have restarted: read its signals on this lane, write its
 * outputs again and arm its alarms.
 */
void engine_device_back(struct lane *lane, struct device *device);
