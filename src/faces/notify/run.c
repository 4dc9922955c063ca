/* SPDX-License-Identifier: MIT */
/* A program that is given a text, beside the loop of the face. */
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/notify/run.h"
#include "src/ground/service/spawn.h"
#include "src/ground/text/printable.h"
#include "src/public/ows.h"

#define LIVES_NS (60 * NS_PER_S)
#define VARIABLES 128
#define WORDS_MAX (1 << 20) /* they are in memory, and only the last line is wanted */

int run_check(const char *path)
{
	struct stat st;

	if (stat(path, &st))
		return -errno;
	if ((st.st_uid && st.st_uid != geteuid()) || st.st_mode & (S_IWGRP | S_IWOTH))
		return -EPERM;
	return access(path, X_OK) ? -errno : 0;
}

const char *run_why(int err)
{
	return err == -EPERM ? "it has to belong to root, and nobody else may write it"
	                     : strerror(-err);
}

int run_begin(struct run *run, const char *const *argv, const char *input, size_t len,
              const char *const *more)
{
	int err = run_check(argv[0]), file;
	char *variables[VARIABLES + 1];
	unsigned n = 0;

	if (err)
		return err;
	for (; *more; more++)
		variables[n++] = (char *)(uintptr_t)*more;
	/* it is not the service: it reports nothing to its manager */
	for (char **one = environ; *one && n < VARIABLES; one++)
		if (strncmp(*one, "NOTIFY_SOCKET=", 14) != 0 && strncmp(*one, "WATCHDOG_", 9) != 0)
			variables[n++] = *one;
	variables[n] = NULL;
	file = memfd_create("input", MFD_CLOEXEC);
	run->words = memfd_create("words", MFD_CLOEXEC);
	if (file < 0 || run->words < 0)
		err = -errno;
	else if (len && pwrite(file, input, len, 0) != (ssize_t)len)
		err = -ENOMEM;
	else
		err = spawn_begin(&(struct spawn){.words = argv,
		                                  .streams = {file, run->words, run->words},
		                                  .variables = variables,
		                                  .own_group = true},
		                  &run->pid);
	if (file >= 0)
		close(file);
	if (err && run->words >= 0)
		close(run->words);
	if (err)
		run->pid = 0;
	run->until_ns = ows_now() + LIVES_NS;
	return err;
}

/* The last line that it said. */
static void take_words(const struct run *run, char why[RUN_WORDS])
{
	char text[1024], *line;
	off_t size = lseek(run->words, 0, SEEK_END), from = size - (off_t)sizeof(text) + 1;
	ssize_t n = pread(run->words, text, sizeof(text) - 1, from > 0 ? from : 0);

	while (n > 0 && text[n - 1] == '\n')
		n--;
	if (n <= 0)
		return;
	text[n] = '\0';
	line = strrchr(text, '\n');
	snprintf(why, RUN_WORDS, "%.*s", RUN_WORDS - 1, line ? line + 1 : text);
	why[printable(why, printable_cut(why, strlen(why)))] = '\0';
}

int run_step(struct run *run, int64_t now_ns, char why[RUN_WORDS])
{
	int status, err = 0;
	pid_t ended = waitpid(run->pid, &status, WNOHANG);
	struct stat st = {0};
	bool late = now_ns >= run->until_ns;

	if (!ended && !late && (fstat(run->words, &st) || st.st_size <= WORDS_MAX))
		return -EINPROGRESS;
	*why = '\0';
	if (!ended) {
		snprintf(why, RUN_WORDS,
		         late ? "it did not end within a minute, and was killed"
		              : "it says too much, more than a megabyte, and was killed");
		run_kill(run);
		return late ? -ETIMEDOUT : -EFBIG;
	}
	if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status)) {
		err = -EIO;
		take_words(run, why);
		if (!*why && ended > 0 && WIFEXITED(status))
			snprintf(why, RUN_WORDS, "it ended with status %d", WEXITSTATUS(status));
		else if (!*why)
			snprintf(why, RUN_WORDS, "it was killed");
	}
	close(run->words);
	run->pid = 0;
	return err;
}

void run_kill(struct run *run)
{
	if (!run->pid)
		return;
	kill(-run->pid, SIGKILL);
	waitpid(run->pid, NULL, 0);
	close(run->words);
	run->pid = 0;
}
