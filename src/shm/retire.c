/* SPDX-License-Identifier: MIT */
/* Retires the segments that an owsd of layout 1 has left in /dev/shm. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/shm/futex.h"
#include "src/shm/layout.h"
#include "src/shm/lock.h"
#include "src/shm/owner.h"
#include "src/shm/retire.h"
#include "src/shm/segment.h"

#define OLD_MAJOR 1
#define OLD_COMMAND_MAGIC 0x4353574fu
#define OLD_FILE (SEGMENT_FILE + 24)
#define PAGE 4096

/* Both headers of major version 1 begin so; the futex word that programs sleep on is at 128. */
struct old_header {
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;
	uint32_t generation;
	uint32_t state;
	uint32_t rest[59];
};
_Static_assert(sizeof(struct old_header) == 256, "the smallest segment of major version 1");
#define OLD_NEWS 128

static void old_name(const char *instance, const char *what, char name[OLD_FILE])
{
	snprintf(name, OLD_FILE, "owsd.%.*s.%s", SEGMENT_NAME_MAX, instance, what);
}

pid_t retire_running(const char *folder, const char *instance)
{
	int dir = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	char name[OLD_FILE];
	struct stat st;
	pid_t pid = 0;
	int held = 0;

	if (dir < 0)
		return 0;
	old_name(instance, "lock", name);
	if (fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(st.st_mode) &&
	    owner_trusted(st.st_uid) && !(st.st_mode & 0077))
		held = lock_look(dir, name, &pid);
	close(dir);
	return held > 0 ? pid : 0;
}

/*
 * A retired image would have good values for two seconds, a stopped one has none. One byte of the
 * state changes, so that a reader sees the one or the other. The file is written and not mapped:
 * who may write it could truncate it meanwhile.
 */
static int mark(int fd)
{
	uint32_t state = OWS_STATE_STOPPED;
	void *page;

	if (pwrite(fd, &state, sizeof(state), offsetof(struct old_header, state)) !=
	    (ssize_t)sizeof(state))
		return -EIO;
	page = mmap(NULL, PAGE, PROT_READ, MAP_SHARED, fd, 0);
	if (page == MAP_FAILED)
		return -errno;
	segment_wake((const uint32_t *)((const char *)page + OLD_NEWS), INT_MAX);
	munmap(page, PAGE);
	return 0;
}

/* The group of the old file may read the stub, and nobody but its owner may write it. */
static int fill_stub(int fd, const struct stat *old, uint32_t magic)
{
	const struct old_header stub = {
		.magic = magic,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.size = sizeof(stub),
		.state = OWS_STATE_STOPPED,
	};

	if (write(fd, &stub, sizeof(stub)) != (ssize_t)sizeof(stub))
		return -EIO;
	if ((old->st_mode & S_IRGRP) && fchown(fd, (uid_t)-1, old->st_gid) == 0)
		return fchmod(fd, 0640) < 0 ? -errno : 0;
	return 0;
}

/* Everybody may make names there: the temporary one cannot be predicted. */
static int replace(int dir, const char *name, const struct stat *old, uint32_t magic)
{
	char temporary[OLD_FILE + 16];
	uint32_t random;
	int fd, err;

	if (getrandom(&random, sizeof(random), 0) != (ssize_t)sizeof(random))
		return -EIO;
	snprintf(temporary, sizeof(temporary), "%s.%08x", name, (unsigned)random);
	fd = openat(dir, temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd < 0)
		return -errno;
	err = fill_stub(fd, old, magic);
	close(fd);
	if (!err && renameat(dir, temporary, dir, name) < 0)
		err = -errno;
	if (err)
		unlinkat(dir, temporary, 0);
	return err;
}

/* 1: retired; 0: there is nothing to retire; or a negative errno. */
static int retire(int dir, const char *name, uint32_t magic)
{
	struct old_header h;
	struct stat st;
	int err, fd;

	if (fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) < 0 || !S_ISREG(st.st_mode) ||
	    !owner_trusted(st.st_uid))
		return 0;
	fd = openat(dir, name, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return -errno;
	err = fstat(fd, &st) < 0 ? -errno : 0;
	if (err || !S_ISREG(st.st_mode) || !owner_trusted(st.st_uid) ||
	    pread(fd, &h, sizeof(h), 0) != (ssize_t)sizeof(h) || h.magic != magic ||
	    h.major != OLD_MAJOR) {
		close(fd);
		return err;
	}
	err = mark(fd);
	close(fd);
	if (!err)
		err = replace(dir, name, &st, magic);
	return err ? err : 1;
}

/* The image is the first that a program opens. */
int retire_segments(const char *folder, const char *instance)
{
	static const struct {
		const char *what;
		uint32_t magic;
	} old[] = {{"command", OLD_COMMAND_MAGIC}, {"image", OWS_IMAGE_MAGIC}};
	int dir = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), count = 0, err = 0;
	char name[OLD_FILE];

	if (dir < 0)
		return errno == ENOENT ? 0 : -errno;
	for (size_t i = 0; i < sizeof(old) / sizeof(old[0]); i++) {
		int done;

		old_name(instance, old[i].what, name);
		done = retire(dir, name, old[i].magic);
		if (done < 0)
			err = done;
		else
			count += done;
	}
	if (count && !retire_running(folder, instance)) {
		old_name(instance, "lock", name);
		unlinkat(dir, name, 0);
	}
	close(dir);
	return err ? err : count;
}
