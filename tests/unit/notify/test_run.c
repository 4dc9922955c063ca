/* SPDX-License-Identifier: MIT */
/* Tests of the programs that owsd-notify runs. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/notify/run.h"
#include "src/public/ows.h"

static struct run run;
static char why[RUN_WORDS];

void setUp(void)
{
	run = (struct run){0};
	why[0] = '\0';
}

void tearDown(void)
{
	run_kill(&run);
}

static int ends(const char *script)
{
	const char *const argv[] = {"/bin/sh", "-c", script, NULL}, *const more[] = {"A=b", NULL};
	int64_t until_ns = ows_now() + 20 * NS_PER_S;
	int err;

	TEST_ASSERT_EQUAL_INT(0, run_begin(&run, argv, "input", 5, more));
	while ((err = run_step(&run, ows_now(), why)) == -EINPROGRESS && ows_now() < until_ns)
		nanosleep(&(struct timespec){.tv_nsec = NS_PER_MS}, NULL); /* pace */
	return err;
}

static void test_a_program_gets_its_input_and_variables(void)
{
	TEST_ASSERT_EQUAL_INT(0, ends("test \"$(cat)$A\" = inputb"));
	TEST_ASSERT_EQUAL_INT(0, run.pid);
}

static void test_its_last_words_say_why_it_failed(void)
{
	TEST_ASSERT_EQUAL_INT(-EIO, ends("echo one; printf 'sms: no\\033money\\n\\n' >&2; exit 3"));
	TEST_ASSERT_EQUAL_STRING("sms: no?money", why);
	TEST_ASSERT_EQUAL_INT(-EIO, ends("exit 3"));
	TEST_ASSERT_EQUAL_STRING("it ended with status 3", why);
	TEST_ASSERT_EQUAL_INT(-EIO, ends("kill -9 $$"));
	TEST_ASSERT_EQUAL_STRING("it was killed", why);
}

static void test_one_that_hangs_is_killed(void)
{
	const char *const argv[] = {"/bin/sleep", "100", NULL}, *const more[] = {NULL};

	TEST_ASSERT_EQUAL_INT(0, run_begin(&run, argv, "", 0, more));
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, run_step(&run, ows_now() + 50 * NS_PER_S, why));
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, run_step(&run, ows_now() + 61 * NS_PER_S, why));
	TEST_ASSERT_EQUAL_STRING("it did not end within a minute, and was killed", why);
	TEST_ASSERT_EQUAL_INT(0, run.pid);
}

static void test_one_that_says_too_much_is_killed(void)
{
	TEST_ASSERT_EQUAL_INT(-EFBIG, ends("yes"));
	TEST_ASSERT_EQUAL_STRING("it says too much, more than a megabyte, and was killed", why);
	TEST_ASSERT_EQUAL_INT(0, run.pid);
}

static void test_one_that_is_not_there_is_an_error(void)
{
	const char *const argv[] = {"/nowhere/sms", NULL}, *const more[] = {NULL};

	TEST_ASSERT_EQUAL_INT(-ENOENT, run_begin(&run, argv, "", 0, more));
	TEST_ASSERT_EQUAL_INT(0, run.pid);
}

static void test_a_program_of_others_is_refused(void)
{
	char path[] = "/tmp/owsd-test-run-XXXXXX";
	const char *const argv[] = {path, NULL}, *const more[] = {NULL};
	int fd = mkstemp(path);

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	TEST_ASSERT_EQUAL_INT(0, fchmod(fd, 0700));
	TEST_ASSERT_EQUAL_INT(0, run_check(path));
	TEST_ASSERT_EQUAL_INT(0, fchmod(fd, 0720));
	TEST_ASSERT_EQUAL_INT(-EPERM, run_check(path));
	TEST_ASSERT_EQUAL_INT(-EPERM, run_begin(&run, argv, "", 0, more));
	TEST_ASSERT_EQUAL_INT(0, fchmod(fd, 0702));
	TEST_ASSERT_EQUAL_INT(-EPERM, run_check(path));
	close(fd);
	unlink(path);
	TEST_ASSERT_EQUAL_INT(-ENOENT, run_check(path));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_program_gets_its_input_and_variables);
	RUN_TEST(test_its_last_words_say_why_it_failed);
	RUN_TEST(test_one_that_hangs_is_killed);
	RUN_TEST(test_one_that_says_too_much_is_killed);
	RUN_TEST(test_one_that_is_not_there_is_an_error);
	RUN_TEST(test_a_program_of_others_is_refused);
	return UNITY_END();
}
