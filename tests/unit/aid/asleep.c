/* SPDX-License-Identifier: MIT */
/* Looks at the states of this program's threads in /proc. */
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/unit/aid/asleep.h"

#define PATIENCE_MS 60000

static bool is_asleep(long thread, const char *name)
{
	char path[64], line[300] = "";
	const char *begin, *end;
	FILE *stat;

	snprintf(path, sizeof(path), "/proc/self/task/%ld/stat", thread);
	stat = fopen(path, "re");
	if (!stat)
		return false;
	if (!fgets(line, sizeof(line), stat))
		*line = '\0';
	fclose(stat);
	begin = strchr(line, '(');
	end = strrchr(line, ')');
	if (!begin || !end || strncmp(end, ") S", 3) != 0)
		return false;
	begin++;
	return !name || (strlen(name) == (size_t)(end - begin) &&
	                 strncmp(begin, name, (size_t)(end - begin)) == 0);
}

static bool one_is_asleep(const char *name)
{
	const struct dirent *entry;
	bool found = false;
	DIR *tasks;

	if (!name)
		return is_asleep((long)getpid(), NULL);
	tasks = opendir("/proc/self/task");
	while (tasks && !found && (entry = readdir(tasks)))
		found = is_asleep(strtol(entry->d_name, NULL, 10), name);
	if (tasks)
		closedir(tasks);
	return found;
}

void until_asleep(const char *name)
{
	for (int ms = 0; ms < PATIENCE_MS && !one_is_asleep(name); ms++)
		usleep(1000); /* pace */
}
