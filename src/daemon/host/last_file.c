/* SPDX-License-Identifier: MIT */
/* Reads and writes NAME.last, and finds its directory. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/file.h"
#include "src/config/edit/replace.h"
#include "src/daemon/host/last_file.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/owner.h"
#include "src/public/ows_layout.h"

#define SERVICE_STATE "/var/lib/owsd"
#define NAME_MAX_ 64

/* --- The directory ---------------------------------------------------------------------------- */

static int make_way(const char *base, const char *const *parts, unsigned count, char *path)
{
	int n = snprintf(path, LAST_WHERE, "%s", base);

	for (unsigned i = 0; i < count && n > 0 && n < LAST_WHERE; i++) {
		n += snprintf(path + n, (size_t)(LAST_WHERE - n), "/%s", parts[i]);
		if (n < LAST_WHERE && mkdir(path, 0700) < 0 && errno != EEXIST)
			return -errno;
	}
	return n > 0 && n < LAST_WHERE ? 0 : -ENAMETOOLONG;
}

static int find_directory(char *path)
{
	static const char *const below_home[] = {".local", "state", "owsd"};
	const char *named = getenv("OWS_STATE_DIR"), *state = getenv("XDG_STATE_HOME");
	const char *home = getenv("HOME");

	if (named && *named)
		return make_way(named, NULL, 0, path);
	if (geteuid() == 0 || owner_is_service())
		return make_way(SERVICE_STATE, NULL, 0, path);
	if (state && *state == '/')
		return make_way(state, &below_home[2], 1, path);
	return home && *home == '/' ? make_way(home, below_home, 3, path) : -ENOENT;
}

int last_directory(char path[LAST_WHERE])
{
	struct shm_dir directory = {.fd = -1};
	int err = find_directory(path);

	if (!err && mkdir(path, 0700) < 0 && errno != EEXIST)
		err = -errno;
	if (!err)
		err = dir_open(path, &directory);
	return err ? err : directory.fd;
}

/* --- The file --------------------------------------------------------------------------------- */

static int load_file(int directory, const char *name, char **text, size_t *size)
{
	int fd = openat(directory, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	struct stat st;
	int err = 0;

	*size = 0;
	*text = NULL;
	if (fd < 0)
		return -errno;
	if (fstat(fd, &st) < 0)
		err = -errno;
	else if (!S_ISREG(st.st_mode) || (uint64_t)st.st_size > LAST_MAX)
		err = -EBADMSG;
	else
		*text = file_whole(fd, LAST_MAX, size, &err);
	close(fd);
	return err;
}

int last_read(int directory, const char *instance, char **data, size_t *size)
{
	char name[NAME_MAX_];
	uint32_t check;
	int err;

	snprintf(name, sizeof(name), "%s.last", instance);
	err = load_file(directory, name, data, size);
	if (err)
		return err == -ENOENT ? 0 : err;
	*size = *size < LAST_CHECK ? 0 : *size - LAST_CHECK;
	if (*size) {
		memcpy(&check, *data + *size, LAST_CHECK);
		if (check == ows_check_bytes(*data, *size))
			return 0;
	}
	free(*data);
	*data = NULL;
	return -EBADMSG;
}

int last_write(int directory, const char *instance, char *data, size_t size)
{
	char name[NAME_MAX_], fresh[NAME_MAX_ + 4];
	uint32_t check;
	int fd, err;

	if (size > LAST_MAX - LAST_CHECK)
		return -EFBIG;
	check = ows_check_bytes(data, size);
	memcpy(data + size, &check, LAST_CHECK);
	snprintf(name, sizeof(name), "%s.last", instance);
	snprintf(fresh, sizeof(fresh), "%s.new", name);
	unlinkat(directory, fresh, 0);
	fd = openat(directory, fresh, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	err = fd < 0 ? -errno : replace_write(fd, data, size + LAST_CHECK);
	if (fd >= 0 && close(fd) < 0 && !err)
		err = -errno;
	if (!err && renameat(directory, fresh, directory, name) < 0)
		err = -errno;
	if (!err && fsync(directory) < 0)
		err = -errno;
	if (err && fd >= 0)
		unlinkat(directory, fresh, 0);
	return err;
}
