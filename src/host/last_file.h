/* SPDX-License-Identifier: MIT */
/*
 * NAME.last: the commands of outputs with Start "last", as text with a check at its end. A new file
 * takes the place of the old one in one step, and is on the disk by then. Blocking.
 */
#ifndef HOST_LAST_FILE_H
#define HOST_LAST_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/config/config.h"
#include "src/signal/value.h"

struct last_entry {
	const struct config_item *item;
	bool known;
	int64_t value;
	uint32_t len; /* strings */
	char *text;   /* VALUE_STRING_MAX bytes; NULL: it is no string */
};

/* Open the directory of the state, made if it is missing: OWS_STATE_DIR names another. */
#define LAST_WHERE 256
int last_directory(char path[LAST_WHERE]);
/*
 * Fill in the entries that the file has; the others stay as they are. 0, also when there is no
 * file; -EBADMSG: it is damaged, and nothing was filled in.
 */
int last_read(int directory, const char *instance, struct last_entry *entries, uint32_t count);
/* Write all entries that are known. 0 or a negative errno; then the old file stands. */
int last_write(int directory, const char *instance, const struct last_entry *entries,
               uint32_t count);

#endif
