/* SPDX-License-Identifier: MIT */
#pragma once

#include <limits.h>
#include <stddef.h>

struct stat;

/* Write all of a text and sync it. 0 or a negative errno. Blocking. */
int replace_write(int fd, const char *text, size_t len);

/*
 * Put len bytes in the place of file in one step, keeping its owner and mode; the target of a
 * symbolic link is replaced, not the link. A file that is not there is made. 0 or a negative
 * errno; file is then as it was. Blocking.
 */
int replace_file(const char *file, const char *text, size_t len);

/*
 * The same in two steps, for several files, of which none is to be replaced before all are written
 * out. Only root can keep the owner of a file that is another's: here the caller becomes the owner
 * where that has to be. Mode and group stay then, or the group has no more rights than all have.
 * A user that could read the file, as its owner or by its group, still can, else -EPERM.
 * like: whose owner, group and mode the file gets; NULL: it is new, 0666 without the umask.
 * replace_commit() or replace_abandon() ends it. 0 or a negative errno, which ends it. Blocking.
 */
struct replacement {
	char path[PATH_MAX], temporary[PATH_MAX + 8];
};
int replace_prepare(struct replacement *replacement, const char *file, const struct stat *like,
                    const char *text, size_t len);
int replace_commit(struct replacement *replacement);
void replace_abandon(struct replacement *replacement);

/*
 * Lock file against replacement by other processes; it need not exist. What is locked is file.lock
 * beside it. Only the users that may replace the file can open it: the owner of the directory, its
 * group if that may write there, and root. A descriptor for replace_unlock(), which removes the
 * lock; -EBUSY: another process held it for five seconds; or another negative errno. A process that
 * is killed leaves the file, and no lock.
 */
int replace_lock(const char *file);
void replace_unlock(const char *file, int fd);
