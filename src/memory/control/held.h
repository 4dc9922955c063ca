/* SPDX-License-Identifier: MIT */
/* Memories that owsd is done with: they count as their user's until they are empty. */
#pragma once

#include "src/memory/control/private.h"

void held_open(struct control *c);
/*
 * Free what that user got; its memory counts as the user's until it is empty. reload: its
 * controller goes on, and gets another.
 */
void held_free(struct control *c, uid_t uid, struct control_grant *grant, bool reload);
/* Have memories emptied, and let go of those that are. */
void held_look(struct control *c);
/* There is no room for more controllers. */
bool held_full(const struct control *c);
/* How many of that user are held now, and their bytes. */
unsigned held_of(const struct control *c, uid_t uid, size_t *bytes);
/* Let go of all, at the end. */
void held_forget(struct control *c);
