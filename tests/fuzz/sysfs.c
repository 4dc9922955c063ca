/* SPDX-License-Identifier: MIT */
/* A file system in memory in place of /sys/bus/w1/devices. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/w1/tree.h"
#include "tests/fuzz/sysfs.h"

#define FD_BASE 1000

/* name "": a directory, whose bytes are the names that it lists. */
static struct file {
	char directory[24], name[32];
	uint8_t bytes[SYSFS_BYTES];
	size_t n, at;
	uint8_t fault;
} files[SYSFS_FILES];
static unsigned count;

void sysfs_clear(void)
{
	count = 0;
}

static struct file *find(const char *directory, const char *name)
{
	for (unsigned i = 0; i < count; i++)
		if (strcmp(files[i].directory, directory) == 0 && strcmp(files[i].name, name) == 0)
			return &files[i];
	return NULL;
}

void sysfs_file(const char *directory, const char *name, const void *bytes, size_t n, uint8_t fault)
{
	struct file *file = find(directory, name);

	if (!file && count == SYSFS_FILES)
		return;
	if (!file)
		file = &files[count++];
	*file = (struct file){.n = n < SYSFS_BYTES ? n : SYSFS_BYTES, .fault = fault};
	snprintf(file->directory, sizeof(file->directory), "%s", directory);
	snprintf(file->name, sizeof(file->name), "%s", name);
	if (file->n)
		memcpy(file->bytes, bytes, file->n);
}

void sysfs_directory(const char *directory, const uint8_t *names, size_t n)
{
	sysfs_file(directory, "", names, n, 0);
}

void sysfs_remove(const char *directory, const char *name)
{
	for (unsigned i = 0; i < count;)
		if (strcmp(files[i].directory, directory) == 0 &&
		    (!name || strcmp(files[i].name, name) == 0))
			files[i] = files[--count];
		else
			i++;
}

static struct file *file_at(const char *path)
{
	char directory[24];
	const char *slash;

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(path, SYSFS_ROOT "/", sizeof(SYSFS_ROOT)), path);
	path += sizeof(SYSFS_ROOT);
	slash = strchr(path, '/');
	TEST_ASSERT_NOT_NULL_MESSAGE(slash, path);
	snprintf(directory, sizeof(directory), "%.*s", (int)(slash - path), path);
	return find(directory, slash + 1);
}

static int give(struct file *file, int error)
{
	errno = error;
	return file && !error ? FD_BASE + (int)(file - files) : -1;
}

static int sysfs_access(const char *path)
{
	struct file *file = file_at(path);

	return give(file, file ? 0 : ENOENT) < 0 ? -1 : 0;
}

static int sysfs_stat(const char *path, struct stat *st)
{
	struct file *file = file_at(path);

	*st = (struct stat){.st_mode = file && file->fault == SYSFS_STUBBORN ? 0444 : 0644};
	return give(file, file ? 0 : ENOENT) < 0 ? -1 : 0;
}

static int sysfs_open(const char *path)
{
	struct file *file = file_at(path);

	if (!file)
		return give(NULL, ENOENT);
	file->at = 0;
	return give(file, file->fault == SYSFS_REFUSED ? EACCES : 0);
}

static off_t sysfs_seek(int fd, off_t at)
{
	files[fd - FD_BASE].at = (size_t)at;
	return at;
}

static ssize_t sysfs_read(int fd, void *to, size_t room)
{
	struct file *file = &files[fd - FD_BASE];
	size_t n = file->at < file->n ? file->n - file->at : 0;

	if (file->fault == SYSFS_BROKEN)
		return give(file, EIO);
	if (n > room)
		n = room;
	if (n && file->fault == SYSFS_SHORT)
		n = 1;
	memcpy(to, file->bytes + (n ? file->at : 0), n);
	file->at += n;
	return (ssize_t)n;
}

static ssize_t sysfs_write(int fd, const void *from, size_t n)
{
	struct file *file = &files[fd - FD_BASE];

	if (file->fault == SYSFS_STUBBORN)
		return give(file, EINVAL);
	if (file->fault == SYSFS_BROKEN)
		return give(file, EIO);
	if (file->fault == SYSFS_PARTIAL)
		n = n ? 1 : 0;
	if (file->fault == SYSFS_DEAF || file->at >= SYSFS_BYTES)
		return (ssize_t)n;
	if (n > SYSFS_BYTES - file->at)
		n = SYSFS_BYTES - file->at;
	if (n)
		memcpy(file->bytes + file->at, from, n);
	if (file->at + n > file->n)
		file->n = file->at + n;
	return (ssize_t)n;
}

static ssize_t sysfs_list(int fd, void *buffer, size_t room)
{
	struct file *file = &files[fd - FD_BASE];
	size_t used = 0;

	if (file->fault == SYSFS_BROKEN)
		return give(file, EIO);
	while (file->at < file->n) {
		const char *name = (const char *)file->bytes + file->at;
		size_t len = strnlen(name, file->n - file->at);
		size_t size = (offsetof(struct dirent64, d_name) + len + 1 + 7) / 8 * 8;
		struct dirent64 *entry = (void *)((char *)buffer + used);

		if (size > room - used)
			break;
		entry->d_reclen = (unsigned short)size;
		memcpy(entry->d_name, name, len);
		entry->d_name[len] = '\0';
		file->at += len + 1;
		used += size;
	}
	return (ssize_t)used;
}

#define access(path, mode) ((void)(mode), sysfs_access(path))
#define stat(path, st) sysfs_stat(path, st)
#define open(path, flags) ((void)(flags), sysfs_open(path))
#define lseek(fd, at, whence) ((void)(whence), sysfs_seek(fd, at))
#define read(fd, to, n) sysfs_read(fd, to, n)
#define write(fd, from, n) sysfs_write(fd, from, n)
#define close(fd) ((void)(fd))
#define getdents64(fd, buffer, n) sysfs_list(fd, buffer, n)
#include "hal/w1/tree.c"
