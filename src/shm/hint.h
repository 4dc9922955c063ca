/* SPDX-License-Identifier: MIT */
/* The cause of an error of /dev/shm, for the log: /dev/shm is full, or a file is in the way. */
#ifndef SHM_HINT_H
#define SHM_HINT_H

/*
 * What stands behind an error of a function of this room, as the end of a message: /dev/shm is
 * full, the instance is another user's, or which file is in the way, whose it is and what removes
 * it. Empty where nothing is known. It never advises to remove what a running owsd may hold.
 */
#define SEGMENT_HINT 240
const char *segment_hint(const char *instance, int err, char text[SEGMENT_HINT]);

#endif
