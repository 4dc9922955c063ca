/* SPDX-License-Identifier: MIT */
/* The attribute files of the kernel, and the meaning of the errors of open, read and write. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/w1/w1.h"

#define PATH_MAX_HERE (W1_ROOT_MAX + 64)

static void path_of(const struct w1_master *master, const char *directory, const char *name,
                    char path[PATH_MAX_HERE])
{
	snprintf(path, PATH_MAX_HERE, "%s/%s/%s", master->root, directory, name);
}

bool w1_exists(const struct w1_master *master, const char *directory, const char *name)
{
	char path[PATH_MAX_HERE];

	path_of(master, directory, name, path);
	return access(path, F_OK) == 0;
}

void w1_note(struct w1_master *master, int err, const char *text)
{
	struct bus_event event = {.news = BUS_NOTE, .err = err};

	snprintf(event.text, sizeof(event.text), "%s", text);
	master->master.env->event(master->master.env->ctx, &event);
}

/* Drivers have attributes that can only be read, whoever one is. */
static bool may_be_written(const struct w1_master *master, const char *directory, const char *name)
{
	char path[PATH_MAX_HERE];
	struct stat file;

	path_of(master, directory, name, path);
	return stat(path, &file) == 0 && file.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH);
}

static int meaning(struct w1_master *master, const char *directory, const char *name, int error)
{
	char text[116];

	switch (error) {
	case ENOENT:
		return w1_exists(master, directory, "") ? -ENOENT : -ENODEV;
	case ENODEV:
	case ENXIO:
		return w1_exists(master, directory, "") ? -EIO : -ENODEV;
	case EACCES:
	case EPERM:
	case EROFS:
		if (!may_be_written(master, directory, name))
			return -EACCES;
		if (!master->told_rights) {
			snprintf(text, sizeof(text),
			         "no right to open %s/%s: run as root, or see docs/w1.md for udev",
			         directory, name);
			w1_note(master, -EPERM, text);
		}
		master->told_rights = true;
		return -EPERM;
	}
	return -EIO;
}

static int read_at(struct w1_master *master, const char *directory, const char *name, unsigned at,
                   void *data, size_t room)
{
	char path[PATH_MAX_HERE];
	size_t used = 0;
	ssize_t n = 1;

	path_of(master, directory, name, path);
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return meaning(master, directory, name, errno);
	if (at && lseek(fd, (off_t)at, SEEK_SET) < 0)
		n = -1;
	/* Not behind room: the switches' files refuse a second read behind their one byte. */
	while (used < room && n > 0) {
		n = read(fd, (char *)data + used, room - used);
		used += n > 0 ? (size_t)n : 0;
	}
	int err = n < 0 ? meaning(master, directory, name, errno) : 0;
	close(fd);
	return err ? err : (int)used;
}

static int write_at(struct w1_master *master, const char *directory, const char *name, unsigned at,
                    const void *data, size_t n)
{
	char path[PATH_MAX_HERE];
	int err = 0;

	path_of(master, directory, name, path);
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return meaning(master, directory, name, errno);
	ssize_t done = at && lseek(fd, (off_t)at, SEEK_SET) < 0 ? -1 : write(fd, data, n);
	if (done < 0)
		err = errno == EINVAL || errno == ERANGE ? -EINVAL
		                                         : meaning(master, directory, name, errno);
	else if ((size_t)done != n)
		err = -EIO;
	close(fd);
	return err;
}

int w1_read(struct w1_master *master, const char *directory, const char *name, void *data,
            size_t room)
{
	return read_at(master, directory, name, 0, data, room);
}

int w1_write(struct w1_master *master, const char *directory, const char *name, const void *data,
             size_t n)
{
	return write_at(master, directory, name, 0, data, n);
}

int w1_slave_read_at(struct w1_master *master, const uint8_t rom[8], const char *name, unsigned at,
                     void *data, size_t room)
{
	char directory[W1_NAME_MAX];

	w1_name(rom, directory);
	return read_at(master, directory, name, at, data, room);
}

int w1_slave_read(struct w1_master *master, const uint8_t rom[8], const char *name, void *data,
                  size_t room)
{
	return w1_slave_read_at(master, rom, name, 0, data, room);
}

int w1_slave_text(struct w1_master *master, const uint8_t rom[8], const char *name)
{
	int n = w1_slave_read(master, rom, name, master->text, sizeof(master->text) - 1);

	master->text[n > 0 ? n : 0] = '\0';
	return n < 0 ? n : n ? 0 : -EIO;
}

int w1_slave_number(struct w1_master *master, const uint8_t rom[8], const char *name, long *number)
{
	int err = w1_slave_text(master, rom, name);
	char *end;

	if (err)
		return err;
	*number = strtol(master->text, &end, 10);
	return end == master->text ? -EIO : 0;
}

int w1_slave_write_at(struct w1_master *master, const uint8_t rom[8], const char *name, unsigned at,
                      const void *data, size_t n)
{
	char directory[W1_NAME_MAX];

	w1_name(rom, directory);
	return write_at(master, directory, name, at, data, n);
}

int w1_slave_write(struct w1_master *master, const uint8_t rom[8], const char *name,
                   const void *data, size_t n)
{
	return w1_slave_write_at(master, rom, name, 0, data, n);
}

bool w1_slave_has(const struct w1_master *master, const uint8_t rom[8], const char *name)
{
	char directory[W1_NAME_MAX];

	w1_name(rom, directory);
	return w1_exists(master, directory, name);
}

static int compare_names(const void *a, const void *b)
{
	return memcmp(a, b, W1_NAME_MAX);
}

int w1_slaves(struct w1_master *master, const char *directory)
{
	char path[PATH_MAX_HERE], *buffer = master->text;
	size_t used = 0;
	uint8_t rom[8];
	ssize_t n;

	path_of(master, directory, "", path);
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return meaning(master, directory, "", errno);
	while ((n = getdents64(fd, buffer, sizeof(master->text))) > 0) {
		for (ssize_t at = 0; at < n;) {
			const struct dirent64 *entry = (const void *)(buffer + at);

			at += entry->d_reclen;
			if (!w1_name_parse(entry->d_name, strlen(entry->d_name), rom) ||
			    used + W1_NAME_MAX > sizeof(master->lists))
				continue;
			memcpy(master->lists + used, entry->d_name, W1_NAME_MAX - 1);
			master->lists[used + W1_NAME_MAX - 1] = '\n';
			used += W1_NAME_MAX;
		}
	}
	int err = n < 0 ? meaning(master, directory, "", errno) : 0;
	close(fd);
	qsort(master->lists, used / W1_NAME_MAX, W1_NAME_MAX, compare_names);
	return err ? err : (int)used;
}
