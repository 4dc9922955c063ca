/* SPDX-License-Identifier: MIT */
/* What a lane asks its bus next. */
#ifndef ENGINE_ASK_H
#define ENGINE_ASK_H

#include "src/engine/state.h"

/* Submit as much as the order of the lane and the depth of its bus allow. */
void lane_fill(struct lane *lane, int64_t now_ns);
/* A new period: the image shows which readings have outlasted one. */
void lane_show_reads(struct lane *lane);
/* When the lane wants to be filled again though nothing ended; INT64_MAX: not before. */
int64_t lane_wake(const struct lane *lane);

#endif
