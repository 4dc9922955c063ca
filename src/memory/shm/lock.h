/* SPDX-License-Identifier: MIT */
/* The lock of an instance: one owsd for each name. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

#include "src/memory/shm/dir.h"

/*
 * Take the lock of the instance: one owsd for each name. Returns a descriptor to keep, or -EBUSY
 * (*pid gets the owner's number), -EACCES, -EPERM (a file of another user is in the way), another
 * negative errno. The lock of a corpse is replaced and *stolen set.
 */
int segment_lock(const struct shm_dir *dir, const char *instance, pid_t *pid, bool *stolen);
/*
 * Does a process hold the lock of the instance? 1 yes, with its number in *pid; 0 no, or only a
 * corpse, with the number of the last holder; -ENOENT: there is no lock; -EACCES: the lock belongs
 * to another user; -EPERM: no process holds the lock, and its file is not that of a trusted owner.
 * Does not take the lock.
 */
int segment_lock_look(const struct shm_dir *dir, const char *instance, pid_t *pid);
/*
 * Take the lock that exists, of any owner, so that the files of the instance can be
 * removed. Returns a descriptor; -ENOENT: there is no lock; -EBUSY: an owsd runs; -EACCES; -EPERM:
 * the lock is no regular file.
 */
int segment_lock_any(const struct shm_dir *dir, const char *instance, pid_t *pid);
/* False: the lock's file was removed or replaced. True also where that cannot be found out. */
bool segment_lock_held(const struct shm_dir *dir, int lock, const char *instance);
