/* SPDX-License-Identifier: MIT */
/* Makes items of a configuration for devices that were found, with names that are free. */
#pragma once

#include <search.h>
#include <stdio.h>

#include "src/config/read/rio.h"
#include "src/ground/signal/attribute.h"
#include "src/tool/scan/device.h"

#define SCAN_WORDS 64
#define SCAN_BITS 8 /* of a byte, at most */

/* What is made of the devices. */
struct scan_choice {
	bool inputs_only;
	bool bits;          /* an item for each switch of a chip, and not one for all */
	bool noted;         /* what gets no item becomes a comment of the configuration */
	const char *target; /* that commands which are shown have to name; NULL: none */
};

/* The names in use, so that no name is given twice, and the items that were made. */
struct scan_names {
	char (*name)[SIGNAL_NAME_MAX + 1];
	unsigned count, room;
	struct hsearch_data used;
	struct scan_word {
		char word[24];
		unsigned last; /* the last number given for the word */
	} word[SCAN_WORDS];
	FILE *items;
	char *text;
	size_t len;
};

/* Make room for so many names. Free with scan_names_free(). */
void scan_names_init(struct scan_names *names, size_t room);
void scan_names_free(struct scan_names *names);
/* So many items the devices make at most: each bit one. */
size_t scan_items_most(const struct scan *scan);
/* Add a name that is in use already. */
void scan_names_add(struct scan_names *names, const char *name);

/*
 * Make an item for each property of the device's kind, as was chosen; false: none was made. What
 * the device measures or switches and gets no item is printed, with the command that shows what the
 * device has.
 */
bool scan_make_items(struct scan_names *names, const struct scan_device *device,
                     struct scan_choice choice);
/* Add all items that were made at the end of the configuration, once. 0 or a negative errno. */
int scan_add_items(struct rio **rio, struct scan_names *names);

/* Would owsd accept the configuration? CTL_DONE, or CTL_FAILED after printing why not. */
int scan_check(const struct rio *rio, const char *what);
