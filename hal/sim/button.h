/* SPDX-License-Identifier: MIT */
/*
 * Events on demand: a button is a property of the target itself, /simulator/NAME. A 1 that is
 * written begins the button's event, a 0 ends it, and what is read is whether it lasts. Nothing of
 * this touches a simulated wire, so it works while the wire is short.
 */
#pragma once

#include "hal/bus/bus.h"
#include "hal/sim/net.h"
#include "hal/sim/words.h"

/* Parse what follows the word `button`, to the end of the line, and add the button to the net. */
void button_parse(struct sim_net *net, struct words *words);

/*
 * The answer to a request for /simulator or for what is below it: err, len, kind and number are
 * filled. False: the request is for something else, or the net has no button. Never blocks; on the
 * thread that runs the net.
 */
bool button_answer(struct sim_net *net, struct bus_req *req, int64_t now,
                   struct bus_answer *answer);
