/* SPDX-License-Identifier: MIT */
/* The file is made, opened, found to be another one, and put aside. */
#include "src/history/file/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/history/file/place.h"
#include "src/history/file/schema.h"

#define PATH (HISTORY_PATH + 64)
#define ASIDE 1000 /* damaged files that may be beside it */

static int make_path(const struct history_file *file, const char *name, char path[PATH])
{
	int n = snprintf(path, PATH, "%s/%s", file->directory, name);

	return n < PATH ? 0 : -ENAMETOOLONG;
}

static int lock_directory(struct history_file *file)
{
	if (mkdir(file->directory, 0750) < 0 && errno != EEXIST && errno != EROFS)
		return -errno;
	file->lock = history_lock(file->directory);
	return file->lock < 0 ? file->lock : 0;
}

/* SQLite would make it for all to read, and open one that it may not write for reading alone. */
static int make_file(struct history_file *file, const char *path)
{
	int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640);
	struct stat seen;
	int err = 0;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &seen) < 0)
		err = -errno;
	else if (!S_ISREG(seen.st_mode))
		err = -EEXIST;
	file->device = seen.st_dev;
	file->inode = seen.st_ino;
	close(fd);
	return err;
}

/* A damaged file, and the log of its last commits, get a name of their own. */
static int put_aside(struct history_file *file, const char *path)
{
	char name[64], to[PATH + 8], from[PATH + 8], text[2 * PATH];
	int n = 1;

	do {
		snprintf(name, sizeof(name), "history-damaged-%d.sqlite", n);
		if (make_path(file, name, to))
			return -ENAMETOOLONG;
	} while (access(to, F_OK) == 0 && ++n < ASIDE);
	snprintf(from, sizeof(from), "%s-shm", path);
	unlink(from);
	snprintf(from, sizeof(from), "%s-wal", path);
	if (rename(path, to) < 0)
		return -errno;
	snprintf(to + strlen(to), 5, "-wal");
	rename(from, to);
	snprintf(text, sizeof(text), "%s is damaged: it is put aside as %s, and another is begun",
	         path, name);
	if (file->say)
		file->say(file->ctx, text);
	return 0;
}

static int open_path(struct history_file *file, const char *path)
{
	int err = make_file(file, path);

	return err ? err : schema_open(path, &file->db);
}

int file_open(struct history_file *file)
{
	char path[PATH];
	int err = make_path(file, HISTORY_FILE, path);

	if (!err)
		err = lock_directory(file);
	if (!err)
		err = open_path(file, path);
	if (err == -EBADMSG) {
		err = put_aside(file, path);
		if (!err)
			err = open_path(file, path);
	}
	if (err)
		file_close(file);
	return err;
}

void file_close(struct history_file *file)
{
	sqlite3_close(file->db);
	file->db = NULL;
	if (file->lock >= 0)
		close(file->lock);
	file->lock = -1;
}

int file_put_aside(struct history_file *file)
{
	char path[PATH];
	int err = make_path(file, HISTORY_FILE, path);

	file_close(file);
	return err ? err : put_aside(file, path);
}

bool file_is_there(const struct history_file *file)
{
	struct stat seen;
	char path[PATH];

	return !make_path(file, HISTORY_FILE, path) && stat(path, &seen) == 0 &&
	       seen.st_dev == file->device && seen.st_ino == file->inode;
}
