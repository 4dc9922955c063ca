/* SPDX-License-Identifier: MIT */
/* What a lane asks its bus next. */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * Nothing is lent, nothing is there that lane_fill() could ask, and time alone brings nothing: most
 * lanes of many, at most steps.
 */
static inline bool lane_rests(const struct lane *lane)
{
	return !lane->lent.count && !lane->inputs.count && !lane->outputs.count &&
	       !lane->probes.count && !lane->watch.count && !lane->guests.first &&
	       lane->alarm.state == NOT_USED;
}

/* Submit as much as the order of the lane and the depth of its bus allow. */
void lane_fill(struct lane *lane);
/* A new period: the image shows which readings have outlasted one. */
void lane_show_reads(struct lane *lane);
/* When the lane wants to be filled again though nothing ended; INT64_MAX: not before. */
int64_t lane_wake(const struct lane *lane);
