/* SPDX-License-Identifier: MIT */
/* The cause of an error of the directory, for the log: it is full, or a file is in the way. */
#pragma once

#include "src/memory/shm/dir.h"

/*
 * What stands behind an error of a function of this room, as the end of a message: the directory is
 * full, the instance is another user's, or which file is in the way, its owner and what removes
 * it. Empty where nothing is known. It never advises to remove what a running owsd may hold.
 */
#define SEGMENT_HINT (DIR_PATH + 160)
const char *segment_hint(const struct shm_dir *dir, const char *instance, int err,
                         char text[SEGMENT_HINT]);
