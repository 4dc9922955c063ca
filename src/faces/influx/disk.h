/* SPDX-License-Identifier: MIT */
/*
 * What the spool asks of a disk. Tests put another one in its place, which loses
 * power or is full. Each function returns 0 (or the count or descriptor) or a negative errno, and
 * blocks as the system call of its name.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct spool_disk {
	void *ctx;
	/* flags of open(2), beside O_CLOEXEC and O_NOFOLLOW; new files get mode 0640 */
	int (*open)(void *ctx, int dir, const char *name, int flags);
	ssize_t (*pread)(void *ctx, int fd, void *data, size_t size, off_t at);
	/* All or an error: after a short write the rest is tried once more. */
	int (*pwrite)(void *ctx, int fd, const void *data, size_t size, off_t at);
	int (*sync)(void *ctx, int fd); /* fdatasync() of a file, fsync() of a directory */
	int (*truncate)(void *ctx, int fd, off_t size);
	int (*rename)(void *ctx, int dir, const char *from, const char *to);
	int (*unlink)(void *ctx, int dir, const char *name);
	void (*close)(void *ctx, int fd);
	/* Bytes that are free for this user on the disk of a directory. */
	int64_t (*free)(void *ctx, int dir);
};
extern const struct spool_disk spool_disk_system;

/* Open a directory for the calls above; make it, mode 0750, if it is missing and make says so. */
int spool_disk_directory(const char *path, int make);
