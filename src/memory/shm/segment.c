/* SPDX-License-Identifier: MIT */
/*
 * The mapped files of an instance: made under a temporary name, shown, opened again, closed.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/owner.h"
#include "src/memory/shm/segment.h"

#define SEGMENT_MIN 256
#define SEGMENT_MAX 0x7fffffff

static const struct segment_role {
	const char *name, *group;
	mode_t mode;
} roles[] = {
	[SEGMENT_IMAGE] = {"image", "owsd", 0640},
	[SEGMENT_FORCE] = {"force", NULL, 0600},
};

bool segment_name_ok(const char *instance)
{
	size_t n = strlen(instance);

	if (n == 0 || n > SEGMENT_NAME_MAX || instance[0] == '.')
		return false;
	return strspn(instance, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
	                        "0123456789-_.") == n;
}

const char *segment_file(const char *instance, const char *what, char name[SEGMENT_FILE])
{
	snprintf(name, SEGMENT_FILE, "%.*s.%s", SEGMENT_NAME_MAX, instance, what);
	return name;
}

static const char *final_name(const char *instance, enum segment_kind kind, char name[SEGMENT_FILE])
{
	return segment_file(instance, roles[kind].name, name);
}

/*
 * Give the file to its group. Where that fails the mode is 0600, since the caller's own group may
 * have any members. Returns 0 or a negative errno.
 */
static int give_to_group(int fd, const struct segment_role *role)
{
	gid_t gid;

	if (role->group && owner_group(role->group, &gid) && fchown(fd, (uid_t)-1, gid) == 0)
		return fchmod(fd, role->mode) < 0 ? -errno : 0;
	return fchmod(fd, 0600) < 0 ? -errno : 0;
}

bool segment_leads_to(int directory, const char *name, int fd)
{
	struct stat ours, there;

	if (fstat(fd, &ours) < 0)
		return true;
	if (fstatat(directory, name, &there, AT_SYMLINK_NOFOLLOW) < 0)
		return errno != ENOENT;
	return ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
}

int segment_allocate(int fd, size_t size)
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

/* The lock is held, and no other process makes names there: a file of that name is a leftover. */
static int open_temporary(const char *instance, struct segment *segment)
{
	char what[12];

	snprintf(what, sizeof(what), "%s.new", roles[segment->kind].name);
	segment_file(instance, what, segment->temporary);
	unlinkat(segment->dir, segment->temporary, 0);
	segment->fd = openat(segment->dir, segment->temporary,
	                     O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (segment->fd >= 0)
		return 0;
	segment->temporary[0] = '\0'; /* owsd did not create it and must not remove it */
	return errno == EEXIST ? -EPERM : -errno;
}

int segment_create(const struct shm_dir *dir, const char *instance, enum segment_kind kind,
                   size_t size, struct segment *segment)
{
	int err;

	*segment = (struct segment){.fd = -1, .dir = dir->fd, .kind = kind, .size = size};
	if (!segment_name_ok(instance) || size < SEGMENT_MIN || size > SEGMENT_MAX)
		return -EINVAL;
	err = open_temporary(instance, segment);
	if (err)
		return err;
	err = segment_allocate(segment->fd, size);
	if (!err)
		err = map(segment);
	if (!err)
		err = give_to_group(segment->fd, &roles[kind]);
	if (err)
		segment_close(segment);
	return err;
}

/* Readers see the old file or the new one, and never a half one. */
int segment_show(const char *instance, struct segment *segment)
{
	char name[SEGMENT_FILE];

	if (segment->temporary[0] == '\0')
		return 0;
	final_name(instance, segment->kind, name);
	if (renameat(segment->dir, segment->temporary, segment->dir, name) < 0)
		return errno == EACCES ? -EPERM : -errno;
	segment->temporary[0] = '\0';
	return 0;
}

bool segment_named(const char *instance, const struct segment *segment)
{
	char name[SEGMENT_FILE];

	return segment->temporary[0] != '\0' ||
	       segment_leads_to(segment->dir, final_name(instance, segment->kind, name),
	                        segment->fd);
}

int segment_open_old(const struct shm_dir *dir, const char *instance, enum segment_kind kind,
                     struct segment *segment)
{
	struct stat st;
	char name[SEGMENT_FILE];
	int err;

	*segment = (struct segment){.fd = -1, .dir = dir->fd, .kind = kind};
	if (!segment_name_ok(instance))
		return -EINVAL;
	final_name(instance, kind, name);
	segment->fd = openat(dir->fd, name, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
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
	if (segment->base != NULL)
		munmap(segment->base, segment->size);
	if (segment->fd >= 0)
		close(segment->fd);
	if (segment->temporary[0] != '\0')
		unlinkat(segment->dir, segment->temporary, 0);
	segment->base = NULL;
	segment->fd = -1;
	segment->temporary[0] = '\0';
}
