/* SPDX-License-Identifier: MIT */
/* Which processes are corpses, and which are not. */
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/corpse.h"
#include "tests/unit/aid/corpse.h"

void setUp(void)
{
	corpse_own_name();
}

void tearDown(void)
{
}

static void test_a_process_that_runs_is_no_corpse(void)
{
	TEST_ASSERT_FALSE(corpse_is(getpid()));
	TEST_ASSERT_FALSE(corpse_of_program());
}

/* It has ended whole: nothing of it holds a lock or a socket. */
static void test_a_process_that_nobody_has_waited_for_is_no_corpse(void)
{
	siginfo_t info;
	pid_t child = fork();
	int status;

	if (child == 0)
		_exit(0);
	TEST_ASSERT_GREATER_THAN(0, child);
	TEST_ASSERT_EQUAL(0, waitid(P_PID, (id_t)child, &info, WEXITED | WNOWAIT));
	TEST_ASSERT_FALSE(corpse_is(child));
	TEST_ASSERT_FALSE(corpse_of_program());
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_FALSE(corpse_is(child));
}

static void test_a_killed_process_with_a_thread_in_the_kernel_is_a_corpse_until_it_ends(void)
{
	struct corpse corpse;

	corpse_make(&corpse, NULL);
	TEST_ASSERT_TRUE(corpse_of_program());
	corpse_end(&corpse);
	TEST_ASSERT_FALSE(corpse_is(corpse.pid));
	TEST_ASSERT_FALSE(corpse_of_program());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_process_that_runs_is_no_corpse);
	RUN_TEST(test_a_process_that_nobody_has_waited_for_is_no_corpse);
	RUN_TEST(test_a_killed_process_with_a_thread_in_the_kernel_is_a_corpse_until_it_ends);
	return UNITY_END();
}
