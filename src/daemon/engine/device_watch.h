/* SPDX-License-Identifier: MIT */
/* Looks for devices whose signals would not show in time that the device is lost. */
#pragma once

#include "src/daemon/engine/state.h"

/* 0 or -ENOMEM. */
int engine_watch_init(struct engine *e);
void engine_watch_free(struct engine *e);
/* A new period: what was silent for too long becomes due. */
void engine_watch_tick(struct engine *e);
/* An answer for the slot's signal came: it may show that the device is there. */
void engine_watch_heard(struct lane *lane, const struct slot *slot,
                        const struct bus_answer *answer);
/* Ask for the next device that is due; false: none is, or the bus takes nothing now. */
bool engine_watch_ask(struct lane *lane, struct slot *slot);
void engine_watch_done(struct lane *lane, const struct slot *slot, const struct bus_answer *answer);
