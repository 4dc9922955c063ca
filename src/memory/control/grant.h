/* SPDX-License-Identifier: MIT */
/* What a controller gets of a generation: its memory and its rights. */
#pragma once

#include "src/memory/control/private.h"

/* For the controller with that serial. 0 or a negative errno. */
int grant_make(struct control_grant *grant, const struct controller_layout *layout,
               const struct rights *rights, const struct control_seat *seat);
/* An empty grant stays as it is. */
void grant_free(struct control_grant *grant);
