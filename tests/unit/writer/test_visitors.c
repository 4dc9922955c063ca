/* SPDX-License-Identifier: MIT */
/* The processes of the writer: how many a user may have, and how they end. */
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/writer/visitors.h"

static struct visitors visitors;

void setUp(void)
{
	memset(&visitors, 0, sizeof(visitors));
}

void tearDown(void)
{
	visitors_end(&visitors);
}

static pid_t sleeper(void)
{
	pid_t pid = fork();

	if (pid == 0) {
		pause();
		_exit(0);
	}
	return pid;
}

static void test_a_user_has_so_many_and_leaves_the_rest_to_others(void)
{
	for (unsigned i = 0; i < VISITORS_PER_USER; i++) {
		TEST_ASSERT_TRUE(visitors_may(&visitors, 1000));
		visitors_add(&visitors, sleeper(), 1000, 0);
	}
	TEST_ASSERT_FALSE(visitors_may(&visitors, 1000));
	TEST_ASSERT_TRUE(visitors_may(&visitors, 1001));
	TEST_ASSERT_EQUAL(VISITORS_PER_USER, visitors_look(&visitors, 0));
}

static void test_root_may_always(void)
{
	for (unsigned i = 0; i < VISITORS; i++) {
		TEST_ASSERT_TRUE(visitors_may(&visitors, 0));
		visitors_add(&visitors, sleeper(), 0, 0);
	}
	TEST_ASSERT_TRUE(visitors_may(&visitors, 0));
}

static void test_one_that_has_ended_leaves_its_place(void)
{
	pid_t pid = fork();
	siginfo_t info;

	if (pid == 0)
		_exit(0);
	visitors_add(&visitors, pid, 1000, 0);
	TEST_ASSERT_EQUAL(0, waitid(P_PID, (id_t)pid, &info, WEXITED | WNOWAIT));
	TEST_ASSERT_EQUAL(0, visitors_look(&visitors, 0));
}

static void test_one_that_goes_on_beyond_all_deadlines_is_killed(void)
{
	pid_t late = sleeper(), other = sleeper();
	siginfo_t info;

	kill(late, SIGSTOP);
	visitors_add(&visitors, late, 1000, 0);
	visitors_add(&visitors, other, 1001, 1);
	TEST_ASSERT_EQUAL(2, visitors_look(&visitors, VISITORS_NS));
	visitors_look(&visitors, VISITORS_NS + 1);
	TEST_ASSERT_EQUAL(0, waitid(P_PID, (id_t)late, &info, WEXITED | WNOWAIT));
	TEST_ASSERT_EQUAL(SIGKILL, info.si_status);
	TEST_ASSERT_EQUAL(1, visitors_look(&visitors, VISITORS_NS + 1));
}

static void test_at_the_end_none_is_left(void)
{
	for (unsigned i = 0; i < VISITORS; i++)
		visitors_add(&visitors, sleeper(), i, 0);
	visitors_end(&visitors);
	TEST_ASSERT_EQUAL(0, visitors_look(&visitors, 0));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_user_has_so_many_and_leaves_the_rest_to_others);
	RUN_TEST(test_root_may_always);
	RUN_TEST(test_one_that_has_ended_leaves_its_place);
	RUN_TEST(test_one_that_goes_on_beyond_all_deadlines_is_killed);
	RUN_TEST(test_at_the_end_none_is_left);
	return UNITY_END();
}
