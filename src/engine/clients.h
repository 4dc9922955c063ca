/* SPDX-License-Identifier: MIT */
/* The heartbeats of control programs, and which commands are in force. */
#ifndef ENGINE_CLIENTS_H
#define ENGINE_CLIENTS_H

#include "src/engine/state.h"

/*
 * At start: what stands in the command segment, and what becomes of what the owsd before has left.
 */
void engine_resume(struct engine *e, int64_t now_ns);
/* The giver did not come back, or the command is lost: SafeValue, else InitValue, else nothing. */
void engine_give_up(struct engine *e, struct signal *s);
/* Look at the heartbeats. */
void engine_clients(struct engine *e, int64_t now_ns);

#endif
