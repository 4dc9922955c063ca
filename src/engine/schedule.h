/* SPDX-License-Identifier: MIT */
/* When the rows of the table are read and written. */
#ifndef ENGINE_SCHEDULE_H
#define ENGINE_SCHEDULE_H

#include "src/engine/state.h"

void engine_read_now(struct engine *e, struct signal *s);
void engine_read_at(struct engine *e, struct signal *s, uint64_t period);
void engine_read_never(struct engine *e, struct signal *s);
void engine_write_at(struct engine *e, struct signal *s, uint64_t period);
/* Put the row among those to be written, or take it away, by signal_changed(). */
void engine_write_check(struct engine *e, struct signal *s);
/* Each call from outside begins with it: it keeps the time, and notices when nobody ran. */
void engine_begin_call(struct engine *e, int64_t now_ns);
/* Turn to the period of now_ns: what waited for it becomes due. */
void engine_turn(struct engine *e, int64_t now_ns);

#endif
