/* SPDX-License-Identifier: MIT */
/* Tests of when changes of values go out to the streams. */
#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/web/pace.h"

static struct pace pace;
static int64_t now_ns;
static uint64_t cursor;

void setUp(void)
{
	pace = (struct pace){0};
	now_ns = 1000 * NS_PER_S;
	cursor = 1;
}

void tearDown(void)
{
}

/* Something changes: how many ms pass until it goes out, to streams that cost so much? */
static int64_t change_goes_after(int64_t cost_ns)
{
	int64_t begin = now_ns;

	pace.waits = true;
	cursor++;
	while (!pace_send(&pace, now_ns, cursor)) {
		TEST_ASSERT_LESS_THAN_INT64(begin + NS_PER_S, now_ns);
		now_ns = pace_due(&pace);
	}
	TEST_ASSERT_FALSE(pace.waits);
	TEST_ASSERT_EQUAL_UINT64(cursor, pace.sent);
	pace_spent(&pace, cost_ns);
	return (now_ns - begin) / NS_PER_MS;
}

static void test_the_first_change_after_a_silence_goes_at_once(void)
{
	TEST_ASSERT_EQUAL_INT64(0, change_goes_after(NS_PER_MS));
	now_ns += NS_PER_S;
	TEST_ASSERT_EQUAL_INT64(0, change_goes_after(NS_PER_MS));
}

static void test_the_next_ones_wait_for_20_ms_at_least(void)
{
	change_goes_after(1000);
	now_ns += 5 * NS_PER_MS;
	TEST_ASSERT_EQUAL_INT64(15, change_goes_after(1000));
	TEST_ASSERT_EQUAL_INT64(20, change_goes_after(0));
}

static void test_what_costs_more_rests_longer_and_never_longer_than_100_ms(void)
{
	change_goes_after(2 * NS_PER_MS);
	TEST_ASSERT_EQUAL_INT64(40, change_goes_after(50 * NS_PER_MS));
	TEST_ASSERT_EQUAL_INT64(100, change_goes_after(INT64_MAX / 2));
	TEST_ASSERT_EQUAL_INT64(100, change_goes_after(0));
	TEST_ASSERT_EQUAL_INT64(20, change_goes_after(0));
}

static void test_what_is_spent_while_a_change_waits_counts_too(void)
{
	change_goes_after(NS_PER_MS);
	pace.waits = true;
	TEST_ASSERT_EQUAL_INT64(now_ns + 20 * NS_PER_MS, pace_due(&pace));
	pace_spent(&pace, NS_PER_MS);
	TEST_ASSERT_EQUAL_INT64(now_ns + 40 * NS_PER_MS, pace_due(&pace));
}

/* Changes without pause: the streams cost a twentieth of the time, whatever one round costs. */
static void test_streams_cost_a_twentieth_of_a_processor(void)
{
	for (int64_t cost_ns = NS_PER_MS; cost_ns <= 5 * NS_PER_MS; cost_ns += NS_PER_MS) {
		int64_t begin = now_ns, spent = 0;

		while (now_ns < begin + 10 * NS_PER_S) {
			change_goes_after(cost_ns);
			spent += cost_ns;
		}
		TEST_ASSERT_INT64_WITHIN(NS_PER_S / 100, NS_PER_S / 2, spent);
		now_ns += NS_PER_S;
	}
}

static void test_nothing_goes_out_when_nothing_changed(void)
{
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, pace_due(&pace));
	TEST_ASSERT_FALSE(pace_send(&pace, now_ns, cursor));
	TEST_ASSERT_EQUAL_UINT64(0, pace.sent);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_change_after_a_silence_goes_at_once);
	RUN_TEST(test_the_next_ones_wait_for_20_ms_at_least);
	RUN_TEST(test_what_costs_more_rests_longer_and_never_longer_than_100_ms);
	RUN_TEST(test_what_is_spent_while_a_change_waits_counts_too);
	RUN_TEST(test_streams_cost_a_twentieth_of_a_processor);
	RUN_TEST(test_nothing_goes_out_when_nothing_changed);
	return UNITY_END();
}
