/* SPDX-License-Identifier: MIT */
/* scan --rio --merge FILE: puts the devices that were found into an existing configuration. */
#pragma once

#include "src/config/read/rio.h"
#include "src/tool/owsctl/scan/scan_item.h"
#include "src/tool/scan/device.h"

#define SCAN_PAIRS 64

struct scan_merge {
	const char *file;             /* NULL: there is no file to merge into */
	const char *pair[SCAN_PAIRS]; /* OLD=NEW as the user wrote it */
	unsigned pair_count;
	struct rio *rio;
};

/* Read the file, before a target is asked. CTL_DONE; or the status, after printing why. */
int scan_merge_open(struct scan_merge *merge);
/*
 * Print the configuration: the whole file byte for byte, except for the paths of replaced devices,
 * and at its end items for new devices. What is new, missing and replaced goes to stderr. CTL_DONE;
 * or the status, after printing why, and then stdout got nothing.
 */
int scan_merge(struct scan_merge *merge, const struct scan *scan, struct scan_choice choice);
void scan_merge_close(struct scan_merge *merge);
