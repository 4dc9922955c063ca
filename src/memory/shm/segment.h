/* SPDX-License-Identifier: MIT */
/*
 * The memory under image and commands, owsd's side: the mapped files of an instance. Blocking:
 * file-system calls only.
 *
 * Room src/memory/shm: the segments in shared memory, the side of owsd.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "src/memory/shm/dir.h"

/* NAME.image, and NAME.force, which only owsd itself may open. */
enum segment_kind { SEGMENT_IMAGE, SEGMENT_FORCE };

/* The longest name of an instance: letters, digits, '-', '_', '.', and no dot at the beginning. */
#define SEGMENT_NAME_MAX 32
#define SEGMENT_NAME_WANTED "1 to 32 letters, digits, '-', '_', '.' expected, not first a dot"
bool segment_name_ok(const char *instance);
/* The name of an instance's file in its place: "OWS.image". */
#define SEGMENT_FILE (SEGMENT_NAME_MAX + 16)
const char *segment_file(const char *instance, const char *what, char name[SEGMENT_FILE]);

/*
 * Does the name in that directory lead to the open file fd? True also where that cannot be found
 * out.
 */
bool segment_leads_to(int directory, const char *name, int fd);
/* Have the file system give all pages of the file now. 0 or a negative errno. */
int segment_allocate(int fd, size_t size);

struct segment {
	char *base;
	size_t size;
	int fd;
	int dir;                      /* the descriptor of its directory */
	char temporary[SEGMENT_FILE]; /* name until segment_show() */
	enum segment_kind kind;
};

/*
 * Make a segment of size zeroed bytes under a temporary name, with all pages allocated (-ENOSPC now
 * instead of a SIGBUS later when the file system is full). The directory stays open as long as the
 * segment. Mode 0640 group owsd where that group exists and the caller may give files to it;
 * else 0600.
 */
int segment_create(const struct shm_dir *dir, const char *instance, enum segment_kind kind,
                   size_t size, struct segment *segment);
/* Rename the segment to its final name, in one step; does nothing if it has that name already. */
int segment_show(const char *instance, struct segment *segment);
/*
 * False: the final name was removed or leads to another file. True also for a segment that has no
 * final name yet, and where that cannot be found out.
 */
bool segment_named(const char *instance, const struct segment *segment);
/* Map a segment that an earlier owsd left, writable. -ENOENT: none; -EPERM: another user's. */
int segment_open_old(const struct shm_dir *dir, const char *instance, enum segment_kind kind,
                     struct segment *segment);
void segment_close(struct segment *segment);
