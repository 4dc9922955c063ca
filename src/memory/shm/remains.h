/* SPDX-License-Identifier: MIT */
/* Files that owsds have left in a directory: lists the instances, removes one that has ended. */
#pragma once

#include "src/memory/shm/segment.h"

struct remains {
	char (*name)[SEGMENT_NAME_MAX + 1]; /* in the order of their letters, each once */
	unsigned count;
};

/* List all instances that have a file there. 0, -ENOMEM, or the error of reading the directory. */
int remains_list(const struct shm_dir *dir, struct remains *remains);
void remains_free(struct remains *remains);

/*
 * Remove all files of an instance; *files gets their number. -EBUSY: an owsd runs, *pid is its
 * process; -ENOENT: there is no file; -EACCES or -EPERM: the files belong to another user;
 * -ENOTEMPTY: one of the names is a directory with files. Afterwards the instance is as if it had
 * never run. Judges by the lock alone: the caller has to check that no owsd runs without it.
 */
int remains_remove(const struct shm_dir *dir, const char *instance, pid_t *pid, unsigned *files);
