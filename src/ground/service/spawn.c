/* SPDX-License-Identifier: MIT */
/* Starts another program, with the signals that a program expects. */
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <unistd.h>

#include "src/ground/service/spawn.h"

int spawn_begin(const struct spawn *spawn, pid_t *pid)
{
	const char *path = spawn->path ? spawn->path : spawn->words[0];
	posix_spawn_file_actions_t actions;
	posix_spawnattr_t attributes;
	sigset_t none, usual;
	short flags = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
	int err;

	sigemptyset(&none);
	sigemptyset(&usual);
	sigaddset(&usual, SIGPIPE);
	sigaddset(&usual, SIGXFSZ);
	posix_spawn_file_actions_init(&actions);
	for (int i = 0; i < 3; i++)
		if (spawn->streams[i] == SPAWN_NOWHERE)
			posix_spawn_file_actions_addopen(&actions, i, "/dev/null", O_RDWR, 0);
		else if (spawn->streams[i] >= 0)
			posix_spawn_file_actions_adddup2(&actions, spawn->streams[i], i);
	posix_spawnattr_init(&attributes);
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &usual);
	if (spawn->own_group)
		flags |= POSIX_SPAWN_SETPGROUP;
	posix_spawnattr_setflags(&attributes, flags);
	err = posix_spawnp(pid, path, &actions, &attributes, (char *const *)(uintptr_t)spawn->words,
	                   spawn->variables ? spawn->variables : environ);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&actions);
	return -err;
}
