/* SPDX-License-Identifier: MIT */
/* A file system of SQLite over that of the machine, which notes what changes files. */
#include "tests/unit/aid/power_file.h"

#include <sqlite3.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "unity.h"

#define SECTOR 512u

enum { DATABASE, LOG, JOURNAL, KINDS, OTHER };
static const char *const endings[KINDS] = {"", "-wal", "-journal"};

enum deed { MADE, WRITTEN, TRUNCATED, SYNCED, DELETED };
struct step {
	enum deed deed;
	int kind;
	size_t at, len; /* truncated: to len; deleted: len 1 if that is synced */
	char *data;
};
static struct step *steps;
static size_t count, room;

/* SQLite's object for an open file; that of the machine's file system follows it. */
struct file {
	sqlite3_file base;
	int kind;
};

static sqlite3_vfs ours, *machine;

static sqlite3_file *below(sqlite3_file *file)
{
	return (sqlite3_file *)((struct file *)file + 1);
}

static void note(enum deed deed, int kind, size_t at, size_t len, const void *data)
{
	if (kind == OTHER)
		return;
	if (count == room) {
		room = room ? 2 * room : 1024;
		steps = realloc(steps, room * sizeof(*steps));
		TEST_ASSERT_NOT_NULL(steps);
	}
	steps[count] = (struct step){.deed = deed, .kind = kind, .at = at, .len = len};
	if (data) {
		steps[count].data = malloc(len);
		TEST_ASSERT_NOT_NULL(steps[count].data);
		memcpy(steps[count].data, data, len);
	}
	count++;
}

/* --- A file ----------------------------------------------------------------------------------- */

static int file_close(sqlite3_file *f)
{
	return below(f)->pMethods->xClose(below(f));
}

static int file_read(sqlite3_file *f, void *data, int len, sqlite3_int64 at)
{
	return below(f)->pMethods->xRead(below(f), data, len, at);
}

static int file_write(sqlite3_file *f, const void *data, int len, sqlite3_int64 at)
{
	note(WRITTEN, ((struct file *)f)->kind, (size_t)at, (size_t)len, data);
	return below(f)->pMethods->xWrite(below(f), data, len, at);
}

static int file_truncate(sqlite3_file *f, sqlite3_int64 size)
{
	note(TRUNCATED, ((struct file *)f)->kind, 0, (size_t)size, NULL);
	return below(f)->pMethods->xTruncate(below(f), size);
}

static int file_sync(sqlite3_file *f, int flags)
{
	note(SYNCED, ((struct file *)f)->kind, 0, 0, NULL);
	return below(f)->pMethods->xSync(below(f), flags);
}

static int file_size(sqlite3_file *f, sqlite3_int64 *size)
{
	return below(f)->pMethods->xFileSize(below(f), size);
}

static int file_lock(sqlite3_file *f, int lock)
{
	return below(f)->pMethods->xLock(below(f), lock);
}

static int file_unlock(sqlite3_file *f, int lock)
{
	return below(f)->pMethods->xUnlock(below(f), lock);
}

static int file_locked(sqlite3_file *f, int *is)
{
	return below(f)->pMethods->xCheckReservedLock(below(f), is);
}

static int file_control(sqlite3_file *f, int what, void *with)
{
	return below(f)->pMethods->xFileControl(below(f), what, with);
}

static int file_sector(sqlite3_file *f)
{
	return below(f)->pMethods->xSectorSize(below(f));
}

static int file_traits(sqlite3_file *f)
{
	return below(f)->pMethods->xDeviceCharacteristics(below(f));
}

static int file_map(sqlite3_file *f, int page, int size, int extend, void volatile **memory)
{
	return below(f)->pMethods->xShmMap(below(f), page, size, extend, memory);
}

static int file_shm_lock(sqlite3_file *f, int offset, int n, int flags)
{
	return below(f)->pMethods->xShmLock(below(f), offset, n, flags);
}

static void file_barrier(sqlite3_file *f)
{
	below(f)->pMethods->xShmBarrier(below(f));
}

static int file_unmap(sqlite3_file *f, int forget)
{
	return below(f)->pMethods->xShmUnmap(below(f), forget);
}

static const sqlite3_io_methods methods = {
	2,           file_close, file_read,     file_write,   file_truncate, file_sync,
	file_size,   file_lock,  file_unlock,   file_locked,  file_control,  file_sector,
	file_traits, file_map,   file_shm_lock, file_barrier, file_unmap,    NULL,
	NULL,
};

/* --- The file system -------------------------------------------------------------------------- */

static int ours_open(sqlite3_vfs *vfs, sqlite3_filename name, sqlite3_file *f, int flags, int *got)
{
	struct file *file = (struct file *)f;
	int there = 0, err;

	(void)vfs;
	file->base.pMethods = NULL;
	file->kind = flags & SQLITE_OPEN_MAIN_DB        ? DATABASE
	             : flags & SQLITE_OPEN_WAL          ? LOG
	             : flags & SQLITE_OPEN_MAIN_JOURNAL ? JOURNAL
	                                                : OTHER;
	if (file->kind != OTHER)
		machine->xAccess(machine, name, SQLITE_ACCESS_EXISTS, &there);
	err = machine->xOpen(machine, name, below(f), flags, got);
	if (below(f)->pMethods)
		file->base.pMethods = &methods;
	/* that of the database is made before SQLite opens it */
	if (!err && (!there || file->kind == DATABASE))
		note(MADE, file->kind, 0, 0, NULL);
	return err;
}

static int ours_delete(sqlite3_vfs *vfs, const char *name, int synced)
{
	(void)vfs;
	for (int i = KINDS - 1; i > 0; i--) {
		size_t len = strlen(name), end = strlen(endings[i]);

		if (len > end && !strcmp(name + len - end, endings[i]))
			note(DELETED, i, 0, synced ? 1 : 0, NULL);
	}
	return machine->xDelete(machine, name, synced);
}

void power_file_begin(void)
{
	for (size_t i = 0; i < count; i++)
		free(steps[i].data);
	count = 0;
	machine = sqlite3_vfs_find(NULL);
	ours = *machine;
	ours.zName = "power";
	ours.pNext = NULL;
	ours.szOsFile += (int)sizeof(struct file);
	ours.xOpen = ours_open;
	ours.xDelete = ours_delete;
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_vfs_register(&ours, 1));
}

void power_file_end(void)
{
	sqlite3_vfs_unregister(&ours);
	sqlite3_vfs_register(machine, 1);
}

size_t power_file_steps(void)
{
	return count;
}

/* --- What is left ----------------------------------------------------------------------------- */

struct image {
	char *data;
	size_t size, room;
	bool there;
};

static void resize(struct image *image, size_t size)
{
	if (size > image->room) {
		image->room = 2 * size;
		image->data = realloc(image->data, image->room);
		TEST_ASSERT_NOT_NULL(image->data);
	}
	if (size > image->size)
		memset(image->data + image->size, 0, size - image->size);
	image->size = size;
}

/* Each sector of what was written, or by chance. */
static void write_sectors(struct image *image, const struct step *step,
                          unsigned (*random)(unsigned below))
{
	size_t at = step->at, end = step->at + step->len;

	while (at < end) {
		size_t next = (at / SECTOR + 1) * SECTOR;

		next = next < end ? next : end;
		if (!random || random(2)) {
			resize(image, image->size > next ? image->size : next);
			memcpy(image->data + at, step->data + (at - step->at), next - at);
		}
		at = next;
	}
}

/* random NULL: it is on the disk. */
static void apply(struct image *image, const struct step *step, unsigned (*random)(unsigned below))
{
	bool whole = !random || random(3) == 0;

	switch (step->deed) {
	case MADE:
		image->there = true;
		break;
	case WRITTEN:
		write_sectors(image, step, whole ? NULL : random);
		break;
	case TRUNCATED:
		if (whole || random(2))
			resize(image, step->len);
		break;
	case DELETED:
		if (step->len || whole || random(2))
			*image = (struct image){.data = image->data, .room = image->room};
		break;
	case SYNCED:
		break;
	}
}

void power_file_cut(const char *directory, const char *name, size_t step,
                    unsigned (*random)(unsigned below))
{
	static struct image images[KINDS];
	size_t synced[KINDS] = {0};

	for (size_t i = 0; i < step; i++)
		if (steps[i].deed == SYNCED)
			synced[steps[i].kind] = i;
	for (int i = 0; i < KINDS; i++)
		images[i] = (struct image){.data = images[i].data, .room = images[i].room};
	for (size_t i = 0; i <= step && i < count; i++)
		apply(&images[steps[i].kind], &steps[i], i < synced[steps[i].kind] ? NULL : random);
	mkdir(directory, 0750);
	for (int i = 0; i < KINDS; i++) {
		char path[512];
		FILE *file;

		snprintf(path, sizeof(path), "%s/%s%s", directory, name, endings[i]);
		file = images[i].there ? fopen(path, "wb") : NULL;
		TEST_ASSERT_EQUAL_INT(images[i].there, file != NULL);
		if (!file)
			continue;
		TEST_ASSERT_EQUAL_size_t(images[i].size,
		                         fwrite(images[i].data, 1, images[i].size, file));
		TEST_ASSERT_EQUAL_INT(0, fclose(file));
	}
}
