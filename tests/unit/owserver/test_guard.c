/* SPDX-License-Identifier: MIT */
/* Tests of the guard against power-fault readings of thermometers. */
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"

#include "hal/owserver/judge.h"

#define S 1000000000LL

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_85_out_of_nothing_is_refused(void)
{
	struct guard guard = {0};

	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, S));
}

static void test_85_after_room_temperature_is_refused(void)
{
	struct guard guard = {0};

	TEST_ASSERT_FALSE(guard_refuses(&guard, 21.5, S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, 2 * S));
}

static void test_a_boiler_may_pass_85(void)
{
	struct guard guard = {0};

	TEST_ASSERT_FALSE(guard_refuses(&guard, 83.0625, S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.9375, 2 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0, 3 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0625, 4 * S));
}

static void test_an_old_reading_near_85_does_not_vouch_for_85(void)
{
	struct guard guard = {0};

	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.0, S));
	TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, 100 * S));
}

static void test_a_refused_reading_does_not_vouch_for_the_next(void)
{
	struct guard guard = {0};

	for (int i = 1; i < 10; i++)
		TEST_ASSERT_TRUE(guard_refuses(&guard, 85.0, i * S));
}

static void test_127_94_is_refused_always_in_every_rounding(void)
{
	static const double starved[] = {127.9375, 127.9374,       127.938,        127.937,
	                                 127.94,   127.93,         127.9,          127.95,
	                                 128,      (double)127.9f, (double)127.94f};
	struct guard guard = {0};
	char text[16];

	TEST_ASSERT_FALSE(guard_refuses(&guard, 125.0, S));
	for (unsigned i = 0; i < sizeof(starved) / sizeof(starved[0]); i++)
		TEST_ASSERT_TRUE(guard_refuses(&guard, starved[i], (int)(i + 2) * S));
	for (int decimals = 0; decimals <= 4; decimals++) {
		snprintf(text, sizeof(text), "%.*f", decimals, 127.9375);
		TEST_ASSERT_TRUE_MESSAGE(guard_refuses(&guard, strtod(text, NULL), 60 * S), text);
	}
}

static void test_what_is_no_rounding_of_127_94_is_believed(void)
{
	struct guard guard = {0};

	TEST_ASSERT_FALSE(guard_refuses(&guard, 127.0, S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 127.875, 2 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 129.0, 3 * S));
	TEST_ASSERT_FALSE(guard_refuses(&guard, 1200.0, 4 * S));
}

static void test_neighbours_of_85_are_believed(void)
{
	struct guard guard = {0};

	TEST_ASSERT_FALSE(guard_refuses(&guard, 84.9375, S));
	guard = (struct guard){0};
	TEST_ASSERT_FALSE(guard_refuses(&guard, 85.0625, S));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_85_out_of_nothing_is_refused);
	RUN_TEST(test_85_after_room_temperature_is_refused);
	RUN_TEST(test_a_boiler_may_pass_85);
	RUN_TEST(test_an_old_reading_near_85_does_not_vouch_for_85);
	RUN_TEST(test_a_refused_reading_does_not_vouch_for_the_next);
	RUN_TEST(test_127_94_is_refused_always_in_every_rounding);
	RUN_TEST(test_what_is_no_rounding_of_127_94_is_believed);
	RUN_TEST(test_neighbours_of_85_are_believed);
	return UNITY_END();
}
