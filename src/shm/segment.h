/* SPDX-License-Identifier: MIT */
/*
 * The memory under image and commands: POSIX shared memory of an instance, its lock, and waking.
 * owsd's side. Blocking: file-system calls only.
 */
#ifndef SHM_SEGMENT_H
#define SHM_SEGMENT_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum segment_kind { SEGMENT_IMAGE, SEGMENT_COMMAND };

/* Longest instance name; letters, digits, '-', '_', '.', not first a dot. */
#define SEGMENT_NAME_MAX 32
bool segment_name_ok(const char *instance);

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

struct segment {
	char *base;
	size_t size;
	int fd;
	char temporary[80]; /* name until segment_show() */
	enum segment_kind kind;
};

/*
 * Make a segment of size zeroed bytes under a temporary name that nobody can keep from it, all pages
 * allocated (no SIGBUS later when /dev/shm is full: -ENOSPC now). Mode 0640 group owsd, or 0660 group
 * owsd-control, where those groups exist and the caller may give files to them.
 */
int segment_create(const char *instance, enum segment_kind kind, size_t size,
                   struct segment *segment);
/* Put it in place under its final name, in one step; no more if it is there. */
int segment_show(const char *instance, struct segment *segment);
/*
 * False: its final name was removed or leads to another file. What is not in place yet, or cannot be
 * looked at, counts as there.
 */
bool segment_named(const char *instance, const struct segment *segment);
/* Map what an earlier owsd left (writable). -ENOENT none; -EPERM of another user. */
int segment_open_old(const char *instance, enum segment_kind kind, struct segment *segment);
void segment_close(struct segment *segment);
/*
 * What stands behind an error of these functions, as the end of a message: /dev/shm is full, the
 * instance is another user's, or which file is in the way, whose it is and what removes it. Empty
 * where nothing is known. It never advises to remove what a running owsd may hold.
 */
#define SEGMENT_HINT 240
const char *segment_hint(const char *instance, int err, char text[SEGMENT_HINT]);
/* Remove the name (the command segment is left in place at an ordinary end). */
int segment_remove(const char *instance, enum segment_kind kind);

/*
 * Futex on a word that other processes share. Never FUTEX_PRIVATE.
 * segment_wait: sleep while *word == seen, at most timeout_ns (negative: no limit). 0 woken or
 * changed, -ETIMEDOUT, -EINTR, -EFAULT the memory is gone.
 */
int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns);
int segment_wake(const uint32_t *word, int how_many);

/*
 * Guard a mapping against a consumer that truncates its file: a SIGBUS inside it maps private zero
 * pages over it and counts, so that the toucher goes on. One guard at a time per mapping, up to 4.
 */
int segment_guard(struct segment *segment);
void segment_unguard(struct segment *segment);
/* True once the file was truncated, whether or not its memory was touched since. */
bool segment_lost(const struct segment *segment);

#endif
