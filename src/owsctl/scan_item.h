/* SPDX-License-Identifier: MIT */
/* Items of a configuration for devices that were found, under names that nobody has. */
#ifndef OWSCTL_SCAN_ITEM_H
#define OWSCTL_SCAN_ITEM_H

#include <stdio.h>

#include "src/config/rio.h"
#include "src/owsctl/scan_device.h"
#include "src/signal/attribute.h"

#define SCAN_WORDS 32

/* The names given so far, so that none is given twice, and the items that were made for them. */
struct scan_names {
	char (*name)[SIGNAL_NAME_MAX + 1];
	unsigned count, room;
	unsigned *place; /* by hash of the name: its number + 1, 0 free */
	unsigned places; /* a power of two */
	struct scan_word {
		const char *word;
		unsigned last; /* the number given last */
	} word[SCAN_WORDS];
	FILE *items;
	char *text;
	size_t len;
};

/* Room for so many names. False: no memory. In any case free with scan_names_free(). */
bool scan_names_init(struct scan_names *names, size_t room);
void scan_names_free(struct scan_names *names);
/* One that is in use already. */
void scan_names_add(struct scan_names *names, const char *name);

/*
 * Make an item for each property of the device, as its kind says; without outputs if inputs_only. An
 * output that cannot be read is left out, which is said.
 */
void scan_make_items(struct scan_names *names, const struct scan_device *device, bool inputs_only);
/* Add all that were made at the end of the configuration, once. 0 or a negative errno. */
int scan_add_items(struct rio **rio, struct scan_names *names);

/* Would owsd read it? CTL_DONE, or CTL_FAILED after having said that it does not. */
int scan_check(const struct rio *rio, const char *what);

#endif
