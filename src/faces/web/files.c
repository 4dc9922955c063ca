/* SPDX-License-Identifier: MIT */
/* The files of the page. */
#include <dirent.h>
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

static bool is_plain(const char *name)
{
	for (const char *at = name; *at; at++)
		if (!((*at >= '0' && *at <= '9') || (*at >= 'a' && *at <= 'z') ||
		      (*at >= 'A' && *at <= 'Z') || strchr("._-", *at)))
			return false;
	return *name && *name != '.';
}

/* Takes fd. below: the name of the directory with "/", "" for the first. */
static void scan(struct files *files, int fd, const char *below)
{
	DIR *directory = fd < 0 ? NULL : fdopendir(fd);
	struct dirent *entry;

	if (!directory && fd >= 0)
		close(fd);
	while (directory && (entry = readdir(directory))) {
		char name[FILES_NAME];
		struct stat stat;

		if (!is_plain(entry->d_name) || fstatat(fd, entry->d_name, &stat, 0) ||
		    snprintf(name, sizeof(name), "%s%s%s", below, entry->d_name,
		             S_ISDIR(stat.st_mode) ? "/" : "") >= (int)sizeof(name))
			continue;
		if (S_ISDIR(stat.st_mode) && !*below)
			scan(files, openat(fd, entry->d_name, O_RDONLY | O_DIRECTORY | O_CLOEXEC),
			     name);
		else if (S_ISREG(stat.st_mode) && type_of(name) && files->count < FILES)
			memcpy(files->names[files->count++], name, sizeof(name));
	}
	if (directory)
		closedir(directory);
}

int files_open(struct files *files, const char *directory)
{
	files->count = 0;
	files->directory = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (files->directory < 0)
		return -errno;
	scan(files, openat(files->directory, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC), "");
	return files->count ? 0 : -ENOENT;
}

void files_close(struct files *files)
{
	if (files->directory >= 0)
		close(files->directory);
	files->directory = -1;
	files->count = 0;
}

int files_find(const struct files *files, const char *path, uint64_t *size, const char **type,
               char tag[FILES_TAG])
{
	const char *name = *path ? path : "index.html";
	unsigned i = 0;
	struct stat stat;
	int fd;

	while (i < files->count && strcmp(files->names[i], name) != 0)
		i++;
	if (i == files->count)
		return -ENOENT;
	fd = openat(files->directory, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
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
