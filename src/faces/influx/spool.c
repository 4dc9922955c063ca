/* SPDX-License-Identifier: MIT */
/* Batches that wait as files: names are numbers, which only grow. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/faces/influx/spool.h"
#include "src/history/file/place.h"

#define LINES "lines"
#define REFUSED "refused"
#define HALF "half" /* a file that is being written */
#define BLOCK 4096u
#define FIRST_ROOM 64u

static void make_name(char name[SPOOL_NAME], uint64_t number, const char *kind)
{
	snprintf(name, SPOOL_NAME, "%012" PRIu64 ".%s", number, kind);
}

/* The number of a file of that kind; 0: it is none. */
static uint64_t file_number(const char *name, const char *kind)
{
	char made[SPOOL_NAME];
	uint64_t number = strtoull(name, NULL, 10);

	make_name(made, number, kind);
	return strcmp(name, made) == 0 ? number : 0;
}

static uint64_t blocks(const struct spool_file *file)
{
	return ((uint64_t)file->size + BLOCK - 1) / BLOCK * BLOCK;
}

static int spool_append(struct spool *spool, uint64_t number, uint64_t size)
{
	if (spool->first > spool->room / 2) {
		spool->end -= spool->first;
		memmove(spool->files, spool->files + spool->first,
		        spool->end * sizeof(*spool->files));
		spool->first = 0;
	}
	if (spool->end == spool->room) {
		size_t room = spool->room ? 2 * spool->room : FIRST_ROOM;
		struct spool_file *files = reallocarray(spool->files, room, sizeof(*files));

		if (!files)
			return -ENOMEM;
		spool->files = files;
		spool->room = room;
	}
	spool->files[spool->end] = (struct spool_file){
		.number = number, .size = size < UINT32_MAX ? (uint32_t)size : UINT32_MAX};
	spool->bytes += blocks(&spool->files[spool->end++]);
	return 0;
}

static void unlink_kind(struct spool *spool, uint64_t number, const char *kind)
{
	char name[SPOOL_NAME];

	make_name(name, number, kind);
	spool->disk->unlink(spool->disk->ctx, spool->dir, name);
}

/* The oldest of those that are kept gives its place. */
static void keep_refused(struct spool *spool, uint64_t number)
{
	int least = 0;

	for (int i = 1; i < SPOOL_REFUSED; i++)
		if (spool->refused[i] < spool->refused[least])
			least = i;
	if (number < spool->refused[least]) {
		unlink_kind(spool, number, REFUSED);
		return;
	}
	if (spool->refused[least])
		unlink_kind(spool, spool->refused[least], REFUSED);
	spool->refused[least] = number;
}

static int take_file(struct spool *spool, const char *name)
{
	uint64_t lines = file_number(name, LINES), refused = file_number(name, REFUSED);
	uint64_t half = file_number(name, HALF), most = lines | refused | half;
	struct stat st;

	if (most >= spool->next)
		spool->next = most + 1;
	if (half)
		unlink_kind(spool, half, HALF);
	if (refused)
		keep_refused(spool, refused);
	if (!lines || fstatat(spool->dir, name, &st, AT_SYMLINK_NOFOLLOW) < 0 ||
	    !S_ISREG(st.st_mode))
		return 0;
	return spool_append(spool, lines, (uint64_t)st.st_size);
}

static int by_number(const void *a, const void *b)
{
	const struct spool_file *left = a, *right = b;

	return (left->number > right->number) - (left->number < right->number);
}

static int spool_look(struct spool *spool)
{
	int fd = openat(spool->dir, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC), err = 0;
	DIR *dir = fd < 0 ? NULL : fdopendir(fd);
	struct dirent *entry;

	if (!dir) {
		err = -errno;
		if (fd >= 0)
			close(fd);
		return err;
	}
	while (!err && (entry = readdir(dir)))
		err = take_file(spool, entry->d_name);
	closedir(dir);
	if (spool->end)
		qsort(spool->files, spool->end, sizeof(*spool->files), by_number);
	return err;
}

int spool_open(struct spool *spool, const char *path, uint64_t limit, const struct spool_disk *disk)
{
	int err = history_make_above(path);

	*spool = (struct spool){.disk = disk, .limit = limit, .next = 1, .lock = -1};
	spool->dir = err ? err : spool_disk_directory(path, 1);
	if (spool->dir < 0) {
		err = spool->dir;
		spool->dir = -1;
		return err;
	}
	spool->lock = history_lock(spool->dir);
	err = spool->lock < 0 ? spool->lock : spool_look(spool);
	if (err)
		spool_close(spool);
	return err;
}

void spool_close(struct spool *spool)
{
	if (spool->lock >= 0)
		close(spool->lock);
	if (spool->dir >= 0)
		close(spool->dir);
	spool->dir = spool->lock = -1;
	free(spool->files);
	spool->files = NULL;
	spool->first = spool->end = spool->room = 0;
}

size_t spool_count(const struct spool *spool)
{
	return spool->end - spool->first;
}

/* Write it under the name `half`, and give it its own when it is on the disk. */
static int write_file(struct spool *spool, const char *half, const char *name, const char *data,
                      size_t len)
{
	const struct spool_disk *disk = spool->disk;
	int fd = disk->open(disk->ctx, spool->dir, half, O_WRONLY | O_CREAT | O_TRUNC);
	int err;

	if (fd < 0)
		return fd;
	err = disk->pwrite(disk->ctx, fd, data, len, 0);
	if (!err)
		err = disk->sync(disk->ctx, fd);
	disk->close(disk->ctx, fd);
	if (!err)
		err = disk->rename(disk->ctx, spool->dir, half, name);
	return err ? err : disk->sync(disk->ctx, spool->dir);
}

static void drop_for(struct spool *spool, size_t len)
{
	struct spool_file added = {.size = (uint32_t)len};

	while (spool_count(spool) && spool->bytes + blocks(&added) > spool->limit) {
		spool->dropped += spool->files[spool->first].size;
		spool_remove(spool);
	}
}

int spool_put(struct spool *spool, const char *data, size_t len)
{
	char half[SPOOL_NAME], name[SPOOL_NAME];
	int err;

	if (spool->dir < 0)
		return -EBADF;
	drop_for(spool, len);
	make_name(half, spool->next, HALF);
	make_name(name, spool->next, LINES);
	err = write_file(spool, half, name, data, len);
	if (!err)
		err = spool_append(spool, spool->next, len);
	if (err) {
		unlink_kind(spool, spool->next, HALF);
		unlink_kind(spool, spool->next, LINES);
		return err;
	}
	spool->next++;
	return 0;
}

uint64_t spool_oldest(const struct spool *spool)
{
	return spool_count(spool) ? spool->files[spool->first].number : 0;
}

void spool_name(const struct spool *spool, char name[SPOOL_NAME])
{
	make_name(name, spool->files[spool->first].number, LINES);
}

int64_t spool_read(struct spool *spool, char *data, size_t size)
{
	const struct spool_disk *disk = spool->disk;
	char name[SPOOL_NAME];
	size_t len = 0;
	ssize_t n;
	int fd;

	spool_name(spool, name);
	fd = disk->open(disk->ctx, spool->dir, name, O_RDONLY);
	if (fd < 0)
		return fd;
	do {
		n = disk->pread(disk->ctx, fd, data + len, size - len, (off_t)len);
		len += n > 0 ? (size_t)n : 0;
	} while (n > 0 && len < size);
	disk->close(disk->ctx, fd);
	if (n < 0)
		return n;
	/* a batch is never as long as the room for one */
	return len < size ? (int64_t)len : -EFBIG;
}

/* The oldest one waits no more. */
static struct spool_file take_first(struct spool *spool)
{
	struct spool_file file = spool->files[spool->first++];

	spool->bytes -= blocks(&file);
	return file;
}

void spool_remove(struct spool *spool)
{
	struct spool_file file = take_first(spool);

	/* if its name comes back after a power cut, it is sent once more */
	unlink_kind(spool, file.number, LINES);
}

static int refuse_oldest(struct spool *spool, uint64_t *number)
{
	struct spool_file file = take_first(spool);
	char from[SPOOL_NAME], to[SPOOL_NAME];

	*number = file.number;
	make_name(from, file.number, LINES);
	make_name(to, file.number, REFUSED);
	return spool->disk->rename(spool->disk->ctx, spool->dir, from, to);
}

void spool_refuse(struct spool *spool, const char *data, size_t len)
{
	char half[SPOOL_NAME], to[SPOOL_NAME];
	uint64_t number = spool->next;
	int err;

	if (data) {
		make_name(half, number, HALF);
		make_name(to, number, REFUSED);
		spool->next++;
		err = spool->dir < 0 ? -EBADF : write_file(spool, half, to, data, len);
	} else {
		err = refuse_oldest(spool, &number);
	}
	if (!err)
		keep_refused(spool, number);
}
