/* SPDX-License-Identifier: MIT */
/*
 * What survives an end of owsd-notify: the journal of owsd has what waits, and a file up to where
 * people were told of it.
 */
#pragma once

#include <stdint.h>

#include "src/ground/text/log.h"
#include "src/history/file/place.h"

struct kept {
	char path[HISTORY_PATH + 16]; /* "": there is no place for it */
	int64_t boot, told_ns, looked_ns, at_ns;
	int lock; /* of the directory; below 0: none */
};

/*
 * Find the file, and what it has: entries up to *told_ns were told, alarms up to *looked_ns looked
 * at for escalation. 0: it is of another boot, or cannot be read, which is logged. There is none:
 * both stay. 0, or -EBUSY: another owsd-notify keeps the file. A directory that cannot be written
 * is no error; it is locked when it can be.
 */
int kept_open(struct kept *kept, struct log *log, const char *program, const char *instance,
              int64_t now_ns, int64_t *told_ns, int64_t *looked_ns);
/* Write what has changed, once a second at most. Logs an error, and tries again after an hour. */
void kept_write(struct kept *kept, struct log *log, int64_t told_ns, int64_t looked_ns,
                int64_t now_ns);
void kept_close(struct kept *kept);
