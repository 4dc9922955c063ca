/* SPDX-License-Identifier: MIT */
/* The groups: ways to one wire. */
#ifndef ENGINE_GROUP_H
#define ENGINE_GROUP_H

#include "src/engine/state.h"

int engine_groups_init(struct engine *e, const struct engine_port *ports); /* 0 or -ENOMEM */
void engine_groups_free(struct engine *e);

#endif
