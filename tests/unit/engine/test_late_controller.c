/* SPDX-License-Identifier: MIT */
/*
 * Who is late: a controller that sets but does not beat is, and nobody is for the time in which
 * nobody ran (a suspend, a guest that was paused).
 */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

#define PIO "/05.000000000001/PIO"
#define BEAT_MS 500

static struct scene s;

void setUp(void)
{
	struct config_item *item;

	scene_init(&s);
	item = scene_output(&s, "pump", PIO, OWS_BYTE);
	item->has_safe = true;
	item->safe_value = 20;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
	scene_set_by(&s, 1, 1, 30);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, PIO));
}

void tearDown(void)
{
	scene_end(&s);
}

static void beat_on(int64_t ns)
{
	for (int64_t t = 0; t < ns; t += 100 * SCENE_MS) {
		giving_beat(&s.controllers[1], BEAT_MS);
		scene_run(&s, 100 * SCENE_MS);
	}
}

/* The controller is connected and beats, and its command was never replaced. */
static void expect_its_command(void)
{
	beat_on(5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "safe_outputs"));
}

static void test_what_a_controller_sets_that_is_late_goes_to_safevalue_too(void)
{
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, PIO));
	scene_set_by(&s, 1, 1, 40);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT64(2, scene_counter(&s, "safe_outputs"));
}

static void test_time_in_which_nobody_ran_makes_no_controller_late(void)
{
	s.now_ns += 100 * SCENE_S;
	scene_run(&s, 200 * SCENE_MS);
	expect_its_command();
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "lost_controllers"));
}

static void test_neither_does_a_time_that_is_hardly_longer_than_its_promise(void)
{
	s.now_ns += 600 * SCENE_MS;
	scene_run(&s, 200 * SCENE_MS);
	expect_its_command();
}

static void test_after_such_a_time_a_controller_that_hangs_is_late(void)
{
	s.now_ns += 100 * SCENE_S;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, PIO));
}

static void test_such_a_time_does_not_end_the_wait_for_a_controller_of_before_the_start(void)
{
	scene_restart(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	s.now_ns += 100 * SCENE_S;
	scene_run(&s, 500 * SCENE_MS);
	s.controllers[1].stamp = 100;
	scene_join(&s, 1, 2);
	expect_its_command();
}

static void test_such_a_time_does_not_end_the_wait_for_a_controller_that_hung_up(void)
{
	s.now_ns += 100 * SCENE_S; /* the hang-up is the first that owsd sees */
	scene_leave(&s, 1);
	scene_run(&s, 200 * SCENE_MS);
	s.controllers[1].stamp = 100;
	scene_join(&s, 1, 2);
	expect_its_command();
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_a_controller_sets_that_is_late_goes_to_safevalue_too);
	RUN_TEST(test_time_in_which_nobody_ran_makes_no_controller_late);
	RUN_TEST(test_neither_does_a_time_that_is_hardly_longer_than_its_promise);
	RUN_TEST(test_after_such_a_time_a_controller_that_hangs_is_late);
	RUN_TEST(test_such_a_time_does_not_end_the_wait_for_a_controller_of_before_the_start);
	RUN_TEST(test_such_a_time_does_not_end_the_wait_for_a_controller_that_hung_up);
	return UNITY_END();
}
