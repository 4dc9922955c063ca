/* SPDX-License-Identifier: MIT */
/* The disk of the system: one call each. */
#include "src/faces/influx/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

static int or_errno(int status)
{
	return status < 0 ? -errno : status;
}

static int disk_open(void *ctx, int dir, const char *name, int flags)
{
	(void)ctx;
	/* O_NONBLOCK: a FIFO of that name must not block */
	return or_errno(openat(dir, name, flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640));
}

static ssize_t disk_pread(void *ctx, int fd, void *data, size_t size, off_t at)
{
	ssize_t n;

	(void)ctx;
	do
		n = pread(fd, data, size, at);
	while (n < 0 && errno == EINTR);
	return n < 0 ? -errno : n;
}

static int disk_pwrite(void *ctx, int fd, const void *data, size_t size, off_t at)
{
	const char *from = data;

	(void)ctx;
	while (size > 0) {
		ssize_t n = pwrite(fd, from, size, at);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return n < 0 ? -errno : -EIO;
		from += n;
		at += n;
		size -= (size_t)n;
	}
	return 0;
}

static int disk_sync(void *ctx, int fd)
{
	struct stat st;

	(void)ctx;
	if (fstat(fd, &st) < 0)
		return -errno;
	return or_errno(S_ISDIR(st.st_mode) ? fsync(fd) : fdatasync(fd));
}

static int disk_truncate(void *ctx, int fd, off_t size)
{
	(void)ctx;
	return or_errno(ftruncate(fd, size));
}

static int disk_rename(void *ctx, int dir, const char *from, const char *to)
{
	(void)ctx;
	return or_errno(renameat(dir, from, dir, to));
}

static int disk_unlink(void *ctx, int dir, const char *name)
{
	(void)ctx;
	return or_errno(unlinkat(dir, name, 0));
}

static void disk_close(void *ctx, int fd)
{
	(void)ctx;
	close(fd);
}

static int64_t disk_free(void *ctx, int dir)
{
	struct statvfs st;

	(void)ctx;
	if (fstatvfs(dir, &st) < 0)
		return -errno;
	return (int64_t)st.f_bavail * (int64_t)st.f_frsize;
}

const struct spool_disk spool_disk_system = {
	.open = disk_open,
	.pread = disk_pread,
	.pwrite = disk_pwrite,
	.sync = disk_sync,
	.truncate = disk_truncate,
	.rename = disk_rename,
	.unlink = disk_unlink,
	.close = disk_close,
	.free = disk_free,
};

int spool_disk_directory(const char *path, int make)
{
	if (make && mkdir(path, 0750) < 0 && errno != EEXIST)
		return -errno;
	return or_errno(open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}
