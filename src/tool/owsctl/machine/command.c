/* SPDX-License-Identifier: MIT */
/* Runs commands of the system, and waits for their end. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/ground/service/spawn.h"
#include "src/public/ows.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/machine/command.h"

/* Killed if it runs longer than until then. */
static bool ended_well(pid_t pid, int64_t until_ns)
{
	const struct timespec pause = {.tv_nsec = 5 * NS_PER_MS};
	int status = 0;
	pid_t ended;

	while ((ended = waitpid(pid, &status, until_ns == INT64_MAX ? 0 : WNOHANG)) <= 0 &&
	       (ended == 0 || errno == EINTR)) {
		if (ended == 0 && ows_now() >= until_ns) {
			kill(pid, SIGKILL);
			until_ns = INT64_MAX;
		} else if (ended == 0) {
			nanosleep(&pause, NULL);
		}
	}
	return ended == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool command_output(const char *const words[], int64_t until_ns, char *text, size_t size)
{
	size_t len = 0;
	ssize_t n = 1;
	struct spawn spawn = {.words = words, .streams = {SPAWN_KEPT, SPAWN_KEPT, SPAWN_NOWHERE}};
	int ends[2], err;
	pid_t pid;

	text[0] = '\0';
	if (pipe2(ends, O_CLOEXEC))
		return false;
	spawn.streams[STDOUT_FILENO] = ends[1];
	err = spawn_begin(&spawn, &pid);
	close(ends[1]);
	/* a command that has more to say than there is room for fails */
	while (!err && n > 0 && len < size - 1) {
		struct pollfd out = {.fd = ends[0], .events = POLLIN};

		if (ows_now() >= until_ns)
			break;
		if (poll(&out, 1, 100) <= 0)
			continue;
		n = read(ends[0], text + len, size - 1 - len);
		len += n > 0 ? (size_t)n : 0;
	}
	close(ends[0]);
	text[len] = '\0';
	if (!err && ended_well(pid, until_ns))
		return true;
	text[0] = '\0';
	return false;
}

int command_run(const char *const words[], bool dry)
{
	const struct spawn spawn = {.words = words,
	                            .streams = {SPAWN_KEPT, SPAWN_KEPT, SPAWN_KEPT}};
	pid_t pid;
	int err;

	putchar('+');
	for (unsigned i = 0; words[i]; i++)
		printf(" %s", words[i]);
	putchar('\n');
	if (dry)
		return 0;
	fflush(stdout);
	err = spawn_begin(&spawn, &pid);
	if (err)
		ctl_fail("%s: %s", words[0], strerror(-err));
	else if (ended_well(pid, INT64_MAX))
		return 0;
	else
		ctl_fail("%s has failed", words[0]);
	return -EIO;
}

int command_line(const char *line, size_t len)
{
	const char *words[COMMAND_WORDS + 1] = {0};
	char copy[512], *rest = copy, *word;
	unsigned n = 0;

	snprintf(copy, sizeof(copy), "%.*s", (int)len, line);
	while (n < COMMAND_WORDS && (word = strsep(&rest, " ")))
		if (*word)
			words[n++] = word;
	return n ? command_run(words, false) : -EINVAL;
}
