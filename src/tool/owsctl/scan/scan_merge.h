/* SPDX-License-Identifier: MIT */
/* scan --rio --merge FILE: puts the devices that were found into an existing configuration. */
#pragma once

#include "hal/owfs/path.h"
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

/*
 * What a scan means for an existing configuration: which of its devices stay, which are missing,
 * which of those found are new, and which replaces which. Pure functions, without files and buses.
 */

enum merge_fate {
	MERGE_STAYS,    /* in the file, and found */
	MERGE_MISSING,  /* in the file, not found */
	MERGE_NEW,      /* found, not in the file */
	MERGE_REPLACED, /* in the file: replaced by other; found: replaces other */
};

struct merge_device {
	uint8_t rom[ROM_LEN];
	enum merge_fate fate;
	int other; /* replaced: index in the other list */
	/*
	 * missing and new: so many devices of this family are missing, and as many are new; else 0
	 */
	unsigned pairs;
};

/* --replace OLD=NEW */
struct merge_pair {
	uint8_t old_rom[ROM_LEN], new_rom[ROM_LEN];
};

/*
 * Fill in the fates of the devices in the file (known) and of those found; each list has a device
 * once. A device is replaced only where a pair asks for it. Returns NULL; or what is
 * wrong with the first wrong pair: *wrong gets its index, and the lists are then without meaning.
 */
const char *merge_decide(struct merge_device *known, unsigned known_count,
                         struct merge_device *found, unsigned found_count,
                         const struct merge_pair *pairs, unsigned pair_count, unsigned *wrong);
