/* SPDX-License-Identifier: MIT */
/* The limit alarms of the signals. */
#ifndef ENGINE_LIMITS_H
#define ENGINE_LIMITS_H

#include "src/engine/state.h"

/* Bring the limit alarms of the signal to the present. */
void engine_limits(struct engine *e, struct signal *s);
void engine_limits_acknowledge(struct engine *e, struct signal *s);

#endif
