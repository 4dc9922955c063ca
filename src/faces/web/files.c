/* SPDX-License-Identifier: MIT */
/* The files of the page. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
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

bool files_takes_gzip(const char *accepts)
{
	const char *at = accepts;

	while (at && *at) {
		at += strspn(at, ", \t");
		if (!strncasecmp(at, "gzip", 4)) {
			at += 4 + strspn(at + 4, " \t");
			if (!*at || *at == ',')
				return true;
			at += strspn(at, "; \t");
			if (!strncasecmp(at, "q=", 2)) {
				at += 2 + strspn(at + 2, "0.");
				return *at >= '1' && *at <= '9';
			}
		}
		at = strchr(at, ',');
	}
	return false;
}

static int open_regular(int directory, const char *name, struct stat *stat)
{
	int fd = openat(directory, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);

	if (fd < 0)
		return -errno;
	if (!fstat(fd, stat) && S_ISREG(stat->st_mode))
		return fd;
	close(fd);
	return -ENOENT;
}

static int64_t changed_ns(const struct stat *stat)
{
	return (int64_t)stat->st_mtim.tv_sec * 1000000000 + stat->st_mtim.tv_nsec;
}

int files_find(int directory, const char *path, bool gzip, struct file *file)
{
	const char *name = *path ? path : "index.html";
	struct stat stat = {0}, packed = {0};
	char beside[256 + 3];
	int fd, other = -1;

	if (!is_plain(name) || !type_of(name))
		return -ENOENT;
	fd = open_regular(directory, name, &stat);
	if (fd < 0)
		return fd;
	snprintf(beside, sizeof(beside), "%s.gz", name);
	if (gzip)
		other = open_regular(directory, beside, &packed);
	/* else it was made of an older one */
	file->gzip = other >= 0 && changed_ns(&packed) >= changed_ns(&stat);
	if (other >= 0)
		close(file->gzip ? fd : other);
	if (file->gzip) {
		fd = other;
		stat = packed;
	}
	file->size = (uint64_t)stat.st_size;
	file->type = type_of(name);
	snprintf(file->tag, sizeof(file->tag), "\"%" PRIx64 "-%" PRIx64 "%s\"", file->size,
	         (uint64_t)changed_ns(&stat), file->gzip ? "-gzip" : "");
	return fd;
}
