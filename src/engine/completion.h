/* SPDX-License-Identifier: MIT */
/* The end of a read or a write. */
#pragma once

#include "src/engine/state.h"

void engine_read_done(struct engine *e, struct lane *lane, const struct slot *slot,
                      const struct bus_answer *answer, int64_t now_ns);
void engine_write_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer, int64_t now_ns);
/*
 * The value of a read into the table; 0, or why it cannot be one (counted as item error). *wait_ns
 * is the back-off, 0: none.
 */
int engine_take_reading(struct engine *e, struct lane *lane, struct signal *s,
                        const struct slot *slot, const struct bus_answer *answer, int64_t now_ns,
                        int64_t *wait_ns);
/* A request of the alarm machine for this item failed: that counts as a failed read. */
void engine_alarm_failed(struct engine *e, struct lane *lane, const struct alarm_item *item,
                         int err);
