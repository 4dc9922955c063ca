/* SPDX-License-Identifier: MIT */
/*
 * The file NAME.last on the disk: what it holds, and a check of all of it at its end. A new file
 * takes the place of the old one in one step, and is on the disk by then. Blocking.
 */
#pragma once

#include <stddef.h>

/* Open the directory of the state, made if it is missing: OWS_STATE_DIR names another. */
#define LAST_WHERE 256
int last_directory(char path[LAST_WHERE]);
/*
 * The longest file, with its check; 65535 strings with the longest texts, names and paths take
 * less.
 */
#define LAST_MAX ((size_t)512 << 20)
/*
 * Read the file into allocated memory; *data gets NULL if there is none. 0 or a negative errno;
 * -EBADMSG: it is damaged.
 */
int last_read(int directory, const char *instance, char **data, size_t *size);
/*
 * Write the file; data has room for LAST_CHECK bytes after it. 0 or a negative errno; then the old
 * file stands. -EFBIG: longer than LAST_MAX, so that last_read() would refuse it.
 */
#define LAST_CHECK 4
int last_write(int directory, const char *instance, char *data, size_t size);
