/* SPDX-License-Identifier: MIT */
/* What the engine's thread sleeps on: rings wake it, and none can keep it awake. */
#include <pthread.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/daemon/host/bells.h"
#include "src/public/ows.h"

#define LONG_NS (20 * NS_PER_S)

static struct bells bells;
static int bell;

void setUp(void)
{
	TEST_ASSERT_EQUAL(0, bells_open(&bells));
	bell = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	TEST_ASSERT_GREATER_OR_EQUAL(0, bell);
}

void tearDown(void)
{
	close(bell);
	bells_close(&bells);
}

static void ring(void)
{
	const uint64_t one = 1;

	TEST_ASSERT_EQUAL(sizeof(one), write(bell, &one, sizeof(one)));
}

/* Sleep as the engine does; returns how long. */
static int64_t nap(int64_t ns)
{
	int64_t begun_ns = ows_now();

	if (!bells_close_eyes(&bells))
		bells_sleep(&bells, begun_ns + ns);
	bells_open_eyes(&bells);
	bells_look(&bells);
	return ows_now() - begun_ns;
}

static void test_a_sleep_ends_at_its_time(void)
{
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(20 * NS_PER_MS, nap(20 * NS_PER_MS));
}

static void test_a_ring_before_the_sleep_is_not_lost(void)
{
	bells_ring(&bells);
	TEST_ASSERT_LESS_THAN_INT64(LONG_NS, nap(LONG_NS));
	/* and counts once */
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(20 * NS_PER_MS, nap(20 * NS_PER_MS));
}

static void *ring_again(void *arg)
{
	for (int i = 0; i < 20000; i++)
		bells_ring(&bells);
	__atomic_store_n((bool *)arg, true, __ATOMIC_SEQ_CST);
	bells_ring(&bells);
	return NULL;
}

static void test_no_ring_of_another_thread_is_lost(void)
{
	bool done = false;
	pthread_t thread;

	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, ring_again, &done));
	do {
		bells_look(&bells);
		if (__atomic_load_n(&done, __ATOMIC_SEQ_CST))
			break;
		TEST_ASSERT_LESS_THAN_INT64(LONG_NS, nap(LONG_NS));
	} while (true);
	pthread_join(thread, NULL);
}

static void test_each_ring_of_a_controller_wakes_once_and_nobody_reads_it(void)
{
	bells_add(&bells, 3, bell);
	for (int i = 0; i < 10; i++) {
		ring();
		TEST_ASSERT_LESS_THAN_INT64(LONG_NS, nap(LONG_NS));
	}
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(20 * NS_PER_MS, nap(20 * NS_PER_MS));
}

static void test_a_ring_before_a_controller_joined_wakes(void)
{
	ring();
	bells_add(&bells, 0, bell);
	TEST_ASSERT_LESS_THAN_INT64(LONG_NS, nap(LONG_NS));
}

static void test_a_controller_that_left_wakes_nobody(void)
{
	bells_add(&bells, 127, bell);
	bells_remove(&bells, 127);
	ring();
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(20 * NS_PER_MS, nap(20 * NS_PER_MS));
}

static void test_a_bell_that_rings_without_end_is_left_out_for_a_while(void)
{
	int64_t begun_ns = ows_now(), since_ns;
	unsigned wakes = 0;

	bells_add(&bells, 5, bell);
	while (bells.mutes == 0 && ows_now() - begun_ns < LONG_NS) {
		ring();
		nap(LONG_NS);
		wakes++;
	}
	TEST_ASSERT_EQUAL_UINT64(1, bells.mutes);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(BELLS_MAX, wakes);
	/* now it wakes nobody; the sleep ends when its time is over, and then it wakes again */
	ring();
	since_ns = bells.since_ns;
	nap(LONG_NS);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(since_ns + BELLS_NS, ows_now());
	ring();
	TEST_ASSERT_LESS_THAN_INT64(LONG_NS, nap(LONG_NS));
	TEST_ASSERT_EQUAL_UINT(0, bells.muted);
	bells_remove(&bells, 5);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_sleep_ends_at_its_time);
	RUN_TEST(test_a_ring_before_the_sleep_is_not_lost);
	RUN_TEST(test_no_ring_of_another_thread_is_lost);
	RUN_TEST(test_each_ring_of_a_controller_wakes_once_and_nobody_reads_it);
	RUN_TEST(test_a_ring_before_a_controller_joined_wakes);
	RUN_TEST(test_a_controller_that_left_wakes_nobody);
	RUN_TEST(test_a_bell_that_rings_without_end_is_left_out_for_a_while);
	return UNITY_END();
}
