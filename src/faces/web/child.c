/* SPDX-License-Identifier: MIT */
/* Runs another program of owsd for a worker, until a deadline. */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/web/child.h"
#include "src/ground/service/spawn.h"
#include "src/ground/text/printable.h"
#include "src/public/ows.h"

#define FILES 3

/* In the folder of this program, as it is built and installed, else in bin beside that. */
static int find_beside(const char *name, char path[PATH_MAX])
{
	static const char *const folders[] = {"", "../bin/"};
	char self[PATH_MAX / 2];
	ssize_t len = readlink("/proc/self/exe", self, sizeof(self) - 1);

	if (len < 0)
		return -errno;
	while (len && self[len - 1] != '/')
		len--;
	for (int i = 0; i < 2; i++) {
		snprintf(path, PATH_MAX, "%.*s%s%s", (int)len, self, folders[i], name);
		if (access(path, X_OK) == 0)
			return 0;
	}
	return -errno;
}

int child_start(const char *const *argv, pid_t *pid)
{
	pid_t parent = getpid();
	char path[PATH_MAX];
	int err = find_beside(argv[0], path);

	if (err)
		return err;
	*pid = fork();
	if (*pid < 0)
		return -errno;
	if (*pid)
		return 0;
	/* a parent that is killed tells its children nothing else */
	if (prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == parent)
		execv(path, (char *const *)(uintptr_t)argv);
	_exit(127);
}

/* What it reads, prints and says: files in memory, so that nothing has to be passed on. */
static int make_files(const struct child *child, int files[FILES])
{
	size_t len = child->input_len;

	for (int i = 0; i < FILES; i++)
		files[i] = memfd_create("child", MFD_CLOEXEC);
	for (int i = 0; i < FILES; i++)
		if (files[i] < 0)
			return -errno;
	return len && pwrite(files[0], child->input, len, 0) != (ssize_t)len ? -ENOMEM : 0;
}

/* All of the file, with NUL behind it; NULL: no memory, or it is too long. */
static char *read_all(int file, size_t *len)
{
	off_t size = lseek(file, 0, SEEK_END);
	char *text = size < 0 || size > CHILD_OUT ? NULL : malloc((size_t)size + 1);

	*len = 0;
	if (text && pread(file, text, (size_t)size, 0) == size)
		*len = (size_t)size;
	if (text)
		text[*len] = '\0';
	return text;
}

/* The pauses grow: a check takes milliseconds, a scan seconds. */
static int await(struct child *child, pid_t pid)
{
	struct timespec pause = {.tv_nsec = NS_PER_MS};
	int status, err = 0;
	pid_t ended;

	while ((ended = waitpid(pid, &status, err ? 0 : WNOHANG)) == 0) {
		if (ows_now() >= child->until_ns) {
			err = -ETIMEDOUT;
			kill(pid, SIGKILL);
		} else {
			nanosleep(&pause, NULL);
			pause.tv_nsec += pause.tv_nsec < 20 * NS_PER_MS ? pause.tv_nsec / 4 : 0;
		}
	}
	child->status = ended == pid && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	return err;
}

/* "owsctl: the reason" */
static void take_why(struct child *child, char *words)
{
	size_t name = strlen(child->argv[0]), len = strlen(words);
	char *line;

	while (len && words[len - 1] == '\n')
		words[--len] = '\0';
	line = strrchr(words, '\n');
	line = line ? line + 1 : words;
	if (!strncmp(line, child->argv[0], name) && !strncmp(line + name, ": ", 2))
		line += name + 2;
	snprintf(child->why, sizeof(child->why), "%s", line);
	child->why[printable(child->why, strlen(child->why))] = '\0';
}

int child_run(struct child *child)
{
	int files[FILES], err = make_files(child, files);
	char path[PATH_MAX], *words;
	size_t words_len;
	pid_t pid = -1;

	child->status = -1;
	child->why[0] = '\0';
	child->out = NULL;
	if (!err)
		err = find_beside(child->argv[0], path);
	if (!err)
		err = spawn_begin(&(struct spawn){.words = child->argv,
		                                  .path = path,
		                                  .streams = {files[0], files[1], files[2]}},
		                  &pid);
	if (!err)
		err = await(child, pid);
	if (!err) {
		child->out = read_all(files[1], &child->out_len);
		words = read_all(files[2], &words_len);
		if (words)
			take_why(child, words);
		free(words);
		err = child->out ? 0 : -E2BIG;
	}
	for (int i = 0; i < FILES; i++)
		if (files[i] >= 0)
			close(files[i]);
	return err;
}
