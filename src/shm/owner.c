/* SPDX-License-Identifier: MIT */
#include "owner.h"

#include <grp.h>
#include <pwd.h>
#include <stddef.h>
#include <unistd.h>

#define OWNER_USER "owsd"

bool owner_trusted(uid_t uid)
{
	struct passwd entry, *found = NULL;
	char room[2048];

	if (uid == 0 || uid == geteuid())
		return true;
	return getpwnam_r(OWNER_USER, &entry, room, sizeof(room), &found) == 0 && found != NULL &&
	       uid == found->pw_uid;
}

bool owner_group(const char *name, gid_t *gid)
{
	struct group entry, *found = NULL;
	char room[4096];

	if (getgrnam_r(name, &entry, room, sizeof(room), &found) != 0 || found == NULL)
		return false;
	*gid = found->gr_gid;
	return true;
}
