/* SPDX-License-Identifier: MIT */
/* What is too old, or too much, is deleted: a part with each commit, so that none takes long. */
#pragma once

#include <sqlite3.h>
#include <stdint.h>

struct history_keep {
	uint32_t days, minutes,
		hours;  /* values, sums by the minute and the hour; days, 0: for ever */
	uint64_t bytes; /* the oldest is deleted beyond that; 0: no limit */
	uint64_t spare; /* and with less left on the disk, all but 7 days; 0: no limit */
};

/* Within a commit; last_id is the newest in the file. 0 or a negative errno. */
int keep_delete(const struct history_keep *keep, sqlite3 *db, const char *directory,
                int64_t last_id);
