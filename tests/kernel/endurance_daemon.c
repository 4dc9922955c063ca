/* SPDX-License-Identifier: MIT */
/* Starts, signals, measures and ends the owsd of the endurance run in the guest. */
#include <dirent.h>
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

/* In the child, which returns 0: its output goes there. */
static pid_t child(int output)
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

int daemon_end(void)
{
	int status;

	for (int i = 0; i < 600; i++) {
		if (waitpid(owsd, &status, WNOHANG) == owsd) {
			owsd = -1;
			return status;
		}
		usleep(100000); /* pace */
	}
	return -1;
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

long daemon_memory(void)
{
	char path[64], line[128];
	long kib = -1;
	FILE *file;

	snprintf(path, sizeof(path), "/proc/%d/status", (int)owsd);
	file = fopen(path, "re");
	while (file && fgets(line, sizeof(line), file))
		if (strncmp(line, "VmRSS:", 6) == 0)
			kib = strtol(line + 6, NULL, 10);
	if (file)
		fclose(file);
	return kib;
}

int daemon_descriptors(void)
{
	char path[64];
	int count = -2; /* . and .. */
	DIR *dir;

	snprintf(path, sizeof(path), "/proc/%d/fd", (int)owsd);
	dir = opendir(path);
	if (!dir)
		return -1;
	while (readdir(dir))
		count++;
	closedir(dir);
	return count;
}

/* --- The served client --- */
#define CLIENT_PERIOD (2 * SECOND)
/* What is read while it changes may be as old as one conversion and what is queued before it */
#define CLIENT_SLACK (4 * SECOND)

static pid_t client = -1;
static int answer_fd = -1;
static int64_t asked_ns;
static unsigned answers;

static void ask(void)
{
	int ends[2];

	if (ows_now() < asked_ns + CLIENT_PERIOD || pipe2(ends, O_CLOEXEC))
		return;
	asked_ns = ows_now();
	client = child(ends[1]);
	if (client == 0) {
		execlp("owsctl", "owsctl", "-t", SERVED, "read",
		       "/uncached/28.A0B1C2000028/temperature12", NULL);
		_exit(127);
	}
	close(ends[1]);
	answer_fd = ends[0];
}

void client_step(void)
{
	char text[256];
	ssize_t got;
	int status;

	if (client < 0) {
		ask();
		return;
	}
	if (waitpid(client, &status, WNOHANG) != client) {
		if (ows_now() > asked_ns + 60 * SECOND) {
			violated("a client got no answer and no error within a minute");
			kill(client, SIGKILL);
		}
		return;
	}
	got = read(answer_fd, text, sizeof(text) - 1);
	text[got > 0 ? got : 0] = '\0';
	close(answer_fd);
	client = -1;
	if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
		return; /* an error is an answer that can be trusted */
	answers++;
	if (!truth_between(WARM, strtod(text, NULL), asked_ns - CLIENT_SLACK, ows_now()))
		violated("a client was told %s", text);
}

unsigned client_answers(void)
{
	return answers;
}
