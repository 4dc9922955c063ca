/* SPDX-License-Identifier: MIT */
/* The end of a read or a write. */
#pragma once

#include "src/daemon/engine/state.h"

void engine_read_done(struct engine *e, struct lane *lane, const struct slot *slot,
                      const struct bus_answer *answer);
void engine_write_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer);
/*
 * The value of a read into the table; 0, or why it cannot be one (counted as item error). *wait_ns
 * is the back-off, 0: none.
 */
int engine_apply_reading(struct engine *e, struct lane *lane, struct signal *s,
                         const struct slot *slot, const struct bus_answer *answer,
                         int64_t *wait_ns);
/* When it is read again, after a good reading. */
void engine_read_next(struct engine *e, struct lane *lane, struct signal *s,
                      const struct slot *slot);
/*
 * An item error of a read, or of a request of the alarm machine that counts as one. Returns the
 * back-off, 0: again in its next turn.
 */
int64_t engine_read_failed(struct engine *e, struct lane *lane, struct signal *s, int err);
