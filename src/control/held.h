/* SPDX-License-Identifier: MIT */
/* Memories that owsd is done with and somebody else still holds: they count as owsd's memory. */
#ifndef CONTROL_HELD_H
#define CONTROL_HELD_H

#include "src/control/private.h"

/* Free what that user got; if somebody has its memory, it counts as his until nobody has. */
void held_free(struct control *c, uid_t uid, struct control_grant *grant);
/* How many of that user are held now, and their bytes. */
unsigned held_of(struct control *c, uid_t uid, size_t *bytes);
/* Let go of all, at the end. */
void held_forget(struct control *c);

#endif
