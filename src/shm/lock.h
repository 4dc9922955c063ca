/* SPDX-License-Identifier: MIT */
/* The lock of an instance: one owsd for each name. */
#ifndef SHM_LOCK_H
#define SHM_LOCK_H

#include <stdbool.h>
#include <sys/types.h>

/*
 * Take the instance: one owsd for each name. Returns a descriptor to keep, or -EBUSY (*pid gets the
 * owner's), -EACCES, -EPERM (a file of another user is in the way), other errno. A corpse's lock (a
 * process that cannot die while stuck in the kernel) is left behind and *stolen set.
 */
int segment_lock(const char *instance, pid_t *pid, bool *stolen);
/*
 * Does a process hold the lock of the instance? 1 yes, with its number in *pid; 0 no, also where it
 * is a corpse, with the number of the last holder; -ENOENT: there is none; -EACCES: it belongs to
 * another user; -EPERM: nobody holds it, and no owsd whose image we read made it. Takes nothing.
 */
int segment_lock_look(const char *instance, pid_t *pid);
/*
 * Take the lock that is there, whoever's file it is, so that what the instance left can be removed.
 * A descriptor; -ENOENT none is there; -EBUSY an owsd runs; -EACCES; -EPERM what is there is no file.
 */
int segment_lock_any(const char *instance, pid_t *pid);
/* False: the lock's file was removed or replaced. What cannot be looked at counts as there. */
bool segment_lock_held(int lock, const char *instance);

#endif
