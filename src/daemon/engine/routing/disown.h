/* SPDX-License-Identifier: MIT */
/* What is lent and counts for nothing any more. */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * Requests in flight for signals that another lane serves now (all: every request of the table)
 * count for nothing but their slots any more.
 */
void lane_disown(struct lane *lane, bool all);
/* The request of the alarm machine counts for nothing either; the machine begins anew. */
void lane_disown_alarm(struct lane *lane);

/*
 * keep: mark the readings in flight when a reload begins, before all is disowned. resume: those for
 * signals that stay in this lane go on here, when its signals are known.
 */
void lane_keep_reads(struct lane *lane);
void lane_resume_reads(struct lane *lane);
/*
 * A reload: this lane, which was never filled, goes on where `before` of another engine stands.
 * What is lent comes over and counts for nothing but its slots, and for outputs that it may still
 * reach, until readings are resumed: successors[row] is that row here, TABLE_NO_ROW: it has none.
 */
void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors);
