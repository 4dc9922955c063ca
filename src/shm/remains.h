/* SPDX-License-Identifier: MIT */
/* What owsds have left in /dev/shm: which instances there are, and removing one that ended. */
#ifndef SHM_REMAINS_H
#define SHM_REMAINS_H

#include "src/shm/segment.h"

struct remains {
	char (*name)[SEGMENT_NAME_MAX + 1]; /* in the order of their letters, each once */
	unsigned count;
};

/* All instances that have a file there. 0, -ENOMEM, or the error of reading the directory. */
int remains_list(struct remains *remains);
void remains_free(struct remains *remains);

/*
 * Remove all files of an instance; how many in *files. -EBUSY: an owsd runs, its process in *pid;
 * -ENOENT: there is nothing; -EACCES or -EPERM: they belong to another user; -ENOTEMPTY: under one of
 * the names is a directory with files. Afterwards the instance is as if it had never run. Judges by
 * the lock alone: the caller has to look whether an owsd runs without it.
 */
int remains_remove(const char *instance, pid_t *pid, unsigned *files);

#endif
