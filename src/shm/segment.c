/* SPDX-License-Identifier: MIT */
/*
 * The files of an instance in /dev/shm: made under a temporary name, shown, opened again, closed.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/shm/guard.h"
#include "src/shm/owner.h"
#include "src/shm/segment.h"

#define SEGMENT_MIN 256
#define SEGMENT_MAX 0x7fffffff
#define NAME_TRIES 16

static const struct segment_role {
	const char *name, *group;
	mode_t mode;
} roles[] = {
	[SEGMENT_IMAGE] = {"image", "owsd", 0640},
	[SEGMENT_COMMAND] = {"command", "owsd-control", 0660},
};

bool segment_name_ok(const char *instance)
{
	size_t n = strlen(instance);

	if (n == 0 || n > SEGMENT_NAME_MAX || instance[0] == '.')
		return false;
	return strspn(instance, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
	                        "0123456789-_.") == n;
}

/* shm_open() of glibc and musl means the same files, but has no rename. */
static void final_path(const char *instance, enum segment_kind kind, char path[80])
{
	snprintf(path, 80, "/dev/shm/owsd.%s.%s", instance, roles[kind].name);
}

/*
 * Give the file to its group. Where that fails the mode is 0600, since the caller's own group may
 * have any members. Returns 0 or a negative errno.
 */
static int give_to_group(int fd, const struct segment_role *role)
{
	gid_t gid;

	if (owner_group(role->group, &gid) && fchown(fd, (uid_t)-1, gid) == 0)
		return fchmod(fd, role->mode) < 0 ? -errno : 0;
	return fchmod(fd, 0600) < 0 ? -errno : 0;
}

static int allocate(int fd, size_t size)
{
	int err;

	do {
		err = posix_fallocate(fd, 0, (off_t)size);
	} while (err == EINTR);
	return -err;
}

static int map(struct segment *segment)
{
	void *base = mmap(NULL, segment->size, PROT_READ | PROT_WRITE, MAP_SHARED, segment->fd, 0);

	if (base == MAP_FAILED)
		return -errno;
	segment->base = base;
	return 0;
}

/*
 * The first name tried is always the same, so that the next start removes what a killed owsd left.
 * Any user can take that name; the names tried after it cannot be predicted.
 */
static int open_temporary(const char *instance, struct segment *segment)
{
	char path[80], suffix[12] = "";
	uint32_t random;

	final_path(instance, segment->kind, path);
	for (int i = 0; i < NAME_TRIES; i++) {
		snprintf(segment->temporary, sizeof(segment->temporary), "%.60s.new%s", path,
		         suffix);
		if (i == 0)
			unlink(segment->temporary); /* the lock is held: the file is a leftover */
		segment->fd = open(segment->temporary,
		                   O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
		if (segment->fd >= 0)
			return 0;
		if (errno != EEXIST)
			break;
		if (getrandom(&random, sizeof(random), 0) != (ssize_t)sizeof(random))
			break;
		snprintf(suffix, sizeof(suffix), ".%08x", (unsigned)random);
	}
	segment->temporary[0] = '\0'; /* owsd did not create it and must not remove it */
	return errno == EEXIST ? -EPERM : -errno;
}

int segment_create(const char *instance, enum segment_kind kind, size_t size,
                   struct segment *segment)
{
	int err;

	*segment = (struct segment){.fd = -1, .kind = kind, .size = size};
	if (!segment_name_ok(instance) || size < SEGMENT_MIN || size > SEGMENT_MAX)
		return -EINVAL;
	err = open_temporary(instance, segment);
	if (err)
		return err;
	err = allocate(segment->fd, size);
	if (!err)
		err = map(segment);
	if (!err)
		err = give_to_group(segment->fd, &roles[kind]);
	if (err)
		segment_close(segment);
	return err;
}

int segment_show(const char *instance, struct segment *segment)
{
	char path[80];

	if (segment->temporary[0] == '\0')
		return 0;
	final_path(instance, segment->kind, path);
	if (rename(segment->temporary, path) < 0)
		return errno == EACCES ? -EPERM : -errno;
	segment->temporary[0] = '\0';
	return 0;
}

bool segment_named(const char *instance, const struct segment *segment)
{
	struct stat ours, there;
	char path[80];

	if (segment->temporary[0] != '\0' || fstat(segment->fd, &ours) < 0)
		return true;
	final_path(instance, segment->kind, path);
	if (lstat(path, &there) < 0)
		return errno != ENOENT;
	return ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
}

int segment_open_old(const char *instance, enum segment_kind kind, struct segment *segment)
{
	struct stat st;
	char path[80];
	int err;

	*segment = (struct segment){.fd = -1, .kind = kind};
	if (!segment_name_ok(instance))
		return -EINVAL;
	final_path(instance, kind, path);
	segment->fd = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
	if (segment->fd < 0)
		return errno == EACCES || errno == ELOOP ? -EPERM : -errno;
	if (fstat(segment->fd, &st) < 0)
		err = -errno;
	else if (!S_ISREG(st.st_mode) || !owner_trusted(st.st_uid))
		err = -EPERM;
	else if (st.st_size < SEGMENT_MIN || st.st_size > SEGMENT_MAX)
		err = -EPROTO;
	else
		err = 0;
	if (!err) {
		segment->size = (size_t)st.st_size;
		err = map(segment);
	}
	if (err)
		segment_close(segment);
	return err;
}

void segment_close(struct segment *segment)
{
	segment_unguard(segment);
	if (segment->base != NULL)
		munmap(segment->base, segment->size);
	if (segment->fd >= 0)
		close(segment->fd);
	if (segment->temporary[0] != '\0')
		unlink(segment->temporary);
	segment->base = NULL;
	segment->fd = -1;
	segment->temporary[0] = '\0';
}

int segment_remove(const char *instance, enum segment_kind kind)
{
	char path[80];

	if (!segment_name_ok(instance))
		return -EINVAL;
	final_path(instance, kind, path);
	return unlink(path) < 0 ? -errno : 0;
}

int segment_guard(struct segment *segment)
{
	return guard_add(segment->base, segment->size, false);
}

void segment_unguard(struct segment *segment)
{
	guard_remove(segment->base);
}

bool segment_lost(const struct segment *segment)
{
	struct stat st;

	if (guard_lost(segment->base))
		return true;
	return fstat(segment->fd, &st) == 0 && (size_t)st.st_size != segment->size;
}
