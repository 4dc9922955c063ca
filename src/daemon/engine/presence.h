/* SPDX-License-Identifier: MIT */
/*
 * A device that is lost, or there again: what that means to all its signals; and looks for devices
 * whose signals would not show in time that it is lost.
 */
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

/*
 * The device is there again, or leaves the lane: what looks for it have found counts no more, and
 * it is looked for after the usual time, on the lane that serves it then.
 */
void engine_watch_anew(struct lane *lane, uint32_t device);

/* Devices that may have to be looked for wait for that. */
void engine_watch_begin(struct engine *e);
/* The device has waited for that: if it was silent for too long it becomes due. */
void engine_watch_due(struct engine *e, uint32_t device);
/* An answer for the slot's signal came: it may show that the device is there. */
void engine_watch_heard(struct lane *lane, const struct slot *slot,
                        const struct bus_answer *answer);
/* Ask for the next device that is due; false: none is, or the bus takes nothing now. */
bool engine_watch_ask(struct lane *lane, struct slot *slot);
void engine_watch_done(struct lane *lane, const struct slot *slot, const struct bus_answer *answer);
