/* SPDX-License-Identifier: MIT */
/* Finds, makes and checks the directory that has the files of the instances. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/owner.h"
#include "src/memory/shm/place.h"

#define OTHERS_WRITE (S_IWGRP | S_IWOTH)

/* A program that runs for another user than the caller's takes no directory from the caller. */
static const char *environment(const char *name)
{
	const char *text = geteuid() == getuid() ? getenv(name) : NULL;

	return text && *text ? text : NULL;
}

/* Behind a slash at the end O_NOFOLLOW would follow a link, and so it would in front of a dot. */
static int take_path(const char *from, const char *more, char path[PLACE_PATH])
{
	size_t len = strlen(from);
	const char *last;

	while (len > 1 && from[len - 1] == '/')
		len--;
	if (*from != '/' || len + strlen(more) >= PLACE_PATH)
		return -EINVAL;
	snprintf(path, PLACE_PATH, "%s", from);
	snprintf(path + len, PLACE_PATH - len, "%s", more);
	last = strrchr(path, '/') + 1;
	return strcmp(last, "") && strcmp(last, ".") && strcmp(last, "..") ? 0 : -EINVAL;
}

int place_own(char path[PLACE_PATH])
{
	const char *named = environment("OWS_DIR"), *runtime = environment("XDG_RUNTIME_DIR");

	path[0] = '\0';
	if (named)
		return take_path(named, "", path);
	if (geteuid() == 0 || owner_is_service())
		return take_path(PLACE_SERVICE, "", path);
	if (runtime && take_path(runtime, "/owsd", path) == 0)
		return 0;
	snprintf(path, PLACE_PATH, "/dev/shm/owsd-%lu", (unsigned long)geteuid());
	return 0;
}

int place_list(char path[PLACES][PLACE_PATH])
{
	int err = place_own(path[0]);

	if (err)
		return err;
	if (environment("OWS_DIR") || strcmp(path[0], PLACE_SERVICE) == 0)
		return 1;
	return take_path(PLACE_SERVICE, "", path[1]) == 0 ? 2 : 1;
}

int place_open(const char *path, struct shm_place *place)
{
	struct stat st;

	*place = (struct shm_place){.fd = -1};
	if (strlen(path) >= sizeof(place->path))
		return -EINVAL;
	memcpy(place->path, path, strlen(path) + 1);
	place->fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (place->fd < 0)
		return errno == ELOOP || errno == ENOTDIR ? -EPERM : -errno;
	if (fstat(place->fd, &st) == 0 && owner_trusted(st.st_uid) && !(st.st_mode & OTHERS_WRITE))
		return 0;
	place_close(place);
	return -EPERM;
}

/* umask could leave a directory that the consumers cannot enter. */
static int make_directory(const char *path)
{
	if (mkdir(path, 0755) == 0)
		return chmod(path, 0755) < 0 ? -errno : 0;
	return errno == EEXIST ? 0 : -errno;
}

int place_make(struct shm_place *place)
{
	char path[PLACE_PATH];
	int err = place_own(path);

	*place = (struct shm_place){.fd = -1};
	snprintf(place->path, sizeof(place->path), "%s", path);
	if (!err)
		err = make_directory(path);
	return err ? err : place_open(path, place);
}

void place_close(struct shm_place *place)
{
	if (place->fd >= 0)
		close(place->fd);
	place->fd = -1;
}

const char *place_fault(const struct shm_place *place, int err, char text[PLACE_FAULT])
{
	char user[OWNER_NAME];
	const char *path = place->path;
	struct stat st;

	if (err == -EINVAL)
		snprintf(
			text, PLACE_FAULT,
			"OWS_DIR has to be the absolute path of a directory, of less than %d bytes",
			PLACE_PATH);
	else if (lstat(path, &st) < 0 && errno == ENOENT)
		snprintf(text, PLACE_FAULT,
		         "cannot make the directory %s: %s: OWS_DIR names another%s", path,
		         strerror(-err),
		         strcmp(path, PLACE_SERVICE) ? ""
		                                     : ", or as root: systemd-tmpfiles --create");
	else if (err != -EPERM)
		snprintf(text, PLACE_FAULT, "cannot open the directory %s: %s", path,
		         strerror(-err));
	else if (!S_ISDIR(st.st_mode))
		snprintf(text, PLACE_FAULT, "%s is %s: owsd needs a directory there, of its own",
		         path, S_ISLNK(st.st_mode) ? "a link" : "no directory");
	else if (st.st_mode & OTHERS_WRITE)
		snprintf(text, PLACE_FAULT,
		         "others may write into %s (mode %04o): OWS_DIR names a directory that is "
		         "owsd's alone",
		         path, (unsigned)st.st_mode & 07777);
	else
		snprintf(
			text, PLACE_FAULT,
			"the directory %s belongs to user %s, who is neither root nor owsd nor you",
			path, owner_name(st.st_uid, user));
	return text;
}
