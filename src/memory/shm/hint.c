/* SPDX-License-Identifier: MIT */
/* The cause of an error of the directory, for the log: it is full, or a file is in the way. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/hint.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/segment.h"

/* Can owsd not use this file? */
static bool is_in_the_way(const struct stat *st)
{
	return !S_ISREG(st->st_mode) || !owner_trusted(st->st_uid) ||
	       (geteuid() != 0 && st->st_uid != geteuid());
}

static const char *file_kind(const struct stat *st)
{
	if (S_ISREG(st->st_mode))
		return "file";
	if (S_ISDIR(st->st_mode))
		return "directory";
	return S_ISLNK(st->st_mode) ? "link" : "special file";
}

/* Does the file belong to another user's instance, which may be running? Then nothing is wrong. */
static bool belongs_to_another(const struct stat *st)
{
	bool ours = geteuid() == 0 || owner_is_service();

	return S_ISREG(st->st_mode) && (!ours || owner_trusted(st->st_uid));
}

const char *segment_hint(const struct shm_dir *dir, const char *instance, int err,
                         char text[SEGMENT_HINT])
{
	static const char *const kinds[] = {"lock", "image", "force"};
	char name[SEGMENT_FILE], user[OWNER_NAME];
	struct stat st;

	if (err == -ENOSPC) {
		snprintf(text, SEGMENT_HINT, ": %s is full", dir->path);
		return text;
	}
	if (!segment_name_ok(instance))
		return "";
	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		segment_file(instance, kinds[i], name);
		if (fstatat(dir->fd, name, &st, AT_SYMLINK_NOFOLLOW) < 0 || !is_in_the_way(&st))
			continue;
		owner_name(st.st_uid, user);
		if (belongs_to_another(&st))
			snprintf(text, SEGMENT_HINT,
			         ": instance %s belongs to user %s: run owsd as that user, or name "
			         "another instance with -n",
			         instance, user);
		else if (S_ISREG(st.st_mode))
			snprintf(text, SEGMENT_HINT,
			         ": a file of user %s is in the way: as root, owsctl remove %s",
			         user, instance);
		else
			snprintf(text, SEGMENT_HINT,
			         ": a %s of user %s is in the way: as root, rm -r %s/%s",
			         file_kind(&st), user, dir->path, name);
		return text;
	}
	return "";
}
