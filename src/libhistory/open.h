/* SPDX-License-Identifier: MIT */
/* Which ids of a run are of a time of the wall clock. */
#pragma once

#include "src/libhistory/handle.h"

/* The ids of a run that are between two times. False: none. Pure. */
bool handle_range(const struct session *session, int64_t from_us, int64_t until_us, int64_t *first,
                  int64_t *end);
