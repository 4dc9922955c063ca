/* SPDX-License-Identifier: MIT */
/* Finds corpses in /proc: zombies that have threads. */
#include <ctype.h>
#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/memory/shm/corpse.h"

#define STAT_MAX 512
/* Spaces of proc_pid_stat(5) between the state and the number of threads. */
#define TO_THREADS 17

/* The line of that process: "7 (owsd) S 1 ..."; the end of its name in it, NULL: there is none. */
static const char *read_stat(const char *process, char text[STAT_MAX])
{
	char path[40];
	ssize_t n;
	int fd;

	text[0] = '\0';
	snprintf(path, sizeof(path), "/proc/%.20s/stat", process);
	fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return NULL;
	n = read(fd, text, STAT_MAX - 1);
	close(fd);
	text[n > 0 ? n : 0] = '\0';
	return strrchr(text, ')');
}

/* The leader is one of the threads until all others have ended. */
static bool has_threads(const char *state)
{
	for (int i = 0; i < TO_THREADS && state; i++) {
		state = strchr(state, ' ');
		if (state)
			state++;
	}
	return state && strtol(state, NULL, 10) > 1;
}

static bool is_corpse(const char *end)
{
	return end && (strncmp(end, ") Z", 3) == 0 || strncmp(end, ") X", 3) == 0) &&
	       has_threads(end + 2);
}

bool corpse_is(pid_t pid)
{
	char process[24], text[STAT_MAX];

	snprintf(process, sizeof(process), "%ld", (long)pid);
	return is_corpse(read_stat(process, text));
}

bool corpse_of_program(void)
{
	char own[STAT_MAX], text[STAT_MAX];
	const char *own_end = read_stat("self", own), *own_name = strchr(own, '('), *name, *end;
	DIR *dir = own_end && own_name ? opendir("/proc") : NULL;
	struct dirent *entry;
	bool found = false;

	while (dir && !found && (entry = readdir(dir))) {
		if (!isdigit((unsigned char)entry->d_name[0]))
			continue;
		end = read_stat(entry->d_name, text);
		name = strchr(text, '(');
		found = is_corpse(end) && name && end - name == own_end - own_name &&
		        memcmp(name, own_name, (size_t)(end - name)) == 0;
	}
	if (dir)
		closedir(dir);
	return found;
}
