/* SPDX-License-Identifier: MIT */
/* The files that instances have in their directory, found by name and removed under the lock. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/memory/shm/lock.h"
#include "src/memory/shm/remains.h"

/* The instance of a file's name, before the last dot. False: no file of an owsd. */
static bool instance_of(const char *file, char name[SEGMENT_NAME_MAX + 1])
{
	static const char *const kinds[] = {".image", ".force", ".control", ".sock", ".lock"};
	const char *end = strrchr(file, '.');
	bool ours = false;

	if (!end || end == file || end - file > SEGMENT_NAME_MAX)
		return false;
	for (unsigned i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
		ours |= strcmp(end, kinds[i]) == 0;
	memcpy(name, file, (size_t)(end - file));
	name[end - file] = '\0';
	return ours && segment_name_ok(name);
}

static int compare_instances(const void *a, const void *b)
{
	return strcmp(a, b);
}

static void sort_instances(struct remains *remains)
{
	unsigned kept = 0;

	if (!remains->count)
		return;
	qsort(remains->name, remains->count, sizeof(*remains->name), compare_instances);
	for (unsigned i = 1; i < remains->count; i++)
		if (strcmp(remains->name[kept], remains->name[i]) != 0)
			memmove(remains->name[++kept], remains->name[i], sizeof(*remains->name));
	remains->count = kept + 1;
}

int remains_list(const struct shm_dir *dir, struct remains *remains)
{
	int fd = openat(dir->fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *folder = fd < 0 ? NULL : fdopendir(fd);
	const struct dirent *entry;
	int err = 0;

	*remains = (struct remains){0};
	if (!folder) {
		err = -errno;
		if (fd >= 0)
			close(fd);
		return err;
	}
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
	sort_instances(remains);
	return err;
}

void remains_free(struct remains *remains)
{
	free(remains->name);
	*remains = (struct remains){0};
}

/* A start that was killed leaves .new files. */
static const char *const others[] = {
	"image", "force", "control", "sock", "image.new", "force.new",
};
#define OTHERS (sizeof(others) / sizeof(others[0]))

static bool has_other(const struct shm_dir *dir, const char *instance)
{
	char name[SEGMENT_FILE];
	bool has = false;

	for (unsigned i = 0; i < OTHERS && !has; i++)
		has = faccessat(dir->fd, segment_file(instance, others[i], name), F_OK,
		                AT_SYMLINK_NOFOLLOW) == 0;
	return has;
}

static int remove_file(const struct shm_dir *dir, const char *instance, const char *what,
                       unsigned *files)
{
	char name[SEGMENT_FILE];

	segment_file(instance, what, name);
	if (unlinkat(dir->fd, name, 0) == 0 ||
	    (errno == EISDIR && unlinkat(dir->fd, name, AT_REMOVEDIR) == 0))
		++*files;
	else if (errno != ENOENT)
		return -errno;
	return 0;
}

/* The lock is the last: as long as it exists, no owsd creates the files that are being removed. */
static int remove_all(const struct shm_dir *dir, const char *instance, bool lock_is_new,
                      unsigned *files)
{
	unsigned locks = 0;
	int err = 0;

	for (unsigned i = 0; i < OTHERS && !err; i++)
		err = remove_file(dir, instance, others[i], files);
	if (lock_is_new)
		remove_file(dir, instance, "lock", &locks);
	else if (!err)
		err = remove_file(dir, instance, "lock", files);
	return err;
}

int remains_remove(const struct shm_dir *dir, const char *instance, pid_t *pid, unsigned *files)
{
	bool stolen;
	int lock = segment_lock_any(dir, instance, pid), err;
	bool has_none = lock == -ENOENT;

	*files = 0;
	/*
	 * a directory or socket in place of the lock keeps every owsd of this name from starting
	 * too
	 */
	if (lock < 0 && !has_none && lock != -EPERM)
		return lock;
	if (has_none) {
		lock = has_other(dir, instance) ? segment_lock(dir, instance, pid, &stolen)
		                                : -ENOENT;
		if (lock < 0)
			return lock;
	}
	err = remove_all(dir, instance, has_none, files);
	if (lock >= 0)
		close(lock);
	return err;
}
