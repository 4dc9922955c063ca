/* SPDX-License-Identifier: MIT */
/* The files of the page. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/faces/web/files.h"

static const struct {
	const char *end, *type;
} types[] = {
	{".html", "text/html; charset=utf-8"},
	{".css", "text/css; charset=utf-8"},
	{".js", "text/javascript; charset=utf-8"},
	{".svg", "image/svg+xml"},
	{".png", "image/png"},
	{".ico", "image/x-icon"},
	{".webmanifest", "application/manifest+json"},
};

static const char *type_of(const char *name)
{
	size_t len = strlen(name);

	for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
		size_t end = strlen(types[i].end);

		if (len > end && strcmp(name + len - end, types[i].end) == 0)
			return types[i].type;
	}
	return NULL;
}

/* No name of another directory, and none that is hidden. */
static bool is_plain(const char *name)
{
	for (const char *at = name; *at; at++)
		if (!((*at >= '0' && *at <= '9') || (*at >= 'a' && *at <= 'z') ||
		      (*at >= 'A' && *at <= 'Z') || strchr("._-", *at)))
			return false;
	return *name && *name != '.';
}

int files_open(const char *directory)
{
	int fd = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC), err = 0;

	if (fd < 0)
		return -errno;
	if (faccessat(fd, "index.html", R_OK, AT_EACCESS) < 0)
		err = -errno;
	if (!err)
		return fd;
	close(fd);
	return err;
}

int files_find(int directory, const char *path, uint64_t *size, const char **type,
               char tag[FILES_TAG])
{
	const char *name = *path ? path : "index.html";
	struct stat stat;
	int fd;

	if (!is_plain(name) || !type_of(name))
		return -ENOENT;
	fd = openat(directory, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return -errno;
	if (fstat(fd, &stat) || !S_ISREG(stat.st_mode)) {
		close(fd);
		return -ENOENT;
	}
	*size = (uint64_t)stat.st_size;
	*type = type_of(name);
	snprintf(tag, FILES_TAG, "\"%" PRIx64 "-%" PRIx64 "\"", *size,
	         (uint64_t)stat.st_mtim.tv_sec * 1000000000 + (uint64_t)stat.st_mtim.tv_nsec);
	return fd;
}
