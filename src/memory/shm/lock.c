/* SPDX-License-Identifier: MIT */
/*
 * The lock of an instance is a file of its own with mode 0600: on a file that others may read, any
 * reader could hold a lock and so keep owsd from starting.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/corpse.h"
#include "src/memory/shm/lock.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/segment.h"

#define LOCK_TRIES 16

/*
 * Byte 0 is the instance. Byte 1 is held while the pid is written and while a corpse's file is
 * replaced, so that no owsd mistakes a lock of a new owner that has not yet written its pid for a
 * corpse's.
 */
#define BYTE_INSTANCE 0
#define BYTE_PID 1

static int lock_bytes(int fd, short type, off_t start, off_t len)
{
	struct flock lock = {
		.l_type = type,
		.l_whence = SEEK_SET,
		.l_start = start,
		.l_len = len,
	};

	return fcntl(fd, F_OFD_SETLK, &lock) < 0 ? -errno : 0;
}

/* Opening without O_CREAT first: the kernel refuses O_CREAT on files of others even to root. */
static int open_lock(int dir, const char *name)
{
	struct stat st;
	int fd = openat(dir, name, O_RDWR | O_NOFOLLOW | O_CLOEXEC);

	if (fd < 0 && errno == ENOENT) {
		fd = openat(dir, name, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
		if (fd < 0 && errno == EEXIST)
			return -EAGAIN;
	}
	if (fd < 0) {
		int err = -errno;

		if (err == -EACCES && fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) == 0 &&
		    st.st_uid != geteuid())
			return -EPERM;
		/* a link, a directory, a socket */
		return err == -ELOOP || err == -EISDIR || err == -ENXIO ? -EPERM : err;
	}
	if (fstat(fd, &st) < 0 || !S_ISREG(st.st_mode) || !owner_trusted(st.st_uid)) {
		close(fd);
		return -EPERM;
	}
	return fd;
}

static bool is_still_named(int fd, int dir, const char *name)
{
	struct stat a, b;

	return fstat(fd, &a) == 0 && fstatat(dir, name, &b, AT_SYMLINK_NOFOLLOW) == 0 &&
	       a.st_ino == b.st_ino && a.st_dev == b.st_dev;
}

static pid_t read_pid(int fd)
{
	char text[16];
	ssize_t n = pread(fd, text, sizeof(text) - 1, 0);
	long pid = 0;

	for (ssize_t i = 0; i < n && text[i] >= '0' && text[i] <= '9' && pid < 100000000; i++)
		pid = pid * 10 + (text[i] - '0');
	return (pid_t)pid;
}

/* Write over the page that exists before truncating: a full file system has no other to give. */
static int write_pid(int fd)
{
	char text[16];
	int n = snprintf(text, sizeof(text), "%ld\n", (long)getpid());

	errno = 0;
	if (pwrite(fd, text, (size_t)n, 0) != n || ftruncate(fd, n) < 0)
		return errno ? -errno : -EIO;
	return 0;
}

/*
 * Replace the file that a corpse has locked; byte 1 of fd, which is locked, keeps other owsds out.
 */
static int replace_lock(int fd, int dir, const char *name)
{
	if (lock_bytes(fd, F_WRLCK, BYTE_PID, 1) < 0 || !corpse_is(read_pid(fd)))
		return -EBUSY;
	if (is_still_named(fd, dir, name) && unlinkat(dir, name, 0) < 0)
		return -errno;
	return 0;
}

bool segment_lock_held(const struct shm_dir *dir, int lock, const char *instance)
{
	char name[SEGMENT_FILE];

	return segment_leads_to(dir->fd, segment_file(instance, "lock", name), lock);
}

int segment_lock(const struct shm_dir *dir, const char *instance, pid_t *pid, bool *stolen)
{
	char name[SEGMENT_FILE];

	*pid = 0;
	*stolen = false;
	if (!segment_name_ok(instance))
		return -EINVAL;
	segment_file(instance, "lock", name);
	for (int i = 0; i < LOCK_TRIES; i++) {
		int err, fd = open_lock(dir->fd, name);

		if (fd == -EAGAIN)
			continue;
		if (fd < 0)
			return fd;
		err = lock_bytes(fd, F_WRLCK, BYTE_INSTANCE, 2);
		if (err == 0 && is_still_named(fd, dir->fd, name)) {
			err = write_pid(fd);
			lock_bytes(fd, F_UNLCK, BYTE_PID, 1);
			if (err == 0)
				return fd;
			unlinkat(dir->fd, name,
			         0); /* no owsd holds it, and a waiter checks that it exists */
		} else if (err == -EAGAIN || err == -EACCES) {
			*pid = read_pid(fd);
			err = -EBUSY;
			if (*pid > 0 && corpse_is(*pid)) {
				err = replace_lock(fd, dir->fd, name);
				*stolen = err == 0;
			}
		}
		close(fd);
		if (err)
			return err;
	}
	return -EBUSY;
}

int segment_lock_look(const struct shm_dir *dir, const char *instance, pid_t *pid)
{
	char name[SEGMENT_FILE];
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_len = 1};
	struct stat st;
	int fd, held;

	*pid = 0;
	if (!segment_name_ok(instance))
		return -EINVAL;
	fd = openat(dir->fd, segment_file(instance, "lock", name),
	            O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		return errno == ELOOP || errno == ENXIO ? -EPERM : -errno;
	held = fcntl(fd, F_OFD_GETLK, &lock) < 0 ? -errno : lock.l_type != F_UNLCK;
	if (held >= 0 &&
	    (fstat(fd, &st) < 0 || !S_ISREG(st.st_mode) || (!held && !owner_trusted(st.st_uid))))
		held = -EPERM;
	if (held >= 0)
		*pid = read_pid(fd);
	if (held > 0)
		held = !(*pid > 0 && corpse_is(*pid));
	close(fd);
	return held;
}

int segment_lock_any(const struct shm_dir *dir, const char *instance, pid_t *pid)
{
	char name[SEGMENT_FILE];
	struct stat st;
	int fd, err;

	*pid = 0;
	if (!segment_name_ok(instance))
		return -EINVAL;
	segment_file(instance, "lock", name);
	fd = openat(dir->fd, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		return errno == ELOOP || errno == EISDIR || errno == ENXIO ? -EPERM : -errno;
	if (fstat(fd, &st) < 0 || !S_ISREG(st.st_mode)) {
		close(fd);
		return -EPERM;
	}
	err = lock_bytes(fd, F_WRLCK, BYTE_INSTANCE, 2);
	if (err == -EAGAIN || err == -EACCES) {
		*pid = read_pid(fd);
		/* a corpse creates no files any more */
		err = *pid > 0 && corpse_is(*pid) ? 0 : -EBUSY;
	} else if (!err && !is_still_named(fd, dir->fd, name)) {
		err = -EBUSY; /* another process replaces or removes the file */
	}
	if (err) {
		close(fd);
		return err;
	}
	return fd;
}
