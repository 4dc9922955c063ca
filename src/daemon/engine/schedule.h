/* SPDX-License-Identifier: MIT */
/* When the rows of the table are read and written. */
#pragma once

#include "src/daemon/engine/state.h"

void engine_read_now(struct engine *e, struct signal *s);
void engine_read_at(struct engine *e, struct signal *s, uint64_t period);
/* Past the caches, whether it is read else or not, and not twice in a period. */
void engine_read_once(struct engine *e, struct signal *s);
void engine_read_never(struct engine *e, struct signal *s);
/* Periods between two readings in the cycle. */
uint64_t engine_reads_apart(const struct engine *e, const struct lane *lane,
                            const struct signal *s);
/* When an output that is not read in the cycle is read back next, as a period. */
uint64_t engine_read_back_at(const struct engine *e, const struct signal *s);
void engine_write_at(struct engine *e, struct signal *s, uint64_t period);
/* Put the row among those to be written, or take it away, by signal_changed(). */
void engine_write_check(struct engine *e, struct signal *s);
/* Each call from outside begins with it: it sets the time, and notices a time of no calls. */
void engine_begin_call(struct engine *e, int64_t now_ns);
/*
 * Go on to the present period, and call ready() for all that waited for it in the wheel. False: it
 * is the same as before.
 */
bool engine_tick(struct engine *e, due_ready *ready);
/* The row has waited for that. */
void engine_row_due(struct engine *e, struct signal *s, enum row_wait wait);
/*
 * When the next tick is: the beginning of the first period for which a row waits. It is at most
 * at_most_ns (whole periods of it, but one at least) after the beginning of the present period.
 */
int64_t engine_next_tick(const struct engine *e, int64_t at_most_ns);
