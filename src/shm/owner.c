/* SPDX-License-Identifier: MIT */
/* The users and groups that the segments belong to, from /etc/passwd and /etc/group. */
#include <grp.h>
#include <pthread.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/shm/owner.h"

#define OWNER_USER "owsd"

/* fgetpwent() and fgetgrent() have one entry for all threads */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/*
 * Read from the files themselves: the user and groups of owsd are local, and getpwnam() would load
 * the name services of a directory into the daemon for nothing.
 */
bool owner_user(const char *name, uid_t *uid)
{
	FILE *file = fopen("/etc/passwd", "re");
	const struct passwd *entry;
	bool found = false;

	pthread_mutex_lock(&lock);
	while (file && !found && (entry = fgetpwent(file)) != NULL) {
		found = strcmp(entry->pw_name, name) == 0;
		*uid = entry->pw_uid;
	}
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
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
	FILE *file = fopen("/etc/passwd", "re");
	const struct passwd *entry;

	snprintf(name, OWNER_NAME, "%lu", (unsigned long)uid);
	pthread_mutex_lock(&lock);
	while (file && (entry = fgetpwent(file)) != NULL)
		if (entry->pw_uid == uid) {
			snprintf(name, OWNER_NAME, "%.16s (%lu)", entry->pw_name,
			         (unsigned long)uid);
			break;
		}
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
	return name;
}

bool owner_group(const char *name, gid_t *gid)
{
	FILE *file = fopen("/etc/group", "re");
	const struct group *entry;
	bool found = false;

	pthread_mutex_lock(&lock);
	while (file && !found && (entry = fgetgrent(file)) != NULL) {
		found = strcmp(entry->gr_name, name) == 0;
		*gid = entry->gr_gid;
	}
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
	return found;
}

static bool lists(const struct group *entry, const char *name)
{
	for (char **member = entry->gr_mem; *member; member++)
		if (strcmp(*member, name) == 0)
			return true;
	return false;
}

bool owner_in_group(uid_t uid, gid_t gid)
{
	FILE *file = fopen("/etc/passwd", "re");
	const struct passwd *user;
	const struct group *entry;
	char name[OWNER_NAME] = "";
	bool is = false;

	pthread_mutex_lock(&lock);
	while (file && !*name && (user = fgetpwent(file)) != NULL) {
		if (user->pw_uid != uid)
			continue;
		is = user->pw_gid == gid;
		snprintf(name, sizeof(name), "%s", user->pw_name);
	}
	if (file)
		fclose(file);
	file = *name && !is ? fopen("/etc/group", "re") : NULL;
	while (file && !is && (entry = fgetgrent(file)) != NULL)
		is = entry->gr_gid == gid && lists(entry, name);
	pthread_mutex_unlock(&lock);
	if (file)
		fclose(file);
	return is;
}
