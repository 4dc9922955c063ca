/* SPDX-License-Identifier: MIT */
/* Finds the programs that have an adapter open beside owsd. */
#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/rivals.h"

/* "" if it has ended, or is hidden. */
static void read_comm(const char *proc, int pid, char *name, size_t size)
{
	char path[320];
	FILE *file;

	name[0] = '\0';
	snprintf(path, sizeof(path), "%s/%d/comm", proc, pid);
	file = fopen(path, "re");
	if (!file)
		return;
	if (!fgets(name, (int)size, file))
		name[0] = '\0';
	fclose(file);
	name[strcspn(name, "\n")] = '\0';
}

void rivals_name(const char *proc, int pid, char *text, size_t size)
{
	char name[32];

	if (pid <= 0) {
		snprintf(text, size, "another target or process");
		return;
	}
	read_comm(proc, pid, name, sizeof(name));
	snprintf(text, size, "%s%sprocess %d%s", name, name[0] ? " (" : "", pid,
	         name[0] ? ")" : "");
}

/* A file elsewhere than in /dev is left alone: it may be on a server that does not answer. */
static bool is_device(int fds, const char *name, dev_t device)
{
	char to[8];
	struct stat st;

	return readlinkat(fds, name, to, sizeof(to)) > 5 && !memcmp(to, "/dev/", 5) &&
	       !fstatat(fds, name, &st, 0) && S_ISCHR(st.st_mode) && st.st_rdev == device;
}

static bool has_open(const char *proc, int pid, dev_t device)
{
	char path[320];
	bool found = false;
	DIR *dir;

	snprintf(path, sizeof(path), "%s/%d/fd", proc, pid);
	dir = opendir(path);
	for (struct dirent *entry; dir && !found && (entry = readdir(dir));)
		found = is_device(dirfd(dir), entry->d_name, device);
	if (dir)
		closedir(dir);
	return found;
}

/* owsd, owsd-sim, owsctl -t */
static bool takes_lock(const char *name)
{
	return !strncmp(name, "owsd", 4) || !strncmp(name, "owsctl", 6);
}

static bool is_of_owfs(const char *name)
{
	char word[20];

	snprintf(word, sizeof(word), "|%s|", name);
	return strstr("|owserver|owfs|owhttpd|owftpd|", word);
}

int rivals_hidden(const char *proc, char *text, size_t size)
{
	DIR *dir = opendir(proc);
	int found = 0;

	text[0] = '\0';
	for (struct dirent *entry; dir && !found && (entry = readdir(dir));) {
		int pid = (int)strtol(entry->d_name, NULL, 10);
		char name[17], path[320];

		read_comm(proc, pid, name, sizeof(name));
		snprintf(path, sizeof(path), "%s/%d/fd", proc, pid);
		if (pid > 0 && is_of_owfs(name) && access(path, R_OK))
			found = pid;
	}
	if (dir)
		closedir(dir);
	if (found)
		rivals_name(proc, found, text, size);
	return found;
}

#define ONE (sizeof(" and , process 2147483647") + 16) /* what one of them takes at most */
#define MORE (sizeof(" and 4294967295 more"))

unsigned rivals_find(const char *proc, const char *device, char *text, size_t size)
{
	unsigned open = 0, named = 0;
	size_t len = 0;
	struct stat st;
	DIR *dir;

	text[0] = '\0';
	if (stat(device, &st))
		return 0;
	dir = opendir(proc);
	for (struct dirent *entry; dir && (entry = readdir(dir));) {
		int pid = (int)strtol(entry->d_name, NULL, 10);
		char name[17];

		if (pid <= 0 || pid == getpid() || !has_open(proc, pid, st.st_rdev))
			continue;
		read_comm(proc, pid, name, sizeof(name));
		if (takes_lock(name))
			continue;
		open++;
		if (size - len < ONE + MORE)
			continue;
		len += (size_t)snprintf(text + len, size - len, "%s%s, process %d",
		                        len ? " and " : "", name[0] ? name : "a program", pid);
		named++;
	}
	if (dir)
		closedir(dir);
	if (open > named)
		snprintf(text + len, size - len, " and %u more", open - named);
	return open;
}

int rivals_refused(int err, const struct rivals_device *device, int holder, char *why, size_t size)
{
	char who[RIVALS_TEXT];

	switch (err) {
	case -ENOENT:
	case -ENXIO:
	case -ENODEV:
		snprintf(why, size, "no %s: %s", device->name, device->missing);
		return -ENODEV;
	case -EACCES:
		snprintf(why, size,
		         "no permission for %s: the user has to be in the group that owns it (%s)",
		         device->name, device->group);
		return -EACCES;
	case -EPERM:
		/* rights are the error before; this one is a filter of the control group */
		snprintf(why, size,
		         "%s: a device filter refuses it (DeviceAllow= of the service, devices of "
		         "the container): restart owsd, or allow it there",
		         device->name);
		return -EACCES;
	case -EADDRINUSE:
		rivals_name(RIVALS_PROC, holder, who, sizeof(who));
		break;
	case -EBUSY:
		if (!rivals_find(RIVALS_PROC, device->path, who, sizeof(who)))
			snprintf(who, sizeof(who), "another program");
		break;
	default:
		snprintf(why, size, "%s: %s", device->name, strerror(-err));
		return err;
	}
	snprintf(why, size, "%s is in use by %s", device->name, who);
	return -EBUSY;
}
