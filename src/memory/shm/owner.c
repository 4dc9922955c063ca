/* SPDX-License-Identifier: MIT */
/* The users and groups that the segments belong to, from /etc/passwd and /etc/group. */
#include <grp.h>
#include <pthread.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/memory/shm/owner.h"

#define OWNER_USER "owsd"

/* fgetpwent() and fgetgrent() have one entry for all threads */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

struct user {
	uid_t uid;
	gid_t gid;
	char name[OWNER_NAME];
};

/*
 * The user of that name; name NULL: of that uid. Read from the files themselves: the user and
 * groups of owsd are local, and getpwnam() would load the name services of a directory into the
 * daemon for nothing.
 */
static bool find_user(const char *name, uid_t uid, struct user *user)
{
	FILE *file = fopen("/etc/passwd", "re");
	const struct passwd *entry;
	bool found = false;

	pthread_mutex_lock(&lock);
	while (file && !found && (entry = fgetpwent(file)) != NULL) {
		found = name ? strcmp(entry->pw_name, name) == 0 : entry->pw_uid == uid;
		*user = (struct user){.uid = entry->pw_uid, .gid = entry->pw_gid};
		snprintf(user->name, sizeof(user->name), "%s", entry->pw_name);
	}
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
	return found;
}

static bool lists(const struct group *entry, const char *name)
{
	for (char **member = entry->gr_mem; name && *member; member++)
		if (strcmp(*member, name) == 0)
			return true;
	return false;
}

/* The group of that name; name NULL: *gid, if it lists the member. */
static bool find_group(const char *name, const char *member, gid_t *gid)
{
	FILE *file = fopen("/etc/group", "re");
	const struct group *entry;
	bool found = false;

	pthread_mutex_lock(&lock);
	while (file && !found && (entry = fgetgrent(file)) != NULL) {
		found = name ? strcmp(entry->gr_name, name) == 0
		             : entry->gr_gid == *gid && lists(entry, member);
		if (found)
			*gid = entry->gr_gid;
	}
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
	return found;
}

bool owner_user(const char *name, uid_t *uid)
{
	struct user user;
	bool found = find_user(name, 0, &user);

	if (found)
		*uid = user.uid;
	return found;
}

static bool is_service(uid_t uid)
{
	uid_t owsd;

	return owner_user(OWNER_USER, &owsd) && uid == owsd;
}

bool owner_is_service(void)
{
	return is_service(geteuid());
}

bool owner_trusted(uid_t uid)
{
	return uid == 0 || uid == geteuid() || is_service(uid);
}

const char *owner_name(uid_t uid, char name[OWNER_NAME])
{
	struct user user;

	if (find_user(NULL, uid, &user))
		snprintf(name, OWNER_NAME, "%.16s (%lu)", user.name, (unsigned long)uid);
	else
		snprintf(name, OWNER_NAME, "%lu", (unsigned long)uid);
	return name;
}

bool owner_group(const char *name, gid_t *gid)
{
	return find_group(name, NULL, gid);
}

bool owner_in_group(uid_t uid, gid_t gid)
{
	struct user user;

	return find_user(NULL, uid, &user) &&
	       (user.gid == gid || find_group(NULL, user.name, &gid));
}
