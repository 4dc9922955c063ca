/* SPDX-License-Identifier: MIT */
/* Replaces a file in one step: a temporary file beside it is written out and renamed. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/time.h"
#include "src/config/replace.h"

#define SUFFIX ".XXXXXX"
#define LOCK_TRIES 250
#define LOCK_PAUSE (20 * NS_PER_MS) /* ns: five seconds in all */

static int write_all(int fd, const char *text, size_t len)
{
	while (len) {
		ssize_t n = write(fd, text, len);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			return -errno;
		text += n;
		len -= (size_t)n;
	}
	return 0;
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

static int mode_of_new_file(int fd)
{
	mode_t mask = umask(0);

	umask(mask);
	return fchmod(fd, 0666 & ~mask) ? -errno : 0;
}

static int fill(int fd, const struct stat *old, const char *text, size_t len)
{
	int err = old ? copy_owner(fd, old) : mode_of_new_file(fd);

	if (!err)
		err = write_all(fd, text, len);
	if (!err && fsync(fd))
		err = -errno;
	return err;
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

static int replace_path(char *path, const struct stat *old, const char *text, size_t len)
{
	char temporary[PATH_MAX + sizeof(SUFFIX)];
	int fd, err;

	snprintf(temporary, sizeof(temporary), "%s" SUFFIX, path);
	fd = mkostemp(temporary, O_CLOEXEC);
	if (fd < 0)
		return -errno;
	err = fill(fd, old, text, len);
	if (close(fd) && !err)
		err = -errno;
	if (!err && rename(temporary, path))
		err = -errno;
	if (err)
		unlink(temporary);
	else
		sync_directory(path);
	return err;
}

int replace_file(const char *file, const char *text, size_t len)
{
	char path[PATH_MAX];
	struct stat old;

	if (!realpath(file, path)) {
		/* owsd does not create the missing target of a link */
		if (errno != ENOENT || !lstat(file, &old))
			return -errno;
		if (strlen(file) >= sizeof(path))
			return -ENAMETOOLONG;
		memcpy(path, file, strlen(file) + 1);
		return replace_path(path, NULL, text, len);
	}
	if (stat(path, &old))
		return -errno;
	if (!S_ISREG(old.st_mode))
		return S_ISDIR(old.st_mode) ? -EISDIR : -EINVAL;
	return replace_path(path, &old, text, len);
}

int replace_lock(const char *file)
{
	const struct timespec pause = {.tv_nsec = LOCK_PAUSE};
	char path[PATH_MAX];
	int fd, err;

	if (!realpath(file, path)) {
		if (errno != ENOENT)
			return -errno;
		if (strlen(file) >= sizeof(path))
			return -ENAMETOOLONG;
		memcpy(path, file, strlen(file) + 1);
	}
	/*
	 * Lock the directory: it stays when the file is replaced, and exists before the file does
	 */
	fd = open_directory(path);
	if (fd < 0)
		return -errno;
	for (int i = 0; flock(fd, LOCK_EX | LOCK_NB); i++) {
		err = errno;
		if ((err == EWOULDBLOCK || err == EINTR) && i < LOCK_TRIES) {
			nanosleep(&pause, NULL);
			continue;
		}
		close(fd);
		return err == EWOULDBLOCK ? -EBUSY : -err;
	}
	return fd;
}
