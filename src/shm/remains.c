/* SPDX-License-Identifier: MIT */
/* The files that instances have in /dev/shm: found by their names, and removed under the lock. */
#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/shm/lock.h"
#include "src/shm/remains.h"

#define FOLDER "/dev/shm"
#define PREFIX "owsd."

/* The instance of a file's name, between "owsd." and the last dot. False: no file of an owsd. */
static bool instance_of(const char *file, char name[SEGMENT_NAME_MAX + 1])
{
	const char *end = strrchr(file, '.'), *begin = file + strlen(PREFIX);

	if (strncmp(file, PREFIX, strlen(PREFIX)) != 0 || !end || end <= begin ||
	    end - begin > SEGMENT_NAME_MAX)
		return false;
	if (strcmp(end, ".image") != 0 && strcmp(end, ".command") != 0 && strcmp(end, ".lock") != 0)
		return false;
	memcpy(name, begin, (size_t)(end - begin));
	name[end - begin] = '\0';
	return segment_name_ok(name);
}

static int by_name(const void *a, const void *b)
{
	return strcmp(a, b);
}

static void sort(struct remains *remains)
{
	unsigned kept = 0;

	if (!remains->count)
		return;
	qsort(remains->name, remains->count, sizeof(*remains->name), by_name);
	for (unsigned i = 1; i < remains->count; i++)
		if (strcmp(remains->name[kept], remains->name[i]) != 0)
			memmove(remains->name[++kept], remains->name[i], sizeof(*remains->name));
	remains->count = kept + 1;
}

int remains_list(struct remains *remains)
{
	DIR *folder = opendir(FOLDER);
	const struct dirent *entry;
	int err = 0;

	*remains = (struct remains){0};
	if (!folder)
		return -errno;
	while (!err && (entry = readdir(folder)) != NULL) {
		char name[SEGMENT_NAME_MAX + 1], (*more)[SEGMENT_NAME_MAX + 1];

		if (!instance_of(entry->d_name, name))
			continue;
		more = realloc(remains->name, (remains->count + 1) * sizeof(*more));
		if (!more) {
			err = -ENOMEM;
			break;
		}
		remains->name = more;
		memcpy(more[remains->count++], name, sizeof(name));
	}
	closedir(folder);
	if (err)
		remains_free(remains);
	sort(remains);
	return err;
}

void remains_free(struct remains *remains)
{
	free(remains->name);
	*remains = (struct remains){0};
}

/* The files of an instance but for its lock; a start that was killed leaves .new files. */
static int find_files(const char *instance, glob_t *found)
{
	static const char *const forms[] = {
		"image",
		"command",
		"image.new",
		"command.new",
		"image.new.????????",
		"command.new.????????",
	};
	char pattern[128];
	int err = 0;

	memset(found, 0, sizeof(*found));
	for (unsigned i = 0; i < sizeof(forms) / sizeof(forms[0]) && !err; i++) {
		snprintf(pattern, sizeof(pattern), FOLDER "/" PREFIX "%s.%s", instance, forms[i]);
		err = glob(pattern, i ? GLOB_APPEND : 0, NULL, found);
		if (err == GLOB_NOMATCH)
			err = 0;
	}
	/* the alarms that this user's owsctl has seen; other users remove their own file */
	snprintf(pattern, sizeof(pattern), FOLDER "/" PREFIX "%s.seen.%u", instance,
	         (unsigned)geteuid());
	if (!err)
		err = glob(pattern, GLOB_APPEND, NULL, found);
	return err && err != GLOB_NOMATCH ? -ENOMEM : 0;
}

static int remove_file(const char *path, unsigned *files)
{
	if (unlink(path) == 0 || (errno == EISDIR && rmdir(path) == 0))
		++*files;
	else if (errno != ENOENT)
		return -errno;
	return 0;
}

/* The lock is the last: as long as it exists, no owsd creates the files that are being removed. */
static int remove_all(const char *instance, const glob_t *found, bool lock_is_new, unsigned *files)
{
	char path[128];
	int err = 0;

	for (size_t i = 0; i < found->gl_pathc && !err; i++)
		err = remove_file(found->gl_pathv[i], files);
	snprintf(path, sizeof(path), FOLDER "/" PREFIX "%s.lock", instance);
	if (lock_is_new)
		unlink(path);
	else if (!err)
		err = remove_file(path, files);
	return err;
}

int remains_remove(const char *instance, pid_t *pid, unsigned *files)
{
	glob_t found;
	bool stolen;
	int lock = segment_lock_any(instance, pid), err;
	bool has_none = lock == -ENOENT;

	*files = 0;
	/*
	 * a directory or socket in place of the lock keeps every owsd of this name from starting
	 * too
	 */
	if (lock < 0 && !has_none && lock != -EPERM)
		return lock;
	err = find_files(instance, &found);
	if (!err && has_none) {
		lock = found.gl_pathc ? segment_lock(instance, pid, &stolen) : -ENOENT;
		err = lock < 0 ? lock : 0;
	}
	if (!err)
		err = remove_all(instance, &found, has_none, files);
	globfree(&found);
	if (lock >= 0)
		close(lock);
	return err;
}
