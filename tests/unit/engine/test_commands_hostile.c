/* SPDX-License-Identifier: MIT */
/*
 * Programs that write past libows into the command segment: what they may not set, and what they
 * may cost.
 */
#include "unity.h"

#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define PIO "/29.000000000002/PIO.BYTE"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

static void one_of_each(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, T1, "21.5", 0);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 150 * SCENE_MS);
	scene_clear_trace(&s);
}

/* By all that a program can put into the command segment, past libows. */
static void test_an_input_that_the_file_does_not_make_writable_is_never_written(void)
{
	one_of_each();
	for (int enabled = 0; enabled < 4; enabled++) {
		scene_slot(&s, 1)->write_enable = (uint32_t)enabled;
		scene_slot(&s, 1)->one_shot++;
		scene_set(&s, 1, 5);
		scene_run(&s, SCENE_S);
		scene_slot(&s, 1)->one_shot++;
		scene_ring(&s, 1);
		scene_run(&s, SCENE_S);
	}
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT64(4, scene_counter(&s, "refused_commands"));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT(0, scene_sample(&s, 1).err);
}

static void test_marks_without_end_are_left_for_later_and_keep_no_set_waiting(void)
{
	uint64_t deferred;

	one_of_each();
	for (int i = 0; i < 20000; i++) {
		scene_ring(&s, 0);
		scene_ring(&s, 1);
		engine_step(s.engine, s.now_ns);
	}
	scene_run(&s, SCENE_S);
	deferred = scene_counter(&s, "deferred_commands");
	TEST_ASSERT_GREATER_THAN_UINT64(0, deferred);
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(2, deferred);
	/* beside a program that marks what stands before it in each step */
	for (int i = 0; i < 20000; i++) {
		scene_ring(&s, 0);
		scene_ring(&s, 1);
		engine_step(s.engine, s.now_ns);
	}
	scene_set(&s, 2, 9);
	for (int i = 0; i < 3000 && !s.writes; i++) {
		scene_ring(&s, 0);
		scene_ring(&s, 1);
		scene_run(&s, 10000);
	}
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_STRING("9", scene_at(&s, PIO));
}

static void test_a_program_that_sets_a_thousand_times_a_second_is_never_made_to_wait(void)
{
	one_of_each();
	for (int i = 0; i < 10000; i++) {
		scene_set(&s, 2, i & 255);
		scene_run(&s, SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "deferred_commands"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_input_that_the_file_does_not_make_writable_is_never_written);
	RUN_TEST(test_marks_without_end_are_left_for_later_and_keep_no_set_waiting);
	RUN_TEST(test_a_program_that_sets_a_thousand_times_a_second_is_never_made_to_wait);
	return UNITY_END();
}
