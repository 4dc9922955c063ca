/* SPDX-License-Identifier: MIT */
/* Tests of the pauses before the next attempt at a broker or a server. */
#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/kit/backoff.h"

static struct backoff backoff;

void setUp(void)
{
	backoff = (struct backoff){0};
}

void tearDown(void)
{
}

/* The longest pause that any random number gives, and the shortest. */
static int64_t longest(enum backoff_why why)
{
	struct backoff copy = backoff;
	int64_t least, most;

	least = backoff_pause(&copy, why, 0);
	most = backoff_pause(&backoff, why, (uint64_t)8 * least - 1);
	TEST_ASSERT_EQUAL_INT64(9 * least - 1, most);
	return most + 1;
}

static void test_who_is_away_is_asked_again_within_15_seconds_for_ever(void)
{
	static const double first[] = {2.25, 4.5, 9, 13.5, 13.5};

	for (int i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_INT64(first[i] * NS_PER_S, longest(BACKOFF_AWAY));
	for (int i = 0; i < 1000; i++)
		TEST_ASSERT_EQUAL_INT64(13.5 * NS_PER_S, longest(BACKOFF_AWAY));
}

static void test_who_refuses_is_left_alone_for_up_to_a_minute(void)
{
	static const double first[] = {2.25, 4.5, 9, 18, 36, 67.5, 67.5};

	for (int i = 0; i < 7; i++)
		TEST_ASSERT_EQUAL_INT64(first[i] * NS_PER_S, longest(BACKOFF_REFUSED));
}

static void test_pauses_are_spread_over_their_whole_step(void)
{
	int64_t step = 12 * NS_PER_S;

	TEST_ASSERT_EQUAL_INT64(step / 8, backoff_spread(step, 0));
	TEST_ASSERT_EQUAL_INT64(step / 8 + step / 2, backoff_spread(step, (uint64_t)step / 2));
	TEST_ASSERT_EQUAL_INT64(step / 8, backoff_spread(step, (uint64_t)step));
	TEST_ASSERT_NOT_EQUAL_INT64(backoff_random(), backoff_random());
}

static void test_each_outage_begins_with_short_pauses_and_a_refusal_is_not_forgotten(void)
{
	for (int i = 0; i < 5; i++) {
		longest(BACKOFF_AWAY);
		longest(BACKOFF_REFUSED);
	}
	/* a refusal is an answer, too */
	TEST_ASSERT_EQUAL_INT64(2.25 * NS_PER_S, longest(BACKOFF_AWAY));
	backoff_met(&backoff);
	TEST_ASSERT_EQUAL_INT64(2.25 * NS_PER_S, longest(BACKOFF_AWAY));
	TEST_ASSERT_EQUAL_INT64(67.5 * NS_PER_S, longest(BACKOFF_REFUSED));
	backoff_forget(&backoff);
	TEST_ASSERT_EQUAL_INT64(2.25 * NS_PER_S, longest(BACKOFF_REFUSED));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_who_is_away_is_asked_again_within_15_seconds_for_ever);
	RUN_TEST(test_who_refuses_is_left_alone_for_up_to_a_minute);
	RUN_TEST(test_pauses_are_spread_over_their_whole_step);
	RUN_TEST(test_each_outage_begins_with_short_pauses_and_a_refusal_is_not_forgotten);
	return UNITY_END();
}
