/* SPDX-License-Identifier: MIT */
/* Tests of what is derived of a signal for the page. */
#include "unity.h"

#include "src/faces/web/show.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_an_interval_is_that_of_all_readings_since_the_start(void)
{
	TEST_ASSERT_EQUAL_INT64(100, show_interval(1000, 2000, 10));
	TEST_ASSERT_EQUAL_INT64(500, show_interval(1000, 2000, 2));
}

static void test_nothing_is_said_before_the_second_reading_or_without_a_start(void)
{
	TEST_ASSERT_EQUAL_INT64(0, show_interval(1000, 2000, 0));
	TEST_ASSERT_EQUAL_INT64(0, show_interval(1000, 2000, 1));
	TEST_ASSERT_EQUAL_INT64(0, show_interval(0, 2000, 10));
	TEST_ASSERT_EQUAL_INT64(0, show_interval(1000, 900, 10));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_interval_is_that_of_all_readings_since_the_start);
	RUN_TEST(test_nothing_is_said_before_the_second_reading_or_without_a_start);
	return UNITY_END();
}
