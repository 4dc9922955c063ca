/* SPDX-License-Identifier: MIT */
/* Tests of the relation of wall clock and boot time. */
#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/kit/wall_clock.h"
#include "src/public/ows.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_noise_of_readings_is_no_step(void)
{
	struct wall_clock clock = {.offset_ns = 1000 * NS_PER_S, .trusted = true};

	TEST_ASSERT_FALSE(wall_clock_step(&clock, clock.offset_ns + 49 * NS_PER_MS, clock.trusted));
	TEST_ASSERT_FALSE(wall_clock_step(&clock, clock.offset_ns - 49 * NS_PER_MS, clock.trusted));
	TEST_ASSERT_EQUAL_INT64(1000 * NS_PER_S, clock.offset_ns);
}

static void test_a_step_either_way_is_news_once(void)
{
	struct wall_clock clock = {.offset_ns = 1000 * NS_PER_S};

	TEST_ASSERT_TRUE(wall_clock_step(&clock, 5000 * NS_PER_S, false));
	TEST_ASSERT_FALSE(wall_clock_step(&clock, 5000 * NS_PER_S, false));
	TEST_ASSERT_TRUE(wall_clock_step(&clock, -5 * NS_PER_S, false));
	TEST_ASSERT_EQUAL_INT64(-5 * NS_PER_S, clock.offset_ns);
}

static void test_trust_is_news_when_it_comes_and_when_it_goes(void)
{
	struct wall_clock clock = {0};

	TEST_ASSERT_TRUE(wall_clock_step(&clock, 0, true));
	TEST_ASSERT_FALSE(wall_clock_step(&clock, 0, true));
	TEST_ASSERT_TRUE(wall_clock_step(&clock, 0, false));
	TEST_ASSERT_FALSE(clock.trusted);
}

/* A clock that takes many small steps in the same direction is not followed for ever at a loss. */
static void test_small_steps_add_up_to_one(void)
{
	struct wall_clock clock = {0};
	int news = 0;

	for (int i = 1; i <= 100; i++)
		news += wall_clock_step(&clock, i * 10 * NS_PER_MS, false);
	TEST_ASSERT_EQUAL_INT(20, news);
	TEST_ASSERT_EQUAL_INT64(NS_PER_S, clock.offset_ns);
}

static void test_the_clock_of_this_machine_stands_still_beside_boot_time(void)
{
	struct wall_clock clock;

	wall_clock_open(&clock);
	TEST_ASSERT_FALSE(wall_clock_look(&clock, ows_now()));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_noise_of_readings_is_no_step);
	RUN_TEST(test_a_step_either_way_is_news_once);
	RUN_TEST(test_trust_is_news_when_it_comes_and_when_it_goes);
	RUN_TEST(test_small_steps_add_up_to_one);
	RUN_TEST(test_the_clock_of_this_machine_stands_still_beside_boot_time);
	return UNITY_END();
}
