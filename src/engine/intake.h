/* SPDX-License-Identifier: MIT */
/* The command segment: what programs have set there. */
#ifndef ENGINE_INTAKE_H
#define ENGINE_INTAKE_H

#include "src/engine/state.h"

/* Look at all that is marked. */
void engine_intake(struct engine *e, int64_t now_ns);
/*
 * The same, with as many looks as programs that mark slots without end may cost; the rest is left
 * for a later step. Returns when that is due, INT64_MAX: nothing is left.
 */
int64_t engine_intake_limited(struct engine *e, int64_t now_ns);
void engine_intake_signal(struct engine *e, struct signal *s, int64_t now_ns);

#endif
