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

static int64_t interval(int64_t start_ns, int64_t measured_ns, uint32_t count)
{
	const struct ows_value v = {
		.measured_ns = measured_ns, .tried_ns = measured_ns + 5000, .count = count};

	return show_interval(start_ns, &v);
}

static void test_an_interval_is_that_of_all_readings_since_the_start(void)
{
	TEST_ASSERT_EQUAL_INT64(100, interval(1000, 2000, 10));
	TEST_ASSERT_EQUAL_INT64(500, interval(1000, 2000, 2));
}

static void test_nothing_is_said_before_the_second_reading_or_without_a_start(void)
{
	TEST_ASSERT_EQUAL_INT64(0, interval(1000, 2000, 0));
	TEST_ASSERT_EQUAL_INT64(0, interval(1000, 2000, 1));
	TEST_ASSERT_EQUAL_INT64(0, interval(0, 2000, 10));
	TEST_ASSERT_EQUAL_INT64(0, interval(1000, 900, 10));
}

/* A cache gives the same measurement many times: it is as old as that in time. */
static void test_what_a_cache_has_given_last_is_no_older_than_usual(void)
{
	struct ows_value v = {.measured_ns = 2000, .tried_ns = 2700, .count = 10};

	v.detail = OWS_DETAIL_CACHED;
	TEST_ASSERT_EQUAL_INT64(700, show_interval(1000, &v));
	v.tried_ns = 2050;
	TEST_ASSERT_EQUAL_INT64(100, show_interval(1000, &v));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_interval_is_that_of_all_readings_since_the_start);
	RUN_TEST(test_nothing_is_said_before_the_second_reading_or_without_a_start);
	RUN_TEST(test_what_a_cache_has_given_last_is_no_older_than_usual);
	return UNITY_END();
}
