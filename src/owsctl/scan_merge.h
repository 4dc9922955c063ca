/* SPDX-License-Identifier: MIT */
/* scan --rio --merge FILE: what was found, put into a configuration that is there. */
#ifndef OWSCTL_SCAN_MERGE_H
#define OWSCTL_SCAN_MERGE_H

#include "src/config/rio.h"
#include "src/owsctl/scan_device.h"

#define SCAN_PAIRS 64

struct scan_merge {
	const char *file;             /* NULL: nothing is to be merged */
	const char *pair[SCAN_PAIRS]; /* OLD=NEW, as given */
	unsigned pair_count;
	struct rio *rio;
};

/* Read the file, before a target is asked. CTL_DONE; or the status, after the reason. */
int scan_merge_open(struct scan_merge *merge);
/*
 * Print the configuration: all of the file byte for byte, but for the paths of devices that are
 * replaced, and items for those that are new at its end. What is new, missing and replaced goes to
 * stderr. CTL_DONE; or the status, after the reason, and then nothing was printed.
 */
int scan_merge(struct scan_merge *merge, const struct scan *scan, bool inputs_only);
void scan_merge_close(struct scan_merge *merge);

#endif
