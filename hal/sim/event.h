/* SPDX-License-Identifier: MIT */
/* Events of a simulated network: parsed from a line of a scenario, and carried out. */
#pragma once

#include "hal/sim/net.h"
#include "hal/sim/words.h"

/*
 * Parse an event, to the end of the line. "for TIME" adds a second event, at_ns later, which ends
 * the first. Returns how many events; 0: words failed.
 */
unsigned event_parse(const struct sim_net *net, struct words *words, struct sim_event event[2]);

/*
 * May a button hold the event (button.h)? It lasts until it is ended. What befalls a bridge chip
 * does not: owsd ends it, or it takes the target away, and the button with it.
 */
bool event_is_held(const struct sim_event *event);

/*
 * Carry out one event now. The line is what follows "at TIME" in a scenario, as "unplug kitchen" or
 * "short 0x18.2 for 5s". 0, -EINVAL with the reason in why, -ENOMEM.
 */
int sim_scenario_event(struct sim_net *net, const char *line, int64_t now, char *why,
                       size_t why_size);
