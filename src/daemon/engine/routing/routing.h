/* SPDX-License-Identifier: MIT */
/* The one place that acts on what is known of ways and devices. */
#pragma once

#include "src/daemon/engine/state.h"

int engine_groups_init(struct engine *e, const struct engine_port *ports); /* 0 or -ENOMEM */
void engine_groups_free(struct engine *e);

/*
 * Act on what became known, of groups that ask for it and of devices. Not inside an answer's work.
 * True: there was something; time alone may lead to more, which engine_route_groups() says.
 */
bool engine_route(struct engine *e);
/* All groups, for time may lead to a step too; returns when to be called again. */
int64_t engine_route_groups(struct engine *e);
