/* SPDX-License-Identifier: MIT */
/*
 * Which command is in force after a restart of owsd: the table of docs/semantics.md, section 3,
 * cell by cell, and commands that were superseded.
 */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/command/intake.h"
#include "src/daemon/engine/state.h"
#include "tests/unit/aid/force_scene.h"

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

/* --- A restart -------------------------------------------------------------------------------- */

static void test_a_controller_that_comes_back_in_time_has_its_commands_in_force(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_run(&s, 1900 * SCENE_MS);
	expect_outputs(nothing); /* InitValue is withheld */
	come_back();
	beat_on(10 * SCENE_S);
	expect_outputs(command);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_RETURNED, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_STRING("controller1", scene_origin(&s, 1).who.name);
}

/* owsd looks at a slot just before it writes: what came since it heard the controller counts
 * too. */
static void test_a_promise_that_comes_along_with_a_command_is_known_with_it(void)
{
	controller_set_all(false);
	giving_beat(&s.controllers[1], BEAT_MS);
	giving_set(&s.controllers[1], 1, OTHER);
	engine_intake_signal(s.engine, &s.engine->table.signals[0]);
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	expect_outputs((struct row){OTHER, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT});
}

static void test_a_controller_that_came_back_answers_for_its_outputs_again(void)
{
	controller_set_all(true);
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	scene_clear_trace(&s);
	scene_run(&s, 5 * SCENE_S); /* it hangs */
	expect_outputs(lost_running);
}

static void test_a_controller_that_came_back_and_never_beats_is_lost(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_join(&s, 1, 2);
	scene_run(&s, 200 * SCENE_MS);
	expect_outputs(command);
	scene_clear_trace(&s);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
}

static void test_a_controller_that_came_back_gets_to_know_that_its_command_is_applied(void)
{
	uint32_t stamp;

	controller_set_all(true);
	stamp = giving_slot(&s.controllers[1], 1)->stamp;
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(stamp, giving_slot(&s.controllers[1], 1)->taken);
	TEST_ASSERT_EQUAL_UINT32(stamp, giving_slot(&s.controllers[1], 1)->applied);
}

static void test_a_command_of_an_output_is_applied_anew_when_it_is_written_after_a_restart(void)
{
	uint32_t stamp;

	controller_set_all(true);
	stamp = giving_slot(&s.controllers[1], 1)->stamp;
	scene_reload(&s, NULL); /* it remembers that all was applied */
	restart_owsd();
	s.bus[0].latency_ns = SCENE_S;
	come_back();
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(stamp, giving_slot(&s.controllers[1], 1)->taken);
	TEST_ASSERT_EQUAL_UINT32(0, giving_slot(&s.controllers[1], 1)->applied);
	beat_on(2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(stamp, giving_slot(&s.controllers[1], 1)->applied);
}

static void test_a_promise_is_known_as_soon_as_the_command_is_written(void)
{
	start_outputs();
	scene_clear_trace(&s);
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
	for (unsigned i = 1; i <= OUTPUTS; i++)
		scene_set_by(&s, 1, i, NEXT);
	scene_run(&s, 20 * SCENE_MS); /* less than a period */
	expect_outputs(command);
	restart_owsd();
	scene_run(&s, 200 * SCENE_MS);
	come_back();
	beat_on(SCENE_S);
	expect_outputs(command);
}

static void test_a_longer_promise_is_waited_for(void)
{
	start_outputs();
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], 5000);
	set_all(1, NEXT);
	restart_owsd();
	scene_run(&s, 4900 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 2 * SCENE_S);
	expect_outputs(lost);
}

/* libows refuses it; a program may write it all the same, and so did a controller of an older
 * owsd. */
static void test_a_promise_of_more_than_an_hour_is_one_of_an_hour(void)
{
	start_outputs();
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], UINT32_MAX);
	set_all(1, NEXT);
	restart_owsd();
	scene_run(&s, 3599 * SCENE_S);
	expect_outputs(nothing);
	scene_run(&s, 2 * SCENE_S);
	expect_outputs(lost);
}

static void test_a_controller_that_said_goodbye_does_not_come_back(void)
{
	controller_set_all(true);
	scene_goodbye(&s, 1);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(nothing);
	restart_owsd();
	scene_run(&s, 10 * SCENE_S);
	expect_outputs(ended);
	restart_owsd(); /* and so each time */
	scene_run(&s, 10 * SCENE_S);
	expect_outputs(ended);
}

static void test_of_a_controller_that_never_beat_no_command_comes_back(void)
{
	controller_set_all(false);
	restart_owsd();
	come_back();
	beat_on(10 * SCENE_S);
	expect_outputs(ended);
}

static void test_a_controller_that_is_dead_or_hangs_over_a_restart_leaves_safevalue(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_run(&s, 1900 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 10 * SCENE_S);
	expect_outputs(lost);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_controllers"));
	TEST_ASSERT_TRUE(scene_sample(&s, 3).flags & OWS_SAMPLE_SAFE);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SAFE, scene_origin(&s, 3).reason);
	TEST_ASSERT_EQUAL_STRING("controller1", scene_origin(&s, 3).who.name);
	/* too late */
	come_back();
	scene_clear_trace(&s);
	beat_on(5 * SCENE_S);
	expect_outputs(nothing);
}

static void test_another_program_at_the_place_of_an_awaited_controller_is_not_that_controller(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_join(&s, 1, 3);
	beat_on(10 * SCENE_S);
	expect_outputs(lost);
}

static void test_the_token_of_another_user_brings_nothing_back(void)
{
	controller_set_all(true);
	restart_owsd();
	s.uid = 1001;
	come_back();
	beat_on(10 * SCENE_S);
	expect_outputs(lost);
}

static void test_safevalue_stays_in_force_over_restarts_until_somebody_sets(void)
{
	controller_set_all(true);
	scene_run(&s, 5 * SCENE_S); /* it hangs */
	expect_outputs(lost_running);
	for (int i = 0; i < 2; i++) {
		restart_owsd();
		scene_run(&s, 5 * SCENE_S);
		/* of the others nobody answers for the command any more */
		expect_outputs((struct row){NOTHING, INIT, SAFE, SAFE, NEXT, NEXT, SAFE, SAFE});
	}
	scene_join(&s, 0, 1);
	set_all(0, OTHER);
	restart_owsd();
	scene_run(&s, 5 * SCENE_S);
	expect_outputs((struct row){NOTHING, INIT, NOTHING, INIT, OTHER, OTHER, OTHER, OTHER});
}

static void test_a_restart_while_the_controller_is_awaited_awaits_it_again(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_run(&s, SCENE_S);
	restart_owsd();
	scene_run(&s, SCENE_S);
	expect_outputs(nothing);
	come_back();
	beat_on(SCENE_S);
	expect_outputs(command);
}

static void test_a_reload_while_the_controller_is_awaited_goes_on_awaiting_it(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_run(&s, 500 * SCENE_MS);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	expect_outputs(nothing);
	come_back();
	beat_on(SCENE_S);
	expect_outputs(command);
}

static void test_a_set_while_the_controller_is_awaited_counts_at_once(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_join(&s, 0, 1);
	set_all(0, OTHER);
	expect_outputs((struct row){OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER});
	come_back();
	beat_on(5 * SCENE_S);
	expect_outputs((struct row){OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER});
}

static void test_a_one_shot_does_not_write_what_is_not_in_force(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_join(&s, 0, 1);
	scene_slot(&s, 2)->one_shot++;
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	expect_outputs(nothing);
}

static void test_a_text_is_withheld_and_comes_back_with_its_controller(void)
{
	struct config_item *item = scene_output(&s, "alias", "/28.551DDF030000/alias", OWS_STRING);

	item->has_init = true;
	item->init_text = "none";
	scene_put(&s, item->path, "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
	giving_set_text(&s.controllers[1], 1, "boiler");
	beat_on(SCENE_S);
	restart_owsd();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W /28.551DDF030000/alias=boiler\n", s.trace);
	scene_goodbye(&s, 1);
	restart_owsd();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W /28.551DDF030000/alias=none\n", s.trace);
}

/* --- An input with Writable on ---------------------------------------------------------------- */

/*
 * A set of it was an event, which owsd does not repeat: the device may have counted on since. But
 * that its program is lost is another event.
 */
#define CLOCK "/27.000000000001/udate"

static void set_clock(bool safe)
{
	struct config_item *item = scene_input(&s, "clock", CLOCK, OWS_DWORD);

	item->writable = true;
	item->has_safe = safe;
	item->safe_value = SAFE;
	scene_put(&s, CLOCK, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
	scene_set_by(&s, 1, 1, NEXT);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, CLOCK));
}

static void a_clock(bool safe)
{
	set_clock(safe);
	restart_owsd();
	scene_put(&s, CLOCK, "31", 0);
}

static const struct ows_command_slot *clock_slot(void)
{
	return giving_slot(&s.controllers[1], 1);
}

static void write_clock_once_more(const char *expected)
{
	scene_put(&s, CLOCK, "0", 0);
	giving_slot(&s.controllers[1], 1)->one_shot++;
	giving_mark(&s.controllers[1], 1);
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING(expected, scene_at(&s, CLOCK));
}

static void test_what_was_set_of_an_input_is_not_written_when_its_controller_comes_back(void)
{
	a_clock(false);
	for (int i = 0; i < 2; i++) {
		come_back();
		beat_on(5 * SCENE_S);
		TEST_ASSERT_EQUAL_STRING("31", scene_at(&s, CLOCK));
		TEST_ASSERT_EQUAL_INT64(31, scene_sample(&s, 1).value);
		TEST_ASSERT_EQUAL_UINT(OWS_REASON_RETURNED, scene_origin(&s, 1).reason);
		restart_owsd();
	}
	come_back();
	beat_on(SCENE_S);
	scene_set_by(&s, 1, 1, NEXT); /* the same number is another set */
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, CLOCK));
}

static void test_a_set_of_an_input_that_was_written_is_applied_over_restarts(void)
{
	uint32_t stamp;

	set_clock(false);
	stamp = clock_slot()->stamp;
	for (int i = 0; i < 2; i++) {
		restart_owsd();
		come_back();
		beat_on(SCENE_S);
		TEST_ASSERT_NULL(strstr(s.trace, "W "));
		TEST_ASSERT_EQUAL_UINT32(stamp, clock_slot()->taken);
		TEST_ASSERT_EQUAL_UINT32(stamp, clock_slot()->applied);
		TEST_ASSERT_EQUAL_INT32(0, clock_slot()->err);
		TEST_ASSERT_EQUAL_UINT(0, scene_sample(&s, 1).flags & OWS_SAMPLE_PENDING);
		TEST_ASSERT_EQUAL_UINT32(0, scene_sample(&s, 1).confirmed);
	}
	restart_owsd(); /* while it is awaited */
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(stamp, clock_slot()->applied);
	write_clock_once_more("30");
}

/* Taken, and with the bus, when owsd is killed: the device may have it, and may not. */
static void kill_before_the_clock_is_set(void)
{
	s.bus[0].latency_ns = 10 * SCENE_S;
	giving_beat(&s.controllers[1], BEAT_MS);
	scene_set_by(&s, 1, 1, OTHER);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(clock_slot()->stamp, clock_slot()->taken);
	TEST_ASSERT_NOT_EQUAL_UINT32(clock_slot()->stamp, clock_slot()->applied);
	s.bus[0].latency_ns = SCENE_MS;
	restart_owsd();
}

static void test_a_set_of_an_input_that_was_not_written_is_refused_after_a_restart(void)
{
	uint32_t stamp;

	set_clock(false);
	stamp = clock_slot()->stamp + 1;
	kill_before_the_clock_is_set();
	come_back();
	beat_on(5 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
	TEST_ASSERT_EQUAL_UINT32(stamp, clock_slot()->taken);
	TEST_ASSERT_EQUAL_INT32(-ESTALE, clock_slot()->err);
	TEST_ASSERT_EQUAL_UINT32(0, clock_slot()->applied);
	TEST_ASSERT_EQUAL_UINT(0, scene_sample(&s, 1).flags & OWS_SAMPLE_PENDING);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "refused_commands"));
	write_clock_once_more("40");
	TEST_ASSERT_EQUAL_UINT32(0, clock_slot()->applied); /* the set stays refused */
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(0, clock_slot()->applied);
	scene_set_by(&s, 1, 1, OTHER); /* the same number is another set */
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_STRING("40", scene_at(&s, CLOCK));
	TEST_ASSERT_EQUAL_UINT32(clock_slot()->stamp, clock_slot()->applied);
	TEST_ASSERT_EQUAL_INT32(0, clock_slot()->err);
}

static void test_a_text_of_an_input_that_was_written_is_not_written_again_but_set_again_is(void)
{
	struct config_item *item = scene_input(&s, "text", "/23.000000000001/memory", OWS_STRING);

	item->writable = true;
	scene_put(&s, item->path, "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
	giving_set_text(&s.controllers[1], 1, "boiler");
	beat_on(SCENE_S);
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
	giving_set_text(&s.controllers[1], 1, "boiler");
	beat_on(SCENE_S);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "W /23.000000000001/memory=boiler\n"));
}

static void test_the_controller_of_a_refused_set_of_an_input_leaves_safevalue(void)
{
	set_clock(true);
	kill_before_the_clock_is_set();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
	scene_run(&s, 5 * SCENE_S); /* it hangs */
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, CLOCK));
}

static void test_of_an_input_nothing_is_written_when_its_controller_does_not_come_back(void)
{
	a_clock(false);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 1).reason);
}

static void test_an_input_gets_its_safevalue_once_when_its_controller_is_lost(void)
{
	a_clock(true);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, CLOCK));
	restart_owsd();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
}

static void test_an_input_gets_its_safevalue_when_a_controller_that_came_back_is_lost(void)
{
	a_clock(true);
	come_back();
	beat_on(5 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W "));
	scene_run(&s, 5 * SCENE_S); /* it hangs */
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, CLOCK));
}

/* --- Renamed outputs -------------------------------------------------------------------------- */

static void test_an_output_that_was_renamed_over_a_restart_has_its_command(void)
{
	static const char *const names[OUTPUTS] = {"a", "b", "c", "d", "e", "f", "g", "h"};

	controller_set_all(true);
	for (unsigned i = 0; i < OUTPUTS; i++)
		s.items[i].name = names[i];
	restart_owsd();
	scene_run(&s, SCENE_S);
	expect_outputs(nothing);
	come_back();
	beat_on(SCENE_S);
	expect_outputs(command);
}

static void test_outputs_that_swap_their_names_over_a_restart_keep_their_commands(void)
{
	const char *name;

	controller_set_all(true);
	scene_set_by(&s, 1, 1, OTHER);
	beat_on(SCENE_S);
	name = s.items[0].name;
	s.items[0].name = s.items[1].name;
	s.items[1].name = name;
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	expect_outputs((struct row){OTHER, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT});
}

static void test_a_new_output_has_nothing_of_another_one_of_its_path(void)
{
	controller_set_all(true);
	s.items[0].name = "new";
	s.items[0].path = s.items[4].path;
	restart_owsd();
	come_back();
	beat_on(SCENE_S);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_RETURNED, scene_origin(&s, 5).reason);
}

/* --- Superseded commands ---------------------------------------------------------------------- */

static void test_a_superseded_command_does_not_come_back_with_its_controller(void)
{
	controller_set_all(true);
	set_all(0, OTHER); /* by one who never beat */
	scene_clear_trace(&s);
	restart_owsd();
	come_back();
	beat_on(10 * SCENE_S);
	expect_outputs((struct row){NOTHING, INIT, NOTHING, INIT, OTHER, OTHER, OTHER, OTHER});
}

static void test_a_superseded_controller_that_dies_leaves_the_outputs_as_they_are(void)
{
	controller_set_all(true);
	set_all(0, OTHER);
	scene_clear_trace(&s);
	scene_leave(&s, 1);
	scene_run(&s, 10 * SCENE_S);
	expect_outputs(nothing);
}

static void test_of_two_controllers_that_beat_the_one_in_force_comes_back(void)
{
	controller_set_all(true);
	giving_beat(&s.controllers[0], BEAT_MS);
	set_all(0, OTHER);
	restart_owsd();
	come_back(); /* the superseded one */
	beat_on(SCENE_S);
	expect_outputs(nothing);
	scene_join(&s, 0, 1);
	giving_beat(&s.controllers[0], BEAT_MS);
	scene_run(&s, 200 * SCENE_MS);
	expect_outputs((struct row){OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER});
}

static void test_safevalue_is_not_undone_by_the_controller_that_was_lost(void)
{
	controller_set_all(true);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
	scene_clear_trace(&s);
	beat_on(5 * SCENE_S); /* it goes on */
	expect_outputs(nothing);
	scene_leave(&s, 1);
	come_back();
	beat_on(5 * SCENE_S);
	expect_outputs(nothing);
	set_all(1, OTHER); /* until it sets */
	expect_outputs((struct row){OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER, OTHER});
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_controller_that_comes_back_in_time_has_its_commands_in_force);
	RUN_TEST(test_a_promise_that_comes_along_with_a_command_is_known_with_it);
	RUN_TEST(test_a_controller_that_came_back_answers_for_its_outputs_again);
	RUN_TEST(test_a_controller_that_came_back_and_never_beats_is_lost);
	RUN_TEST(test_a_controller_that_came_back_gets_to_know_that_its_command_is_applied);
	RUN_TEST(test_a_command_of_an_output_is_applied_anew_when_it_is_written_after_a_restart);
	RUN_TEST(test_a_promise_is_known_as_soon_as_the_command_is_written);
	RUN_TEST(test_a_longer_promise_is_waited_for);
	RUN_TEST(test_a_promise_of_more_than_an_hour_is_one_of_an_hour);
	RUN_TEST(test_a_controller_that_said_goodbye_does_not_come_back);
	RUN_TEST(test_of_a_controller_that_never_beat_no_command_comes_back);
	RUN_TEST(test_a_controller_that_is_dead_or_hangs_over_a_restart_leaves_safevalue);
	RUN_TEST(test_another_program_at_the_place_of_an_awaited_controller_is_not_that_controller);
	RUN_TEST(test_the_token_of_another_user_brings_nothing_back);
	RUN_TEST(test_safevalue_stays_in_force_over_restarts_until_somebody_sets);
	RUN_TEST(test_a_restart_while_the_controller_is_awaited_awaits_it_again);
	RUN_TEST(test_a_reload_while_the_controller_is_awaited_goes_on_awaiting_it);
	RUN_TEST(test_a_set_while_the_controller_is_awaited_counts_at_once);
	RUN_TEST(test_a_one_shot_does_not_write_what_is_not_in_force);
	RUN_TEST(test_a_text_is_withheld_and_comes_back_with_its_controller);
	RUN_TEST(test_what_was_set_of_an_input_is_not_written_when_its_controller_comes_back);
	RUN_TEST(test_a_set_of_an_input_that_was_written_is_applied_over_restarts);
	RUN_TEST(test_a_set_of_an_input_that_was_not_written_is_refused_after_a_restart);
	RUN_TEST(test_a_text_of_an_input_that_was_written_is_not_written_again_but_set_again_is);
	RUN_TEST(test_the_controller_of_a_refused_set_of_an_input_leaves_safevalue);
	RUN_TEST(test_of_an_input_nothing_is_written_when_its_controller_does_not_come_back);
	RUN_TEST(test_an_input_gets_its_safevalue_once_when_its_controller_is_lost);
	RUN_TEST(test_an_input_gets_its_safevalue_when_a_controller_that_came_back_is_lost);
	RUN_TEST(test_an_output_that_was_renamed_over_a_restart_has_its_command);
	RUN_TEST(test_outputs_that_swap_their_names_over_a_restart_keep_their_commands);
	RUN_TEST(test_a_new_output_has_nothing_of_another_one_of_its_path);
	RUN_TEST(test_a_superseded_command_does_not_come_back_with_its_controller);
	RUN_TEST(test_a_superseded_controller_that_dies_leaves_the_outputs_as_they_are);
	RUN_TEST(test_of_two_controllers_that_beat_the_one_in_force_comes_back);
	RUN_TEST(test_safevalue_is_not_undone_by_the_controller_that_was_lost);
	return UNITY_END();
}
