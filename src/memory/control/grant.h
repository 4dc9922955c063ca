/* SPDX-License-Identifier: MIT */
/* What a controller gets of a generation: its memory and its rights. */
#pragma once

#include "src/memory/control/private.h"

/* For the controller with that serial. 0 or a negative errno. */
int grant_make(struct control_grant *grant, const struct controller_layout *layout,
               const struct rights *rights, const struct control_seat *seat);
/* An empty grant stays as it is. */
void grant_free(struct control_grant *grant);
/*
 * Has such a memory no pages any more? owsd itself asks for nothing more of a memory that a
 * controller has had: one that writes to the file out of memory that never comes holds its inode's
 * lock for ever, and a process that empties the file waits for it, even against SIGKILL.
 */
bool grant_is_empty(int own);
