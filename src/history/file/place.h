/* SPDX-License-Identifier: MIT */
/* Where the history of an instance is kept if no Directory is given. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define HISTORY_PATH 256

/*
 * Where a recorder of this user keeps it: the service's directory for root and for a user without
 * a home (STATE_DIRECTORY of systemd.exec(5) names it, if it is set), which is the recorder's own,
 * as that of owsd belongs to another user; else owsd/history below XDG_STATE_HOME or
 * ~/.local/state. -ENAMETOOLONG.
 */
int history_place(const char *instance, char path[HISTORY_PATH]);
/* The same of another program ("owsd-influx") with something else ("influx") to keep. */
int history_place_state(const char *program, const char *what, const char *instance,
                        char path[HISTORY_PATH]);
/*
 * Where a reader finds it: there, or if that is missing in the service's directory. A reader may be
 * a service too: STATE_DIRECTORY is its own then, and does not count.
 */
int history_place_found(const char *instance, char path[HISTORY_PATH]);
int history_place_state_found(const char *program, const char *what, const char *instance,
                              char path[HISTORY_PATH]);
/* Make the directories above path, mode 0750, as far as they are missing. 0 or a negative errno. */
int history_make_above(const char *path);
/*
 * Lock a directory by a file in it that nobody else may open: another program that locks it there
 * too gets -EBUSY. Returns the lock's descriptor, whose closing frees it, or a negative errno.
 */
int history_lock(const char *directory);

/* The boot that this machine is in. */

/* A hash of the kernel's boot id, never 0; of "" where it cannot be read. A system call. */
int64_t history_boot_present(void);
