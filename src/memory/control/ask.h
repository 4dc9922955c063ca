/* SPDX-License-Identifier: MIT */
/* Programs that ask for a reload: they wait at a place of the room, and are no controllers. */
#pragma once

#include "src/memory/control/private.h"

/* The program of the seat waits from here on. 0; -ENOSPC: too many wait. */
int ask_begin(struct control *c, struct control_seat *p, const struct ows_hello *hello);
/* Does the program of the seat wait for a reload? */
bool ask_waits(const struct control_seat *p);
/* Send what came of it, with the words of control_answer(); the caller hangs up. Never blocks. */
void ask_answer(const struct control *c, const struct control_seat *p, int err, const char *why);
