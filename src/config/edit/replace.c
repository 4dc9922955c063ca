/* SPDX-License-Identifier: MIT */
/* Replaces a file in one step: a temporary file beside it is written out and renamed. */
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/config/edit/replace.h"
#include "src/memory/shm/owner.h"

#define SUFFIX ".XXXXXX"
#define LOCK_SUFFIX ".lock"
#define LOCK_PATH (PATH_MAX + sizeof(LOCK_SUFFIX))
#define LOCK_TRIES 250
#define LOCK_PAUSE (20 * NS_PER_MS) /* ns: five seconds in all */

int replace_write(int fd, const char *text, size_t len)
{
	while (len) {
		ssize_t n = write(fd, text, len);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return n ? -errno : -EIO;
		text += n;
		len -= (size_t)n;
	}
	return fsync(fd) ? -errno : 0;
}

/* Give the new file the owner and then the mode of the old: a new owner clears the set-id bits. */
static int copy_owner(int fd, const struct stat *old)
{
	struct stat made;

	if (fstat(fd, &made))
		return -errno;
	if ((made.st_uid != old->st_uid || made.st_gid != old->st_gid) &&
	    fchown(fd, old->st_uid, old->st_gid))
		return -errno;
	return fchmod(fd, old->st_mode & 07777) ? -errno : 0;
}

/* Can the owner of before still read the file, though another user owns it now? */
static bool owner_reads_on(const struct stat *old, bool group_kept, mode_t mode)
{
	if (!old->st_uid || !(old->st_mode & S_IRUSR) || (mode & S_IROTH))
		return true;
	return group_kept && (mode & S_IRGRP) && owner_in_group(old->st_uid, old->st_gid);
}

/* As copy_owner(), but the caller owns the new file where the old owner cannot be kept. */
static int take_over(int fd, const struct stat *old)
{
	mode_t mode = old->st_mode & 0777;
	bool kept = true;
	struct stat made;

	if (copy_owner(fd, old) == 0)
		return 0;
	if (fstat(fd, &made))
		return -errno;
	if (made.st_gid != old->st_gid && fchown(fd, (uid_t)-1, old->st_gid))
		kept = false;
	/* the group is another: users of the old group keep the rights that all have */
	if (!kept && (mode & S_IRGRP) && !(mode & S_IROTH))
		return -EPERM;
	if (!kept)
		mode &= ~(mode_t)S_IRWXG | (mode & S_IRWXO) << 3;
	if (!owner_reads_on(old, kept, mode))
		return -EPERM;
	return fchmod(fd, mode) ? -errno : 0;
}

static int mode_of_new_file(int fd)
{
	mode_t mask = umask(0);

	umask(mask);
	return fchmod(fd, 0666 & ~mask) ? -errno : 0;
}

static int replace_fill(int fd, const struct stat *old, int (*give)(int fd, const struct stat *old),
                        const char *text, size_t len)
{
	int err = old ? give(fd, old) : mode_of_new_file(fd);

	return err ? err : replace_write(fd, text, len);
}

/* Open the directory of path; cuts path at its last slash. */
static int open_directory(char *path)
{
	char *slash = strrchr(path, '/');

	if (slash && slash != path)
		*slash = '\0';
	return open(slash ? (slash == path ? "/" : path) : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/* Bring the rename to the disk too; a file system that cannot do so is no error. */
static void sync_directory(char *path)
{
	int fd = open_directory(path);

	if (fd < 0)
		return;
	fsync(fd);
	close(fd);
}

/* Write the file out beside replacement->path. */
static int write_beside(struct replacement *replacement, const struct stat *old,
                        int (*give)(int fd, const struct stat *old), const char *text, size_t len)
{
	int fd, err;

	snprintf(replacement->temporary, sizeof(replacement->temporary), "%s" SUFFIX,
	         replacement->path);
	fd = mkostemp(replacement->temporary, O_CLOEXEC);
	if (fd < 0)
		return -errno;
	err = replace_fill(fd, old, give, text, len);
	if (close(fd) && !err)
		err = -errno;
	if (err)
		replace_abandon(replacement);
	return err;
}

int replace_commit(struct replacement *replacement)
{
	int err = rename(replacement->temporary, replacement->path) ? -errno : 0;

	if (err)
		replace_abandon(replacement);
	else
		sync_directory(replacement->path);
	return err;
}

void replace_abandon(struct replacement *replacement)
{
	unlink(replacement->temporary);
}

/* The file that a link leads to; of one that is not there *is_new. */
static int find_path(const char *file, char path[PATH_MAX], bool *is_new)
{
	struct stat st;

	*is_new = !realpath(file, path);
	if (!*is_new)
		return 0;
	/* owsd does not create the missing target of a link */
	if (errno != ENOENT || !lstat(file, &st))
		return -errno;
	if (strlen(file) >= PATH_MAX)
		return -ENAMETOOLONG;
	memcpy(path, file, strlen(file) + 1);
	return 0;
}

int replace_prepare(struct replacement *replacement, const char *file, const struct stat *like,
                    const char *text, size_t len)
{
	bool is_new;
	int err = find_path(file, replacement->path, &is_new);

	return err ? err : write_beside(replacement, like, take_over, text, len);
}

int replace_file(const char *file, const char *text, size_t len)
{
	struct replacement replacement;
	struct stat old;
	bool is_new;
	int err = find_path(file, replacement.path, &is_new);

	if (err)
		return err;
	if (!is_new && stat(replacement.path, &old))
		return -errno;
	if (!is_new && !S_ISREG(old.st_mode))
		return S_ISDIR(old.st_mode) ? -EISDIR : -EINVAL;
	err = write_beside(&replacement, is_new ? NULL : &old, copy_owner, text, len);
	return err ? err : replace_commit(&replacement);
}

/* The name of the file that is locked: beside the one that a link leads to, which may be away. */
static int lock_path(const char *file, char path[LOCK_PATH])
{
	char real[PATH_MAX];

	if (!realpath(file, real)) {
		if (errno != ENOENT)
			return -errno;
		if (strlen(file) >= sizeof(real))
			return -ENAMETOOLONG;
		memcpy(real, file, strlen(file) + 1);
	}
	snprintf(path, LOCK_PATH, "%s" LOCK_SUFFIX, real);
	return 0;
}

/* The users that may put files into the directory may lock: its owner, a group that may write. */
static void share_lock(int fd, const char *lock)
{
	char path[LOCK_PATH];
	struct stat st;
	int folder;

	memcpy(path, lock, LOCK_PATH);
	folder = open_directory(path);
	if (folder < 0)
		return;
	if (fstat(folder, &st) == 0 && !(st.st_mode & S_ISVTX) &&
	    fchown(fd, geteuid() == 0 ? st.st_uid : (uid_t)-1, st.st_gid) == 0 &&
	    (st.st_mode & S_IWGRP))
		fchmod(fd, 0660);
	close(folder);
}

/* Is that the file of the path? */
static bool is_at(int fd, const char *path)
{
	struct stat held, named;

	return fstat(fd, &held) == 0 && lstat(path, &named) == 0 && held.st_ino == named.st_ino &&
	       held.st_dev == named.st_dev;
}

/*
 * The file, made if need be, with the lock; -EAGAIN: another has it, is making it, or has just
 * removed it. Only what was made here changes its owner: a name that is there may be a link to
 * anything.
 */
static int try_lock(const char *path)
{
	int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);

	if (fd >= 0)
		share_lock(fd, path);
	else if (errno == EEXIST)
		fd = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0) {
		int err = errno;

		return err == ENOENT || (err == EACCES && access(path, F_OK) == 0) ? -EAGAIN : -err;
	}
	if (flock(fd, LOCK_EX | LOCK_NB) == 0 && is_at(fd, path))
		return fd;
	close(fd);
	return -EAGAIN;
}

int replace_lock(const char *file)
{
	char path[LOCK_PATH];
	int fd = lock_path(file, path);

	if (fd)
		return fd;
	fd = try_lock(path);
	for (int i = 0; fd == -EAGAIN && i < LOCK_TRIES; i++) {
		clock_pause(LOCK_PAUSE);
		fd = try_lock(path);
	}
	return fd == -EAGAIN ? -EBUSY : fd;
}

void replace_unlock(const char *file, int fd)
{
	char path[LOCK_PATH];

	/* the link may lead elsewhere by now, where another has its lock */
	if (lock_path(file, path) == 0 && is_at(fd, path))
		unlink(path);
	close(fd);
}
