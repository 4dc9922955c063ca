/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_REPLACE_H
#define CONFIG_REPLACE_H

#include <stddef.h>

/*
 * Put len bytes in the place of file in one step, keeping its owner and mode; the target of a
 * symbolic link is replaced, not the link. A file that is not there is made. 0 or a negative
 * errno; file is then as it was. Blocking.
 */
int replace_file(const char *file, const char *text, size_t len);

/*
 * Lock file against replacement by other processes; it need not exist. The lock lasts until the
 * returned descriptor is closed. -EBUSY: another process held the lock for five seconds; or another
 * negative errno.
 */
int replace_lock(const char *file);

#endif
