/* SPDX-License-Identifier: MIT */
/*
 * Programs that write past libows into their memories: what they may not set, and what they may
 * cost.
 */
#include <stdlib.h>

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

/* By all that a program can put into its memory, past libows. */
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

static void test_a_controller_that_marks_without_end_keeps_no_other_waiting(void)
{
	one_of_each();
	scene_join(&s, 1, 2);
	for (int i = 0; i < 20000; i++) {
		giving_mark(&s.controllers[1], 0);
		giving_mark(&s.controllers[1], 1);
		engine_step(s.engine, s.now_ns);
	}
	TEST_ASSERT_GREATER_THAN_UINT64(0, scene_counter(&s, "deferred_commands"));
	giving_mark(&s.controllers[1], 0);
	TEST_ASSERT_FALSE(engine_controllers_marked(s.engine)); /* the engine may sleep */
	scene_set(&s, 2, 9);
	TEST_ASSERT_TRUE(engine_controllers_marked(s.engine));
	engine_step(s.engine, s.now_ns);
	TEST_ASSERT_EQUAL_UINT32(1, scene_slot(&s, 2)->taken);
}

static void test_the_word_of_marks_alone_stored_without_end_is_left_for_later_too(void)
{
	unsigned awake = 0;

	one_of_each();
	scene_join(&s, 1, 2);
	for (int i = 0; i < 20000; i++) {
		giving_header(&s.controllers[1])->marked = 1;
		awake += engine_controllers_marked(s.engine);
		engine_step(s.engine, s.now_ns);
	}
	TEST_ASSERT_LESS_THAN_UINT(6000, awake);
}

static void test_shelving_without_end_is_left_for_later_too(void)
{
	unsigned looked = 0;

	one_of_each();
	scene_join(&s, 1, 2);
	for (int i = 0; i < 20000; i++) {
		giving_shelf(&s.controllers[1])->count++;
		giving_shelf(&s.controllers[1])->record = (uint32_t)i * 7919;
		giving_header(&s.controllers[1])->marked = 1;
		engine_step(s.engine, s.now_ns);
		looked += giving_shelf(&s.controllers[1])->done ==
		          giving_shelf(&s.controllers[1])->count;
	}
	TEST_ASSERT_LESS_THAN_UINT(6000, looked);
}

static void test_a_memory_full_of_rubbish_harms_no_other_controller(void)
{
	uint32_t *words;

	one_of_each();
	scene_allow(&s, 1, 1); /* the output is not its */
	scene_join(&s, 1, 2);
	words = (void *)s.controllers[1].memory.base;
	srand(1);
	for (int round = 0; round < 300; round++) {
		for (uint32_t i = 0; i < s.layout->header.size / 4; i++)
			words[i] = (uint32_t)rand() << 16 ^ (uint32_t)rand();
		giving_header(&s.controllers[1])->marked = 1;
		scene_set(&s, 2, round & 255);
		scene_run(&s, 20 * SCENE_MS);
		TEST_ASSERT_EQUAL_INT(round & 255, atoi(scene_at(&s, PIO)));
		TEST_ASSERT_EQUAL_UINT32(scene_slot(&s, 2)->stamp, scene_applied(&s, 2));
	}
	scene_leave(&s, 1);
	TEST_ASSERT_EQUAL_STRING("controller0", scene_origin(&s, 2).who.name);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_input_that_the_file_does_not_make_writable_is_never_written);
	RUN_TEST(test_marks_without_end_are_left_for_later_and_keep_no_set_waiting);
	RUN_TEST(test_a_program_that_sets_a_thousand_times_a_second_is_never_made_to_wait);
	RUN_TEST(test_a_controller_that_marks_without_end_keeps_no_other_waiting);
	RUN_TEST(test_the_word_of_marks_alone_stored_without_end_is_left_for_later_too);
	RUN_TEST(test_shelving_without_end_is_left_for_later_too);
	RUN_TEST(test_a_memory_full_of_rubbish_harms_no_other_controller);
	return UNITY_END();
}
