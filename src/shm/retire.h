/* SPDX-License-Identifier: MIT */
/*
 * The segments of an owsd of layout 1, which were in /dev/shm: programs with its library go on with
 * them, and would set outputs into the void. Blocking: file-system calls only.
 */
#ifndef SHM_RETIRE_H
#define SHM_RETIRE_H

#include <sys/types.h>

#define RETIRE_FOLDER "/dev/shm"

/*
 * The process of an owsd of layout 1 that serves the instance now, 0: none, or not to be seen by
 * this user. Believes only a lock's file that others than root, owsd and the caller cannot lock.
 */
pid_t retire_running(const char *folder, const char *instance);
/*
 * Mark both segments as those of an owsd that has ended, wake the programs that wait there, and
 * leave in place of each a stub of 256 bytes with the present major number: such programs have no
 * good value from then on, their sets and waits return -ESTALE, opening returns -EPROTO. Touches
 * only regular files of root, of owsd or of the caller, and no memory of them. Returns how many
 * were retired, or a negative errno.
 */
int retire_segments(const char *folder, const char *instance);

#endif
