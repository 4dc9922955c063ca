/* SPDX-License-Identifier: MIT */
/* Tests of the limit for jumps: what passes at once, what later, and what never. */
#include <float.h>

#include "unity.h"

#include "src/ground/signal/step.h"

#define S 1000000000LL

static struct step step;
static int64_t now_ns;

void setUp(void)
{
	step = (struct step){0};
	now_ns = S;
}
void tearDown(void)
{
}

/* A new measurement, a second after the last one; the limit is 2 in a second. */
static bool passes(double value)
{
	return step_passes(&step, 2, value, now_ns += S);
}

static void begin(double value)
{
	passes(value);
	TEST_ASSERT_TRUE(passes(value));
}

static void test_the_first_value_has_to_be_confirmed(void)
{
	TEST_ASSERT_FALSE(passes(80.5625));
	TEST_ASSERT_FALSE(passes(-16));
	TEST_ASSERT_TRUE(passes(-16.5));
	TEST_ASSERT_EQUAL_DOUBLE(-16.5, step.good);
}

static void test_what_is_within_the_step_passes_at_once(void)
{
	begin(-16);
	TEST_ASSERT_TRUE(passes(-14));
	TEST_ASSERT_TRUE(passes(-16));
	TEST_ASSERT_FALSE(passes(-18.0625));
}

static void test_a_spike_never_passes(void)
{
	begin(-16);
	for (int i = 0; i < 100; i++) {
		TEST_ASSERT_FALSE(passes(80.5625));
		TEST_ASSERT_TRUE(passes(-16));
	}
}

static void test_a_spike_of_three_seconds_does_not_pass(void)
{
	begin(-16);
	for (int i = 0; i < 10; i++) {
		for (int k = 0; k < 3; k++)
			TEST_ASSERT_FALSE(passes(80.5625));
		TEST_ASSERT_TRUE(passes(-16));
	}
}

static void test_a_true_jump_passes_when_the_value_has_had_the_time_for_it(void)
{
	begin(20);
	for (int i = 1; i < 20; i++)
		TEST_ASSERT_FALSE(passes(60));
	TEST_ASSERT_TRUE(passes(60));
	TEST_ASSERT_TRUE(passes(61));
	TEST_ASSERT_FALSE(passes(20));
}

static void test_what_is_read_seldom_needs_one_more_reading(void)
{
	begin(20);
	now_ns += 99 * S;
	TEST_ASSERT_FALSE(passes(80));
	TEST_ASSERT_TRUE(passes(80.5));
	/* also when that comes late, as on a wire with many chips */
	now_ns += 29 * S;
	TEST_ASSERT_FALSE(passes(60));
	now_ns += 19 * S;
	TEST_ASSERT_TRUE(passes(40));
}

static void test_a_change_that_is_too_fast_passes_when_it_has_ended(void)
{
	begin(0);
	for (int i = 1; i <= 10; i++)
		TEST_ASSERT_FALSE(passes(3 * i));
	for (int i = 11; i < 15; i++)
		TEST_ASSERT_FALSE(passes(30));
	TEST_ASSERT_TRUE(passes(30));
}

static void test_the_same_measurement_given_again_confirms_nothing(void)
{
	begin(-16);
	now_ns += 100 * S;
	TEST_ASSERT_FALSE(step_passes(&step, 2, 80, now_ns));
	TEST_ASSERT_FALSE(step_passes(&step, 2, 80, now_ns));
	/* nor does an older one that came late */
	TEST_ASSERT_FALSE(step_passes(&step, 2, 81, now_ns - S));
	TEST_ASSERT_EQUAL_DOUBLE(80, step.doubt);
	TEST_ASSERT_TRUE(step_passes(&step, 2, 80, now_ns + S));
}

static void test_the_last_good_value_given_again_is_good(void)
{
	begin(-16);
	TEST_ASSERT_TRUE(step_passes(&step, 2, -16, now_ns));
}

static void test_a_spike_before_does_not_confirm_one_after_a_good_value(void)
{
	begin(-16);
	now_ns += 100 * S;
	TEST_ASSERT_FALSE(passes(80));
	TEST_ASSERT_TRUE(passes(-16));
	now_ns += 100 * S;
	TEST_ASSERT_FALSE(passes(80));
}

static void test_what_is_known_to_be_true_needs_no_second_reading(void)
{
	step_begin(&step, 5, S);
	TEST_ASSERT_TRUE(passes(6));
	TEST_ASSERT_FALSE(passes(0));
}

static void test_the_widest_jump_there_is_does_not_pass(void)
{
	begin(-DBL_MAX);
	for (int i = 0; i < 100; i++)
		TEST_ASSERT_FALSE(passes(DBL_MAX));
	TEST_ASSERT_TRUE(passes(-DBL_MAX));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_value_has_to_be_confirmed);
	RUN_TEST(test_what_is_within_the_step_passes_at_once);
	RUN_TEST(test_a_spike_never_passes);
	RUN_TEST(test_a_spike_of_three_seconds_does_not_pass);
	RUN_TEST(test_a_true_jump_passes_when_the_value_has_had_the_time_for_it);
	RUN_TEST(test_what_is_read_seldom_needs_one_more_reading);
	RUN_TEST(test_a_change_that_is_too_fast_passes_when_it_has_ended);
	RUN_TEST(test_the_same_measurement_given_again_confirms_nothing);
	RUN_TEST(test_the_last_good_value_given_again_is_good);
	RUN_TEST(test_a_spike_before_does_not_confirm_one_after_a_good_value);
	RUN_TEST(test_what_is_known_to_be_true_needs_no_second_reading);
	RUN_TEST(test_the_widest_jump_there_is_does_not_pass);
	return UNITY_END();
}
