/* SPDX-License-Identifier: MIT */
/* A device of a configuration replaced by another of its family. */
#pragma once

#include "hal/owfs/path.h"
#include "src/config/read/rio.h"

/*
 * Put the device after in the place of before, in the paths of all items that have it: in the
 * format in which the old id stands there. An item without Identity gets the one that it has, so
 * that its history goes on; names and all else stay. location: the "bus.1" of the
 * new device, for paths that have one; "": they keep theirs. 0, -EINVAL (reported: no item has the
 * old one, or more than EDIT_REPLACE_MAX have it; an item has the new one; they are of different
 * families), -ENOMEM or -EFBIG.
 */
#define EDIT_REPLACE_MAX 256 /* each reads the whole text again */
int edit_replace(struct rio **rio, const uint8_t before[ROM_LEN], const uint8_t after[ROM_LEN],
                 const char *location, struct config_report *report);
