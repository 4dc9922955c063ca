/* SPDX-License-Identifier: MIT */
/*
 * The memory under image and commands, owsd's side: POSIX shared memory of an instance, the lock of
 * the instance, waiting and waking. Blocking: file-system calls only.
 *
 * Room src/shm: the segments in shared memory, the side of owsd. Uses hal/bus.
 */
#ifndef SHM_SEGMENT_H
#define SHM_SEGMENT_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum segment_kind { SEGMENT_IMAGE, SEGMENT_COMMAND };

/* The longest name of an instance: letters, digits, '-', '_', '.', and no dot at the beginning. */
#define SEGMENT_NAME_MAX 32
bool segment_name_ok(const char *instance);

struct segment {
	char *base;
	size_t size;
	int fd;
	char temporary[80]; /* name until segment_show() */
	enum segment_kind kind;
};

/*
 * Make a segment of size zeroed bytes under a temporary name that no other user can block, with all
 * pages allocated (-ENOSPC now instead of a SIGBUS later when /dev/shm is full). Mode 0640 group
 * owsd, or 0660 group owsd-control, where those groups exist and the caller may give files to them.
 */
int segment_create(const char *instance, enum segment_kind kind, size_t size,
                   struct segment *segment);
/* Rename the segment to its final name, in one step; does nothing if it has that name already. */
int segment_show(const char *instance, struct segment *segment);
/*
 * False: the final name was removed or leads to another file. True also for a segment that has no
 * final name yet, and where that cannot be found out.
 */
bool segment_named(const char *instance, const struct segment *segment);
/* Map a segment that an earlier owsd left, writable. -ENOENT: none; -EPERM: another user's. */
int segment_open_old(const char *instance, enum segment_kind kind, struct segment *segment);
void segment_close(struct segment *segment);
/* Remove the name (the command segment is left in place at an ordinary end). */
int segment_remove(const char *instance, enum segment_kind kind);

/*
 * Guard a mapping against a consumer that truncates its file: on a SIGBUS inside the mapping
 * private zero pages replace it, and the thread that touched it goes on. One guard for each
 * mapping, up to 4.
 */
int segment_guard(struct segment *segment);
void segment_unguard(struct segment *segment);
/* True once the file was truncated, whether or not its memory was touched since. */
bool segment_lost(const struct segment *segment);

#endif
