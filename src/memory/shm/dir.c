/* SPDX-License-Identifier: MIT */
/* Finds, makes and checks the directory that has the files of the instances. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/dir.h"
#include "src/memory/shm/owner.h"

#define OTHERS_WRITE (S_IWGRP | S_IWOTH)

/* A program that runs for another user than the caller's takes no directory from the caller. */
static const char *environment(const char *name)
{
	const char *text = geteuid() == getuid() ? getenv(name) : NULL;

	return text && *text ? text : NULL;
}

/* Behind a slash at the end O_NOFOLLOW would follow a link, and so it would in front of a dot. */
static int take_path(const char *from, const char *more, char path[DIR_PATH])
{
	size_t len = strlen(from);
	const char *last;

	while (len > 1 && from[len - 1] == '/')
		len--;
	if (*from != '/' || len + strlen(more) >= DIR_PATH)
		return -EINVAL;
	snprintf(path, DIR_PATH, "%s", from);
	snprintf(path + len, DIR_PATH - len, "%s", more);
	last = strrchr(path, '/') + 1;
	return strcmp(last, "") && strcmp(last, ".") && strcmp(last, "..") ? 0 : -EINVAL;
}

int dir_own(char path[DIR_PATH])
{
	const char *named = environment("OWS_DIR"), *runtime = environment("XDG_RUNTIME_DIR");

	path[0] = '\0';
	if (named)
		return take_path(named, "", path);
	if (geteuid() == 0 || owner_is_service())
		return take_path(DIR_SERVICE, "", path);
	if (runtime && take_path(runtime, "/owsd", path) == 0)
		return 0;
	snprintf(path, DIR_PATH, "/dev/shm/owsd-%lu", (unsigned long)geteuid());
	return 0;
}

int dir_list(char path[DIRS][DIR_PATH])
{
	int err = dir_own(path[0]);

	if (err)
		return err;
	if (environment("OWS_DIR") || strcmp(path[0], DIR_SERVICE) == 0)
		return 1;
	return take_path(DIR_SERVICE, "", path[1]) == 0 ? 2 : 1;
}

int dir_open(const char *path, struct shm_dir *dir)
{
	struct stat st;

	*dir = (struct shm_dir){.fd = -1};
	if (strlen(path) >= sizeof(dir->path))
		return -EINVAL;
	memcpy(dir->path, path, strlen(path) + 1);
	dir->fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (dir->fd < 0)
		return errno == ELOOP || errno == ENOTDIR ? -EPERM : -errno;
	if (fstat(dir->fd, &st) == 0 && owner_trusted(st.st_uid) && !(st.st_mode & OTHERS_WRITE))
		return 0;
	dir_close(dir);
	return -EPERM;
}

/* umask could leave a directory that the consumers cannot enter. */
static int make_directory(const char *path)
{
	if (mkdir(path, 0755) == 0)
		return chmod(path, 0755) < 0 ? -errno : 0;
	return errno == EEXIST ? 0 : -errno;
}

int dir_make(struct shm_dir *dir)
{
	char path[DIR_PATH];
	int err = dir_own(path);

	*dir = (struct shm_dir){.fd = -1};
	snprintf(dir->path, sizeof(dir->path), "%s", path);
	if (!err)
		err = make_directory(path);
	return err ? err : dir_open(path, dir);
}

void dir_close(struct shm_dir *dir)
{
	if (dir->fd >= 0)
		close(dir->fd);
	dir->fd = -1;
}

const char *dir_fault(const struct shm_dir *dir, int err, char text[DIR_FAULT])
{
	char user[OWNER_NAME];
	const char *path = dir->path;
	struct stat st;

	if (err == -EINVAL)
		snprintf(
			text, DIR_FAULT,
			"OWS_DIR has to be the absolute path of a directory, of less than %d bytes",
			DIR_PATH);
	else if (lstat(path, &st) < 0 && errno == ENOENT)
		snprintf(text, DIR_FAULT,
		         "cannot make the directory %s: %s: OWS_DIR names another%s", path,
		         strerror(-err),
		         strcmp(path, DIR_SERVICE) ? ""
		                                   : ", or as root: systemd-tmpfiles --create");
	else if (err != -EPERM)
		snprintf(text, DIR_FAULT, "cannot open the directory %s: %s", path, strerror(-err));
	else if (!S_ISDIR(st.st_mode))
		snprintf(text, DIR_FAULT, "%s is %s: owsd needs a directory there, of its own",
		         path, S_ISLNK(st.st_mode) ? "a link" : "no directory");
	else if (st.st_mode & OTHERS_WRITE)
		snprintf(text, DIR_FAULT,
		         "others may write into %s (mode %04o): OWS_DIR names a directory that is "
		         "owsd's alone",
		         path, (unsigned)st.st_mode & 07777);
	else
		snprintf(
			text, DIR_FAULT,
			"the directory %s belongs to user %s, who is neither root nor owsd nor you",
			path, owner_name(st.st_uid, user));
	return text;
}
