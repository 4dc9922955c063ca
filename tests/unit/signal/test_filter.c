/* SPDX-License-Identifier: MIT */
/* Tests of the low-pass filter: its answer to a step, at times that are not regular. */
#include <float.h>
#include <math.h>

#include "unity.h"

#include "src/ground/signal/filter.h"

#define S 1000000000LL

static const uint64_t seed = 0xf117e2u;

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_first_sample_passes_as_it_is(void)
{
	struct filter filter = {0};

	TEST_ASSERT_EQUAL_DOUBLE(21.5, filter_sample(&filter, 10, 21.5, 5 * S));
	TEST_ASSERT_TRUE(filter.begun);
}

static void test_a_step_goes_63_percent_of_the_way_in_the_time_constant(void)
{
	struct filter filter = {0};

	filter_sample(&filter, 10, 0, 0);
	TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1 - exp(-1), filter_sample(&filter, 10, 1, 10 * S));
}

static void test_samples_between_do_not_change_where_a_step_ends(void)
{
	uint64_t state = seed;

	for (int round = 0; round < 100; round++) {
		struct filter filter = {0};
		int64_t at = 0;

		filter_sample(&filter, 3, 0, 0);
		while (at < 6 * S) {
			state = state * 6364136223846793005u + 1442695040888963407u;
			at += 1 + (int64_t)(state >> 34) % S;
			filter_sample(&filter, 3, 1, at);
		}
		TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1 - exp(-(double)at / (3 * S)), filter.value);
	}
}

static void test_the_same_sample_again_changes_nothing(void)
{
	struct filter filter = {0};

	filter_sample(&filter, 3, 0, 0);
	filter_sample(&filter, 3, 1, S);
	TEST_ASSERT_TRUE(filter_sample(&filter, 3, 1, S) == filter.value);
	TEST_ASSERT_EQUAL_DOUBLE(filter.value, filter_sample(&filter, 3, 9, S / 2));
	TEST_ASSERT_EQUAL_INT64(S, filter.at_ns);
}

static void test_a_steady_value_stays_as_it_is(void)
{
	struct filter filter = {0};

	for (int i = 0; i < 1000; i++)
		TEST_ASSERT_TRUE(filter_sample(&filter, 7, 0.1, i * S / 3) == 0.1);
}

static void test_after_a_long_time_nothing_of_the_old_is_left(void)
{
	struct filter filter = {0};

	filter_sample(&filter, 1, 1e6, 0);
	TEST_ASSERT_TRUE(filter_sample(&filter, 1, 0.3, 1000 * S) == 0.3);
}

static void test_no_sample_makes_it_infinite(void)
{
	struct filter filter = {0};

	filter_sample(&filter, 5, -DBL_MAX, 0);
	TEST_ASSERT_EQUAL_DOUBLE(DBL_MAX, filter_sample(&filter, 5, DBL_MAX, S));
	TEST_ASSERT_TRUE(isfinite(filter_sample(&filter, 5, 0, 2 * S)));
}

static void test_without_a_time_constant_samples_pass(void)
{
	struct filter filter = {0};

	filter_sample(&filter, 0, 1, 0);
	TEST_ASSERT_EQUAL_DOUBLE(2, filter_sample(&filter, 0, 2, 1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_sample_passes_as_it_is);
	RUN_TEST(test_a_step_goes_63_percent_of_the_way_in_the_time_constant);
	RUN_TEST(test_samples_between_do_not_change_where_a_step_ends);
	RUN_TEST(test_the_same_sample_again_changes_nothing);
	RUN_TEST(test_a_steady_value_stays_as_it_is);
	RUN_TEST(test_after_a_long_time_nothing_of_the_old_is_left);
	RUN_TEST(test_no_sample_makes_it_infinite);
	RUN_TEST(test_without_a_time_constant_samples_pass);
	return UNITY_END();
}
