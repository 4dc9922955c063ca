/* SPDX-License-Identifier: MIT */
/* Tests of the programs that owsd's programs start. */
#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/spawn.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* What the shell command prints. */
static const char *printed(struct spawn *spawn, const char *command)
{
	static char text[200];
	const char *const words[] = {"sh", "-c", command, NULL};
	int file = memfd_create("printed", MFD_CLOEXEC), status;
	pid_t pid;

	spawn->words = words;
	spawn->streams[STDOUT_FILENO] = file;
	TEST_ASSERT_EQUAL_INT(0, spawn_begin(spawn, &pid));
	TEST_ASSERT_EQUAL_INT(pid, waitpid(pid, &status, 0));
	TEST_ASSERT_EQUAL_INT(0, status);
	memset(text, 0, sizeof(text));
	TEST_ASSERT_GREATER_THAN_INT(0, pread(file, text, sizeof(text) - 1, 0));
	close(file);
	return text;
}

/* SIGTERM is the bit 0x4000, SIGPIPE and SIGXFSZ are 0x1000 and 0x1000000. */
static void test_signals_are_as_a_program_expects_them(void)
{
	struct spawn spawn = {.streams = {SPAWN_KEPT, SPAWN_KEPT, SPAWN_KEPT}};
	void (*pipe)(int) = signal(SIGPIPE, SIG_IGN), (*size)(int) = signal(SIGXFSZ, SIG_IGN);
	sigset_t term, before;

	sigemptyset(&term);
	sigaddset(&term, SIGTERM);
	sigprocmask(SIG_BLOCK, &term, &before);
	TEST_ASSERT_EQUAL_STRING(
		"0 0\n", printed(&spawn, "while read key value; do case $key in "
	                                 "SigBlk:) blocked=$value;; SigIgn:) ignored=$value;; "
	                                 "esac; done </proc/self/status; "
	                                 "echo $((0x$blocked & 0x4000)) "
	                                 "$((0x$ignored & 0x1001000))"));
	sigprocmask(SIG_SETMASK, &before, NULL);
	signal(SIGPIPE, pipe);
	signal(SIGXFSZ, size);
}

static void test_streams_variables_and_group_are_those_that_were_asked_for(void)
{
	static char one[] = "ONE=1", *variables[] = {one, NULL};
	struct spawn spawn = {.streams = {SPAWN_KEPT, SPAWN_KEPT, SPAWN_NOWHERE},
	                      .path = "/bin/sh",
	                      .variables = variables,
	                      .own_group = true};

	TEST_ASSERT_EQUAL_STRING("/dev/null 1 own\n",
	                         printed(&spawn,
	                                 "read p n s pp g rest </proc/$$/stat; [ $g = $$ ] "
	                                 "&& g=own; echo $(readlink /proc/$$/fd/2) $ONE $g"));
}

static void test_what_is_not_there_is_an_error(void)
{
	const char *const words[] = {"/nonexistent/program", NULL};
	const struct spawn spawn = {.words = words,
	                            .streams = {SPAWN_KEPT, SPAWN_KEPT, SPAWN_KEPT}};
	pid_t pid;

	TEST_ASSERT_EQUAL_INT(-ENOENT, spawn_begin(&spawn, &pid));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_signals_are_as_a_program_expects_them);
	RUN_TEST(test_streams_variables_and_group_are_those_that_were_asked_for);
	RUN_TEST(test_what_is_not_there_is_an_error);
	return UNITY_END();
}
