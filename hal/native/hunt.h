/* SPDX-License-Identifier: MIT */
/* Searches: in the background, for directories and alarms. */
#pragma once

#include "hal/native/state.h"

/* One pass of a background search; true: did one. initial: at once, for the first list. */
bool hunt_step(struct native *native, int64_t now, bool idle, int64_t *next);
/* A search has met the id: a device is there, or a bridge that has no id yet is woken. */
void hunt_found(struct native *native, const uint8_t rom[8], unsigned n, int64_t now);
void hunt_scan(struct native *native, struct job *job, int64_t now);
