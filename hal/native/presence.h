/* SPDX-License-Identifier: MIT */
/* Devices found, seen, lost and restarted. */
#pragma once

#include "hal/native/state.h"

/* On channel n: it is in the table then, if that has room. */
void presence_found(struct native *native, const uint8_t rom[8], unsigned n, int64_t now);
void presence_seen(struct device *device, int64_t now);
void presence_lost(struct native *native, struct device *device);
void presence_restarted(struct native *native, struct device *device);
