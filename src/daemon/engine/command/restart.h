/* SPDX-License-Identifier: MIT */
/*
 * Did a device restart? Asked of its power-on flag (por), where its outputs are read back and no
 * alarm item watches it.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/bus.h"

struct lane;
struct signal;
struct slot;

/* The output was read back: ask for the flag if that is to be known. */
void engine_restart_look(struct lane *lane, const struct signal *s, bool agrees);
/* True: the request for one of these flags was given to the bus. */
bool engine_restart_ask(struct lane *lane, struct slot *slot);
void engine_restart_done(struct lane *lane, const struct slot *slot,
                         const struct bus_answer *answer);
