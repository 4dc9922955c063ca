/* SPDX-License-Identifier: MIT */
/* What is lent and counts for nothing any more. */
#pragma once

#include "src/engine/state.h"

/*
 * Requests in flight whose signals another lane serves now (all: every one of them) count for
 * nothing but their slots any more.
 */
void lane_disown(struct lane *lane, bool all);
/* The request of the alarm machine counts for nothing either; the machine begins anew. */
void lane_disown_alarm(struct lane *lane);

/*
 * The readings that are in flight when a reload begins (keep, before all is disowned); those whose
 * signals stay in this lane go on here (resume, when its signals are known).
 */
void lane_keep_reads(struct lane *lane);
void lane_resume_reads(struct lane *lane);
/*
 * A reload: this lane, which was never filled, goes on where `before` of another engine stands.
 * What is lent comes over and counts for nothing but its slots, and for outputs that it may still
 * reach, until readings are resumed: successors[row] is that row here, TABLE_NO_ROW: it has none.
 */
void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors);
