/* SPDX-License-Identifier: MIT */
/* The directory of an instance's history. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/ground/signal/hash.h"
#include "src/history/file/place.h"

#define RECORDER "owsd-recorder"
#define WHAT "history"
#define LOCK "lock"

static const char *absolute(const char *name)
{
	const char *path = getenv(name);

	return path && path[0] == '/' && !strchr(path, ':') ? path : NULL;
}

static int of_service(const char *program, const char *instance, char path[HISTORY_PATH])
{
	int n = snprintf(path, HISTORY_PATH, "/var/lib/%s/%s", program, instance);

	return n < HISTORY_PATH ? 0 : -ENAMETOOLONG;
}

static int of_user(const char *program, const char *what, const char *instance,
                   char path[HISTORY_PATH])
{
	const char *state = absolute("XDG_STATE_HOME"), *home = absolute("HOME");
	int n;

	if (geteuid() == 0 || (!state && !home))
		return of_service(program, instance, path);
	n = snprintf(path, HISTORY_PATH, "%s%s/owsd/%s/%s", state ? state : home,
	             state ? "" : "/.local/state", what, instance);
	return n < HISTORY_PATH ? 0 : -ENAMETOOLONG;
}

int history_place_state(const char *program, const char *what, const char *instance,
                        char path[HISTORY_PATH])
{
	const char *service = absolute("STATE_DIRECTORY");
	size_t len = service ? strlen(service) : 0;

	if (!service)
		return of_user(program, what, instance, path);
	if (len >= HISTORY_PATH)
		return -ENAMETOOLONG;
	memcpy(path, service, len + 1);
	return 0;
}

int history_place(const char *instance, char path[HISTORY_PATH])
{
	return history_place_state(RECORDER, WHAT, instance, path);
}

int history_place_state_found(const char *program, const char *what, const char *instance,
                              char path[HISTORY_PATH])
{
	int err = of_user(program, what, instance, path);

	if (!err && access(path, F_OK) == 0)
		return 0;
	return of_service(program, instance, path);
}

int history_place_found(const char *instance, char path[HISTORY_PATH])
{
	return history_place_state_found(RECORDER, WHAT, instance, path);
}

int history_make_above(const char *path)
{
	char above[HISTORY_PATH];
	size_t len = strlen(path);

	if (len >= sizeof(above))
		return -ENAMETOOLONG;
	memcpy(above, path, len + 1);
	for (char *slash = strchr(above + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		if (mkdir(above, 0750) < 0 && errno != EEXIST && access(above, F_OK) < 0)
			return -errno;
		*slash = '/';
	}
	return 0;
}

int history_lock(const char *directory)
{
	int at = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC), fd, err = 0;
	struct stat seen;

	if (at < 0)
		return -errno;
	fd = openat(at, LOCK, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
	err = fd < 0 ? -errno : 0;
	close(at);
	if (fd < 0)
		return err;
	/* who may read a file or a directory may lock it: it would lock us out */
	if (fstat(fd, &seen) < 0 || (seen.st_mode & 077 && fchmod(fd, 0600) < 0) ||
	    flock(fd, LOCK_EX | LOCK_NB) < 0)
		err = errno == EWOULDBLOCK ? -EBUSY : -errno;
	if (!err)
		return fd;
	close(fd);
	return err;
}

int64_t history_boot_present(void)
{
	char id[64];
	int fd = open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC);
	ssize_t n = fd >= 0 ? read(fd, id, sizeof(id)) : 0, len = 0;
	uint64_t hash;

	if (fd >= 0)
		close(fd);
	while (len < n && id[len] != '\n')
		len++;
	hash = hash_text(HASH_BEGIN, id, (size_t)len);
	return (int64_t)(hash ? hash : 1);
}
