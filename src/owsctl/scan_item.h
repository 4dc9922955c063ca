/* SPDX-License-Identifier: MIT */
/* Items of a configuration for devices that were found, under names that nobody has. */
#ifndef OWSCTL_SCAN_ITEM_H
#define OWSCTL_SCAN_ITEM_H

#include "scan.h"

#include "../config/rio.h"
#include "../signal/attribute.h"

/* The names given so far, so that none is given twice. */
struct scan_names {
	char (*name)[SIGNAL_NAME_MAX + 1];
	unsigned count, room;
};

/* Room for so many names. False: no memory. Free with scan_names_free(). */
bool scan_names_init(struct scan_names *names, size_t room);
void scan_names_free(struct scan_names *names);
/* One that is in use already. */
void scan_names_add(struct scan_names *names, const char *name);

/*
 * An item for each property of the device, as its kind says, at the end of the configuration;
 * without outputs if inputs_only. An output that cannot be read is left out, which is said. 0 or a
 * negative errno.
 */
int scan_add_items(struct rio **rio, struct scan_names *names, const struct scan_device *device,
                   bool inputs_only);

/* Would owsd read it? CTL_DONE, or CTL_FAILED after having said that it does not. */
int scan_check(const struct rio *rio, const char *what);

#endif
