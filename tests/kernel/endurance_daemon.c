/* SPDX-License-Identifier: MIT */
/* Starts, signals and ends the owsd of the endurance run in the guest. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/kernel/endurance.h"

#define SERVED "127.0.0.1:4304"

/* Made by endurance.sh */
static const char present[] = "/tmp/present.rio", *const files[] = {"/tmp/a.rio", "/tmp/b.rio"};

static pid_t owsd = -1;
static unsigned reloads;

pid_t child(int output)
{
	pid_t pid = fork();

	if (pid == 0) {
		dup2(output, STDOUT_FILENO);
		dup2(output, STDERR_FILENO);
	}
	return pid;
}

static void exchange(void)
{
	char line[128];

	snprintf(line, sizeof(line), "cp %s /tmp/new.rio && mv /tmp/new.rio %s", files[reloads % 2],
	         present);
	if (system(line) != 0)
		violated("%s", line);
}

void daemon_start(void)
{
	int log = open("/tmp/log/owsd", O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);

	exchange();
	owsd = child(log);
	if (owsd == 0) {
		execlp("owsd", "owsd", "-c", present, "-l", SERVED, NULL);
		_exit(127);
	}
	close(log);
	if (owsd < 0)
		violated("owsd cannot be started: %s", strerror(errno));
}

void daemon_signal(int number)
{
	kill(owsd, number);
}

int child_end(pid_t pid)
{
	int status;

	for (int i = 0; i < 600; i++) {
		if (waitpid(pid, &status, WNOHANG) == pid)
			return status;
		usleep(100000); /* pace */
	}
	return -1;
}

int daemon_end(void)
{
	pid_t ended = owsd;

	owsd = -1;
	return child_end(ended);
}

void daemon_reload(void)
{
	reloads++;
	exchange();
	daemon_signal(SIGHUP);
}

bool daemon_lives(void)
{
	return owsd > 0 && waitpid(owsd, NULL, WNOHANG) == 0;
}

pid_t daemon_pid(void)
{
	return owsd;
}
