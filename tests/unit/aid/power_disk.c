/* SPDX-License-Identifier: MIT */
/* A disk that notes what is asked of it, and what a power cut leaves of that. */
#include "tests/unit/aid/power_disk.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

uint64_t power_random(uint64_t *seed)
{
	*seed ^= *seed << 13;
	*seed ^= *seed >> 7;
	*seed ^= *seed << 17;
	return *seed;
}

static int file_named(const struct power_disk *power, const char *name)
{
	for (int i = 0; i < power->files; i++)
		if (strcmp(power->names[i], name) == 0)
			return i;
	return -1;
}

static int file_open(const struct power_disk *power, int fd)
{
	for (int i = 0; i < POWER_FILES; i++)
		if (power->open[i].fd == fd)
			return power->open[i].file;
	return -1;
}

static struct power_op *note(struct power_disk *power, int what, int file)
{
	struct power_op *op = &power->ops[power->count++];

	TEST_ASSERT_TRUE(power->count < POWER_OPS);
	*op = (struct power_op){.what = what, .file = file};
	return op;
}

static int fails(struct power_disk *power)
{
	if (power->fail_after < 0)
		return 0;
	if (power->fail_after == 0)
		return power->fail_with;
	power->fail_after--;
	return 0;
}

static int p_open(void *ctx, int dir, const char *name, int flags)
{
	struct power_disk *power = ctx;
	int fd, file = file_named(power, name);

	if (power->fail_open && power->fail_after == 0)
		return power->fail_with;
	fd = spool_disk_system.open(NULL, dir, name, flags);
	if (fd < 0)
		return fd;
	if (file < 0) {
		file = power->files++;
		TEST_ASSERT_TRUE(power->files < POWER_FILES);
		snprintf(power->names[file], sizeof(power->names[file]), "%s", name);
		snprintf(note(power, POWER_CREATE, file)->name, 64, "%s", name);
	} else if (flags & O_TRUNC) {
		note(power, POWER_TRUNCATE, file);
	}
	for (int i = 0; i < POWER_FILES; i++)
		if (power->open[i].fd < 0) {
			power->open[i].fd = fd;
			power->open[i].file = file;
			break;
		}
	return fd;
}

static ssize_t p_pread(void *ctx, int fd, void *data, size_t size, off_t at)
{
	struct power_disk *power = ctx;

	if (power->fail_read && at == (off_t)(power->fail_read - 1) * 4096)
		return -EIO;
	if (power->fail_reads_after == 0)
		return power->fail_reads_with;
	if (power->fail_reads_after > 0)
		power->fail_reads_after--;
	return spool_disk_system.pread(NULL, fd, data, size, at);
}

static int p_pwrite(void *ctx, int fd, const void *data, size_t size, off_t at)
{
	struct power_disk *power = ctx;
	int err = fails(power);
	struct power_op *op;

	/* a full disk takes a part */
	if (err && size > POWER_SECTOR)
		size = POWER_SECTOR;
	op = note(power, POWER_WRITE, file_open(power, fd));
	op->at = (uint64_t)at;
	op->size = size;
	op->data = malloc(size ? size : 1);
	TEST_ASSERT_NOT_NULL(op->data);
	memcpy(op->data, data, size);
	spool_disk_system.pwrite(NULL, fd, data, size, at);
	return err;
}

static int p_sync(void *ctx, int fd)
{
	struct power_disk *power = ctx;
	int err = fails(power), file = file_open(power, fd);

	if (err)
		return err;
	note(power, file < 0 ? POWER_SYNC_NAMES : POWER_SYNC, file);
	return 0;
}

static int p_truncate(void *ctx, int fd, off_t size)
{
	struct power_disk *power = ctx;

	note(power, POWER_TRUNCATE, file_open(power, fd))->at = (uint64_t)size;
	return spool_disk_system.truncate(NULL, fd, size);
}

static int p_rename(void *ctx, int dir, const char *from, const char *to)
{
	struct power_disk *power = ctx;
	int file = file_named(power, from);

	TEST_ASSERT_TRUE(file >= 0);
	snprintf(power->names[file], sizeof(power->names[file]), "%s", to);
	snprintf(note(power, POWER_RENAME, file)->name, 64, "%s", to);
	return spool_disk_system.rename(NULL, dir, from, to);
}

static int p_unlink(void *ctx, int dir, const char *name)
{
	struct power_disk *power = ctx;
	int file = file_named(power, name);

	if (file >= 0) {
		power->names[file][0] = '\0';
		note(power, POWER_UNLINK, file);
	}
	return spool_disk_system.unlink(NULL, dir, name);
}

static void p_close(void *ctx, int fd)
{
	struct power_disk *power = ctx;

	for (int i = 0; i < POWER_FILES; i++)
		if (power->open[i].fd == fd)
			power->open[i].fd = -1;
	spool_disk_system.close(NULL, fd);
}

static int64_t p_free(void *ctx, int dir)
{
	const struct power_disk *power = ctx;

	(void)dir;
	return power->free;
}

void power_init(struct power_disk *power)
{
	memset(power, 0, sizeof(*power));
	power->disk = (struct spool_disk){
		.ctx = power,
		.open = p_open,
		.pread = p_pread,
		.pwrite = p_pwrite,
		.sync = p_sync,
		.truncate = p_truncate,
		.rename = p_rename,
		.unlink = p_unlink,
		.close = p_close,
		.free = p_free,
	};
	power->fail_after = power->fail_reads_after = -1;
	power->free = INT64_MAX;
	for (int i = 0; i < POWER_FILES; i++)
		power->open[i].fd = -1;
}

static void take_file(struct power_disk *power, int dir, const char *name)
{
	int fd = spool_disk_system.open(NULL, dir, name, O_RDONLY), file = power->files++;
	struct power_op *op;
	struct stat st;

	TEST_ASSERT_TRUE(fd >= 0 && fstat(fd, &st) == 0 && power->files < POWER_FILES);
	TEST_ASSERT_TRUE(strlen(name) < sizeof(power->names[file]));
	memcpy(power->names[file], name, strlen(name) + 1);
	memcpy(note(power, POWER_CREATE, file)->name, power->names[file], sizeof(op->name));
	op = note(power, POWER_WRITE, file);
	op->size = (size_t)st.st_size;
	op->data = malloc(op->size + 1);
	TEST_ASSERT_NOT_NULL(op->data);
	TEST_ASSERT_EQUAL_INT64(st.st_size,
	                        spool_disk_system.pread(NULL, fd, op->data, op->size, 0));
	note(power, POWER_SYNC, file);
	spool_disk_system.close(NULL, fd);
}

int power_take(struct power_disk *power, const char *from)
{
	DIR *dir = opendir(from);
	struct dirent *found;

	TEST_ASSERT_NOT_NULL(dir);
	while ((found = readdir(dir)))
		if (found->d_name[0] != '.')
			take_file(power, dirfd(dir), found->d_name);
	closedir(dir);
	note(power, POWER_SYNC_NAMES, -1);
	return power->count;
}

void power_free(struct power_disk *power)
{
	for (int i = 0; i < power->count; i++)
		free(power->ops[i].data);
	power->count = 0;
}

/* --- What is left ---------------------------------------------------------------------------- */

struct image {
	uint8_t *data;
	uint64_t size, room;
	char name[64];
};

static void put(struct image *image, uint64_t at, const uint8_t *data, size_t size)
{
	if (at + size > image->room) {
		image->room = 2 * (at + size);
		image->data = realloc(image->data, image->room);
		TEST_ASSERT_NOT_NULL(image->data);
	}
	if (at > image->size)
		memset(image->data + image->size, 0, at - image->size);
	memcpy(image->data + at, data, size);
	if (at + size > image->size)
		image->size = at + size;
}

/* A write that was not synced: all of it, nothing, its first sectors, or some of them. */
static void put_some(struct image *image, const struct power_op *op, uint64_t *seed)
{
	uint64_t way = power_random(seed) % 4;
	size_t sectors = (op->size + POWER_SECTOR - 1) / POWER_SECTOR;
	size_t first = way == 0 ? sectors : way == 1 ? 0 : power_random(seed) % (sectors + 1);

	for (size_t i = 0; i < sectors; i++) {
		size_t from = i * POWER_SECTOR;
		size_t size = op->size - from < POWER_SECTOR ? op->size - from : POWER_SECTOR;

		if (way == 3 ? power_random(seed) % 2 : i < first)
			put(image, op->at + from, op->data + from, size);
	}
}

static void empty(const char *path)
{
	DIR *dir = opendir(path);
	struct dirent *found;

	TEST_ASSERT_NOT_NULL(dir);
	while ((found = readdir(dir)))
		if (found->d_name[0] != '.')
			unlinkat(dirfd(dir), found->d_name, 0);
	closedir(dir);
}

static void apply_names(const struct power_disk *power, int until, struct image *images)
{
	for (int i = 0; i < until; i++) {
		const struct power_op *op = &power->ops[i];

		if (op->what == POWER_CREATE || op->what == POWER_RENAME)
			memcpy(images[op->file].name, op->name, sizeof(op->name));
		else if (op->what == POWER_UNLINK)
			images[op->file].name[0] = '\0';
	}
}

void power_cut(const struct power_disk *power, int cut, uint64_t *seed, const char *to)
{
	struct image images[POWER_FILES] = {0};
	int synced[POWER_FILES] = {0}, names = 0;

	for (int i = 0; i < cut; i++) {
		if (power->ops[i].what == POWER_SYNC)
			synced[power->ops[i].file] = i;
		else if (power->ops[i].what == POWER_SYNC_NAMES)
			names = i;
	}
	apply_names(power, names + (int)(power_random(seed) % (uint64_t)(cut - names + 1)), images);
	for (int i = 0; i < cut; i++) {
		const struct power_op *op = &power->ops[i];

		if (op->what == POWER_TRUNCATE &&
		    (i < synced[op->file] || power_random(seed) % 2)) {
			if (op->at < images[op->file].size)
				images[op->file].size = op->at;
		} else if (op->what == POWER_WRITE && i < synced[op->file]) {
			put(&images[op->file], op->at, op->data, op->size);
		} else if (op->what == POWER_WRITE) {
			put_some(&images[op->file], op, seed);
		}
	}
	empty(to);
	for (int i = 0; i < POWER_FILES; i++) {
		if (images[i].name[0]) {
			char path[512];
			FILE *out;

			snprintf(path, sizeof(path), "%s/%s", to, images[i].name);
			out = fopen(path, "w");
			TEST_ASSERT_NOT_NULL(out);
			if (images[i].size)
				TEST_ASSERT_EQUAL_size_t(
					images[i].size,
					fwrite(images[i].data, 1, images[i].size, out));
			fclose(out);
		}
		free(images[i].data);
	}
}
