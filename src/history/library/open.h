/* SPDX-License-Identifier: MIT */
/* What the calls of the library share: their limit, and which ids are of a time. */
#pragma once

#include "src/history/library/handle.h"

/*
 * A call begins. When it has taken as much of the processor as a file of that size can need, it
 * gets -ETIMEDOUT.
 */
void open_allow(struct ows_history *h);
/* The ids of a run that are between two times. False: none. Pure. */
bool handle_range(const struct session *session, int64_t from_us, int64_t until_us, int64_t *first,
                  int64_t *end);
