/* SPDX-License-Identifier: MIT */
/* What a thread beside the engine's is started with. */
#include <sched.h>
#include <signal.h>

#include "hal/base/thread.h"
#include "hal/base/time.h"
#include "src/public/ows.h"
#include "unity.h"

struct seen {
	size_t stack;
	char name[16];
	sigset_t blocked;
};

static unsigned yields;
static int64_t others_take_ns;

/* In place of the C library's: others run for so long. */
int sched_yield(void)
{
	int64_t until_ns = ows_now() + others_take_ns;

	yields++;
	while (ows_now() < until_ns)
		;
	return 0;
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void *look(void *ctx)
{
	struct seen *seen = ctx;
	pthread_attr_t attr;

	pthread_getname_np(pthread_self(), seen->name, sizeof(seen->name));
	pthread_sigmask(SIG_SETMASK, NULL, &seen->blocked);
	if (!pthread_getattr_np(pthread_self(), &attr)) {
		pthread_attr_getstacksize(&attr, &seen->stack);
		pthread_attr_destroy(&attr);
	}
	return NULL;
}

static struct seen started_with(size_t stack)
{
	struct seen seen = {0};
	pthread_t thread;

	TEST_ASSERT_EQUAL(0, thread_start(&thread, "a thread", stack, look, &seen));
	TEST_ASSERT_EQUAL(0, pthread_join(thread, NULL));
	return seen;
}

static void test_a_stack_is_as_large_as_asked(void)
{
	TEST_ASSERT_GREATER_OR_EQUAL(1024 * 1024, started_with(1024 * 1024).stack);
}

/* What is enough on one machine can be less than another gives a thread at least */
static void test_a_stack_below_the_least_of_the_machine_starts_too(void)
{
	TEST_ASSERT_GREATER_THAN(0, started_with(1).stack);
}

static void test_a_thread_has_its_name_from_the_beginning(void)
{
	for (int i = 0; i < 200; i++)
		TEST_ASSERT_EQUAL_STRING("a thread", started_with(128 * 1024).name);
}

static void test_signals_are_blocked_but_for_a_fault_of_memory(void)
{
	struct seen seen = started_with(128 * 1024);
	sigset_t here;

	TEST_ASSERT_TRUE(sigismember(&seen.blocked, SIGTERM));
	TEST_ASSERT_TRUE(sigismember(&seen.blocked, SIGHUP));
	TEST_ASSERT_FALSE(sigismember(&seen.blocked, SIGBUS));
	pthread_sigmask(SIG_SETMASK, NULL, &here);
	TEST_ASSERT_FALSE(sigismember(&here, SIGTERM));
}

static void test_after_a_yield_that_took_long_there_is_none_for_a_while(void)
{
	int64_t rest_ns = 0, begun_ns = clock_ns(CLOCK_MONOTONIC), ended_ns;

	others_take_ns = 50 * NS_PER_MS; /* a rest that a busy machine does not sleep through */
	TEST_ASSERT_TRUE(thread_yield(&rest_ns));
	ended_ns = clock_ns(CLOCK_MONOTONIC);
	TEST_ASSERT_FALSE(thread_yield(&rest_ns));
	TEST_ASSERT_EQUAL_UINT(1, yields);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(begun_ns + 33 * others_take_ns, rest_ns);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(ended_ns + 32 * (ended_ns - begun_ns), rest_ns);
	rest_ns = begun_ns;
	others_take_ns = 0;
	TEST_ASSERT_TRUE(thread_yield(&rest_ns));
	TEST_ASSERT_EQUAL_UINT(2, yields);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_stack_is_as_large_as_asked);
	RUN_TEST(test_a_stack_below_the_least_of_the_machine_starts_too);
	RUN_TEST(test_a_thread_has_its_name_from_the_beginning);
	RUN_TEST(test_signals_are_blocked_but_for_a_fault_of_memory);
	RUN_TEST(test_after_a_yield_that_took_long_there_is_none_for_a_while);
	return UNITY_END();
}
