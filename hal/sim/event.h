/* SPDX-License-Identifier: MIT */
#ifndef HAL_SIM_EVENT_H
#define HAL_SIM_EVENT_H

#include "hal/sim/net.h"
#include "hal/sim/words.h"

/*
 * Read what happens, to the end of the line. One event, or with "for TIME" two: the second, at_ns
 * later, ends the first. Returns how many; 0 when words failed.
 */
unsigned event_parse(const struct sim_net *net, struct words *words, struct sim_event event[2]);

#endif
