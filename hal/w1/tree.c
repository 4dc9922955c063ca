/* SPDX-License-Identifier: MIT */
/* The attribute files of the kernel, and the meaning of the errors of open, read and write. */
#ifndef _LARGEFILE64_SOURCE
#define _LARGEFILE64_SOURCE /* getdents64() of musl */
#endif
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/w1/name.h"
#include "hal/w1/tree.h"

#define PATH_MAX_HERE (W1_ROOT_MAX + 64)

static void path_of(const struct w1_tree *tree, const char *directory, const char *name,
                    char path[PATH_MAX_HERE])
{
	snprintf(path, PATH_MAX_HERE, "%s/%s/%s", tree->root, directory, name);
}

bool w1_exists(const struct w1_tree *tree, const char *directory, const char *name)
{
	char path[PATH_MAX_HERE];

	path_of(tree, directory, name, path);
	return access(path, F_OK) == 0;
}

/* Drivers have attributes that no user can write, root included. */
static bool may_be_written(const struct w1_tree *tree, const char *directory, const char *name)
{
	char path[PATH_MAX_HERE];
	struct stat file;

	path_of(tree, directory, name, path);
	return stat(path, &file) == 0 && file.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH);
}

static int meaning(struct w1_tree *tree, const char *directory, const char *name, int error)
{
	char text[116];

	switch (error) {
	case ENOENT:
		return w1_exists(tree, directory, "") ? -ENOENT : -ENODEV;
	case ENODEV:
	case ENXIO:
		return w1_exists(tree, directory, "") ? -EIO : -ENODEV;
	case EACCES:
	case EPERM:
	case EROFS:
		if (!may_be_written(tree, directory, name))
			return -EACCES;
		if (!tree->told_rights) {
			snprintf(text, sizeof(text),
			         "no right to open %s/%s: run as root, or see docs/w1.md for udev",
			         directory, name);
			bus_report(tree->env, BUS_NOTE, -EPERM, text);
		}
		tree->told_rights = true;
		return -EPERM;
	}
	return -EIO;
}

int w1_read(struct w1_tree *tree, const char *directory, const char *name, unsigned at, void *data,
            size_t room)
{
	char path[PATH_MAX_HERE];
	size_t used = 0;
	ssize_t n = 1;

	path_of(tree, directory, name, path);
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return meaning(tree, directory, name, errno);
	if (at && lseek(fd, (off_t)at, SEEK_SET) < 0)
		n = -1;
	/* Not behind room: the switches' files refuse a second read behind their one byte. */
	while (used < room && n > 0) {
		n = read(fd, (char *)data + used, room - used);
		used += n > 0 ? (size_t)n : 0;
	}
	int err = n < 0 ? meaning(tree, directory, name, errno) : 0;
	close(fd);
	return err ? err : (int)used;
}

int w1_write(struct w1_tree *tree, const char *directory, const char *name, unsigned at,
             const void *data, size_t n)
{
	char path[PATH_MAX_HERE];
	int err = 0;

	path_of(tree, directory, name, path);
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return meaning(tree, directory, name, errno);
	ssize_t done = at && lseek(fd, (off_t)at, SEEK_SET) < 0 ? -1 : write(fd, data, n);
	if (done < 0)
		err = errno == EINVAL || errno == ERANGE ? -EINVAL
		                                         : meaning(tree, directory, name, errno);
	else if ((size_t)done != n)
		err = -EIO;
	close(fd);
	return err;
}

static int compare_names(const void *a, const void *b)
{
	return memcmp(a, b, W1_NAME_MAX);
}

int w1_slaves(struct w1_tree *tree, const char *directory)
{
	char path[PATH_MAX_HERE], *buffer = tree->text;
	size_t used = 0;
	uint8_t rom[8];
	ssize_t n;

	path_of(tree, directory, "", path);
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return meaning(tree, directory, "", errno);
	while ((n = getdents64(fd, (void *)buffer, sizeof(tree->text))) > 0) {
		for (ssize_t at = 0; at < n;) {
			const struct dirent64 *entry = (const void *)(buffer + at);

			at += entry->d_reclen;
			if (!w1_name_parse(entry->d_name, strlen(entry->d_name), rom) ||
			    used + W1_NAME_MAX > sizeof(tree->lists))
				continue;
			memcpy(tree->lists + used, entry->d_name, W1_NAME_MAX - 1);
			tree->lists[used + W1_NAME_MAX - 1] = '\n';
			used += W1_NAME_MAX;
		}
	}
	int err = n < 0 ? meaning(tree, directory, "", errno) : 0;
	close(fd);
	qsort(tree->lists, used / W1_NAME_MAX, W1_NAME_MAX, compare_names);
	return err ? err : (int)used;
}
