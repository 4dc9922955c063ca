/* SPDX-License-Identifier: MIT */
/* What is known of where each device is. Nothing here moves a device. */
#pragma once

#include "src/daemon/engine/state.h"

int engine_presences_init(struct engine *e); /* 0 or -ENOMEM */
void engine_presences_free(struct engine *e);

/* What an answer or the search of a bus says of a device; TABLE_NO_DEVICE is ignored. */
void engine_presence(struct engine *e, const struct lane *lane, uint32_t device,
                     enum route_presence presence);
/* Somebody says that the device is there, which is less than a good value of it. */
void engine_presence_claimed(struct engine *e, const struct lane *lane, uint32_t device);
/* A bus has found the device: what is known of it elsewhere is old. */
void engine_presence_found(struct engine *e, const struct lane *lane, uint32_t device);
/* A group has gone up or down: every device may be concerned. */
void engine_presences_check(struct engine *e);

/* Ask the bus for the next device to be looked for here; false: there is none, or not now. */
bool engine_probe_ask(struct lane *lane, struct slot *slot);
void engine_probe_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer);
/* Nothing is looked for on this lane any more. */
void engine_probes_forget(struct lane *lane);
