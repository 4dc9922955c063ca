/* SPDX-License-Identifier: MIT */
/*
 * What a scan means for an existing configuration: which of its devices stay, which are missing,
 * which of those found are new, and which replaces which. Pure functions, without files and buses.
 */
#pragma once

#include "hal/owfs/path.h"

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
