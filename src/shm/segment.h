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
/* Remove the name (the command segment is left in place at an ordinary end). */
int segment_remove(const char *instance, enum segment_kind kind);

/*
 * Guard a mapping against a consumer that truncates its file: a SIGBUS inside it maps private zero
 * pages over it and counts, so that the toucher goes on. One guard at a time per mapping, up to 4.
 */
int segment_guard(struct segment *segment);
void segment_unguard(struct segment *segment);
/* True once the file was truncated, whether or not its memory was touched since. */
bool segment_lost(const struct segment *segment);

#endif
