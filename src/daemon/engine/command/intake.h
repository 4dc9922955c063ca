/* SPDX-License-Identifier: MIT */
/* The memories of controllers: what they have commanded there. */
#pragma once

#include "src/daemon/engine/state.h"

/* Look at all that a connected controller has marked. */
void engine_intake(struct engine *e, uint32_t controller);
/*
 * The same of all controllers, with as many looks as each of them may cost; the rest is left for a
 * later step. Returns when that is due, INT64_MAX: nothing is left.
 */
int64_t engine_intake_limited(struct engine *e);
/* Look at the signal in the memory of the controller that gave its command in force. */
void engine_intake_signal(struct engine *e, struct signal *s);
