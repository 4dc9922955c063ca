/* SPDX-License-Identifier: MIT */
/* The groups: ways to one wire. */
#pragma once

#include "src/daemon/engine/state.h"

int engine_groups_init(struct engine *e, const struct engine_port *ports); /* 0 or -ENOMEM */
void engine_groups_free(struct engine *e);
/* A fact of the lane's way changed: the next engine_route() acts on the group. */
void engine_group_asks(struct lane *lane);
