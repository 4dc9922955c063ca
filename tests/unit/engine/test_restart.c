/* SPDX-License-Identifier: MIT */
/*
 * Which commands are in force after a restart of owsd, row by row of docs/semantics.md, section 3.
 */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

/* Records 1 to 4; the last has both values. */
#define PLAIN "/29.B89115000000/PIO.0"
#define INIT "/29.B89115000000/PIO.1"
#define SAFE "/29.B89115000000/PIO.2"
#define BOTH "/29.B89115000000/PIO.3"
#define ALL_INIT "W " INIT "=10\nW " BOTH "=10\n"
#define ALL_SAFE "W " INIT "=10\nW " SAFE "=20\nW " BOTH "=20\n"
#define ALL_SET "W " PLAIN "=1\nW " INIT "=1\nW " SAFE "=1\nW " BOTH "=1\n"

static void four_outputs(void)
{
	static const char *const paths[] = {PLAIN, INIT, SAFE, BOTH};
	static const char *const names[] = {"plain", "init", "safe", "both"};

	for (unsigned i = 0; i < 4; i++) {
		struct config_item *item = scene_output(&s, names[i], paths[i], OWS_BYTE);

		item->has_init = i & 1;
		item->init_value = 10;
		item->has_safe = i & 2;
		item->safe_value = 20;
		scene_put(&s, paths[i], "0", 0);
	}
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

static void sit(unsigned pid, unsigned period_ms)
{
	*scene_client(&s, 0) = (struct ows_client){.pid = pid, .period_ms = period_ms, .beat = 1};
}

static void set_all(unsigned client, int64_t value)
{
	for (unsigned i = 1; i <= 4; i++) {
		scene_slot(&s, i)->client = client;
		scene_set(&s, i, value);
	}
	scene_run(&s, 200 * SCENE_MS);
}

static void beat_on(int64_t ns)
{
	for (int64_t t = 0; t < ns; t += 100 * SCENE_MS) {
		scene_client(&s, 0)->beat++;
		scene_run(&s, 100 * SCENE_MS);
	}
}

/* A program that beats has set all; its place is left as it is. */
static void living_giver(void)
{
	four_outputs();
	sit(42, 500);
	set_all(1, 1);
	beat_on(SCENE_S);
}

static void restart(void)
{
	scene_restart(&s);
	scene_up(&s);
}

static void test_a_command_of_somebody_who_never_beat_is_not_repeated(void)
{
	four_outputs();
	set_all(0, 1);
	restart();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
	restart();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_a_command_of_somebody_who_ended_in_order_is_not_repeated(void)
{
	living_giver();
	scene_client(&s, 0)->pid = 0;
	restart();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_the_commands_of_a_giver_that_beats_again_stay_in_force(void)
{
	living_giver();
	restart();
	scene_run(&s, 1500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	beat_on(10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SET, s.trace);
	/* and it is their giver still */
	scene_clear_trace(&s);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " SAFE "=20\nW " BOTH "=20\n", s.trace);
}

static void test_of_a_giver_that_does_not_beat_again_safevalue_else_initvalue_is_written(void)
{
	living_giver();
	restart();
	scene_run(&s, 1900 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_clients"));
	TEST_ASSERT_TRUE(scene_sample(&s, 3).flags & OWS_SAMPLE_SAFE);
	TEST_ASSERT_EQUAL_UINT32(0, scene_client(&s, 0)->pid);
}

static void test_a_longer_promise_is_waited_for(void)
{
	four_outputs();
	sit(42, 5000);
	set_all(1, 1);
	restart();
	scene_run(&s, 4900 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
}

static void test_a_giver_that_says_good_bye_after_the_restart_has_ended_in_order(void)
{
	living_giver();
	restart();
	scene_run(&s, SCENE_S);
	scene_client(&s, 0)->pid = 0;
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_who_takes_the_place_of_a_giver_does_not_take_its_commands(void)
{
	living_giver();
	restart();
	sit(43, 500);
	beat_on(5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

/* As ows_close() does, and at once somebody else takes the place. */
static void leave_to(unsigned pid)
{
	for (unsigned i = 1; i <= 4; i++)
		if (scene_slot(&s, i)->client == 1)
			scene_slot(&s, i)->client = 0;
	sit(pid, 500);
}

static void test_a_place_taken_before_the_restart_brings_back_no_commands_of_the_one_before(void)
{
	living_giver();
	leave_to(43);
	beat_on(SCENE_S);
	restart();
	beat_on(5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_who_takes_a_place_at_once_does_not_answer_for_the_outputs_of_the_one_before(void)
{
	living_giver();
	leave_to(43);
	scene_slot(&s, 3)->client = 1;
	scene_set(&s, 3, 5);
	beat_on(SCENE_S);
	scene_clear_trace(&s);
	scene_run(&s, 5 * SCENE_S); /* it beats no more */
	TEST_ASSERT_EQUAL_STRING("W " SAFE "=20\n", s.trace);
}

static void test_the_commands_of_a_program_that_was_lost_do_not_come_back_with_the_next_one(void)
{
	living_giver();
	scene_run(&s, 5 * SCENE_S); /* it beats no more */
	sit(43, 500);
	beat_on(SCENE_S);
	restart();
	beat_on(5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
}

static void test_a_set_while_its_giver_is_awaited_counts_at_once(void)
{
	living_giver();
	restart();
	scene_slot(&s, 2)->client = 0;
	scene_set(&s, 2, 7);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W " INIT "=7\n", s.trace);
	beat_on(5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " INIT "=7\nW " SAFE "=1\nW " BOTH "=1\nW " PLAIN "=1\n",
	                         s.trace);
}

static void test_a_superseded_command_does_not_come_back(void)
{
	living_giver();
	set_all(0, 0);
	restart();
	beat_on(10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_safevalue_stays_in_force_until_somebody_sets(void)
{
	living_giver();
	scene_run(&s, 5 * SCENE_S); /* it beats no more */
	for (unsigned i = 0; i < 2; i++) {
		restart();
		scene_run(&s, 5 * SCENE_S);
		TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
	}
	set_all(0, 1);
	restart();
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_INIT, s.trace);
}

static void test_a_restart_while_the_giver_is_awaited_awaits_it_again(void)
{
	living_giver();
	restart();
	scene_run(&s, SCENE_S);
	restart();
	scene_run(&s, SCENE_S);
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SET, s.trace);
}

static void test_a_reload_while_the_giver_is_awaited_goes_on_awaiting_it(void)
{
	living_giver();
	restart();
	scene_run(&s, 500 * SCENE_MS);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SET, s.trace);
}

static void test_a_command_segment_that_is_lost_takes_what_was_awaited_with_it(void)
{
	struct commands before, renewed;
	void *memory;

	living_giver();
	restart();
	before = s.commands;
	memory = aligned_alloc(64, (before.size + 63) / 64 * 64);
	memset(memory, 0, before.size);
	TEST_ASSERT_EQUAL(0, commands_build(&s.command_plan, memory, &renewed));
	engine_take_commands(s.engine, &renewed, s.now_ns);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
	commands_forget(&before);
	free(s.command_memory);
	s.command_memory = memory;
	s.commands = renewed;
	restart();
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING(ALL_SAFE, s.trace);
}

static void test_a_one_shot_does_not_write_what_is_not_in_force(void)
{
	living_giver();
	restart();
	scene_slot(&s, 2)->one_shot++;
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
}

static void test_a_text_is_withheld_and_comes_back_with_its_giver(void)
{
	struct config_item *item = scene_output(&s, "alias", "/28.551DDF030000/alias", OWS_STRING);

	item->has_init = true;
	item->init_text = "none";
	scene_put(&s, item->path, "", 0);
	scene_start(&s);
	scene_up(&s);
	sit(42, 500);
	scene_slot(&s, 1)->client = 1;
	scene_set_text(&s, 1, "boiler");
	beat_on(SCENE_S);
	restart();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W /28.551DDF030000/alias=boiler\n", s.trace);
	scene_client(&s, 0)->pid = 0;
	restart();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W /28.551DDF030000/alias=none\n", s.trace);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_command_of_somebody_who_never_beat_is_not_repeated);
	RUN_TEST(test_a_command_of_somebody_who_ended_in_order_is_not_repeated);
	RUN_TEST(test_the_commands_of_a_giver_that_beats_again_stay_in_force);
	RUN_TEST(test_of_a_giver_that_does_not_beat_again_safevalue_else_initvalue_is_written);
	RUN_TEST(test_a_longer_promise_is_waited_for);
	RUN_TEST(test_a_giver_that_says_good_bye_after_the_restart_has_ended_in_order);
	RUN_TEST(test_who_takes_the_place_of_a_giver_does_not_take_its_commands);
	RUN_TEST(test_a_place_taken_before_the_restart_brings_back_no_commands_of_the_one_before);
	RUN_TEST(test_who_takes_a_place_at_once_does_not_answer_for_the_outputs_of_the_one_before);
	RUN_TEST(test_the_commands_of_a_program_that_was_lost_do_not_come_back_with_the_next_one);
	RUN_TEST(test_a_set_while_its_giver_is_awaited_counts_at_once);
	RUN_TEST(test_a_superseded_command_does_not_come_back);
	RUN_TEST(test_safevalue_stays_in_force_until_somebody_sets);
	RUN_TEST(test_a_restart_while_the_giver_is_awaited_awaits_it_again);
	RUN_TEST(test_a_reload_while_the_giver_is_awaited_goes_on_awaiting_it);
	RUN_TEST(test_a_command_segment_that_is_lost_takes_what_was_awaited_with_it);
	RUN_TEST(test_a_one_shot_does_not_write_what_is_not_in_force);
	RUN_TEST(test_a_text_is_withheld_and_comes_back_with_its_giver);
	return UNITY_END();
}
