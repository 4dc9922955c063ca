/* SPDX-License-Identifier: MIT */
/* A lane: the engine's side of one bus. */
#pragma once

#include "src/daemon/engine/state.h"

/* Room for every row of the table; 0 or -ENOMEM. */
int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index);
void lane_free(struct lane *lane);

/* The lane serves the row from now on, no longer: rows that are due, writers. */
void lane_take_row(struct lane *lane, uint32_t row);
void lane_drop_row(struct lane *lane, uint32_t row);
