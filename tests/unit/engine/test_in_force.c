/* SPDX-License-Identifier: MIT */
/*
 * Which command is in force: the table of docs/semantics.md, section 3, cell by cell. Over a reload
 * and a reboot, while owsd runs, and when a device loses its power.
 */
#include "unity.h"

#include "tests/unit/aid/force_scene.h"

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

/* --- A reload --------------------------------------------------------------------------------- */

static void test_over_a_reload_the_command_stays_in_force(void)
{
	controller_set_all(false);
	scene_reload(&s, NULL);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(nothing);
	scene_tell(&s, 0, BUS_POR, "/29.000000000001"); /* and is what a device gets again */
	scene_run(&s, SCENE_S);
	expect_outputs(command);
}

static void test_over_a_reload_a_controller_that_beats_goes_on_answering_for_its_outputs(void)
{
	controller_set_all(true);
	scene_reload(&s, NULL);
	beat_on(5 * SCENE_S);
	expect_outputs(nothing);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
}

static void test_over_a_reload_a_controller_that_hung_up_goes_on_being_awaited(void)
{
	controller_set_all(true);
	scene_leave(&s, 1);
	scene_reload(&s, NULL);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
}

static void test_a_controller_without_room_for_its_memory_at_a_reload_is_lost(void)
{
	controller_set_all(true);
	s.dropped = true;
	scene_reload(&s, NULL);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
}

/* --- A reboot --------------------------------------------------------------------------------- */

static void test_after_a_reboot_outputs_have_initvalue_or_what_was_stored_last(void)
{
	controller_set_all(true);
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, 10 * SCENE_S);
	expect_outputs(ended);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_LAST, scene_origin(&s, 5).reason);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, scene_origin(&s, 2).reason);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 1).reason);
}

static void test_after_a_reboot_a_controller_brings_nothing_back(void)
{
	controller_set_all(true);
	scene_reboot(&s);
	scene_up(&s);
	come_back();
	beat_on(10 * SCENE_S);
	expect_outputs(ended);
}

static void test_without_anything_stored_start_last_has_initvalue(void)
{
	const struct row at_first = {NOTHING, INIT, NOTHING, INIT, NOTHING, INIT, NOTHING, INIT};

	start_outputs();
	expect_outputs(at_first);
	restart_owsd();
	scene_run(&s, SCENE_S);
	expect_outputs(at_first); /* InitValue itself is not what is last */
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	expect_outputs(at_first);
}

static void test_safevalue_becomes_last(void)
{
	controller_set_all(true);
	scene_run(&s, 5 * SCENE_S);
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	expect_outputs((struct row){NOTHING, INIT, NOTHING, INIT, NEXT, NEXT, SAFE, SAFE});
}

/* --- owsd runs -------------------------------------------------------------------------------- */

static void test_a_controller_that_dies_and_never_beat_leaves_its_outputs_as_they_are(void)
{
	controller_set_all(false);
	scene_leave(&s, 1);
	scene_run(&s, 20 * SCENE_S);
	expect_outputs(nothing);
}

static void test_a_controller_that_says_goodbye_leaves_its_outputs_as_they_are(void)
{
	controller_set_all(true);
	scene_goodbye(&s, 1);
	scene_run(&s, 20 * SCENE_S);
	expect_outputs(nothing);
}

static void test_a_controller_that_hangs_leaves_safevalue_when_its_time_is_over(void)
{
	controller_set_all(true); /* 200 ms ago */
	scene_run(&s, 200 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 500 * SCENE_MS);
	expect_outputs(lost_running);
	TEST_ASSERT_BITS_HIGH(OWS_CONTROLLER_LATE, s.image.controllers[1].flags);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_controllers"));
}

/* Its child holds the socket open, or not: the control room says that it left. */
static void test_a_controller_that_dies_without_goodbye_is_awaited_for_its_promised_time(void)
{
	controller_set_all(true);
	scene_leave(&s, 1);
	scene_run(&s, 200 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 500 * SCENE_MS);
	expect_outputs(lost_running);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_controllers"));
}

static void test_a_controller_that_hung_up_and_is_back_in_time_goes_on(void)
{
	controller_set_all(true);
	scene_leave(&s, 1);
	scene_run(&s, 200 * SCENE_MS);
	come_back();
	beat_on(5 * SCENE_S);
	expect_outputs(nothing);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(lost_running);
}

static void test_a_controller_that_connects_anew_before_its_end_is_seen_goes_on(void)
{
	controller_set_all(true);
	scene_join(&s, 2, 2);
	giving_beat(&s.controllers[2], BEAT_MS);
	scene_leave(&s, 1);
	for (int i = 0; i < 50; i++) {
		giving_beat(&s.controllers[2], BEAT_MS);
		scene_run(&s, 100 * SCENE_MS);
	}
	expect_outputs(nothing);
}

/* --- SafeDelay -------------------------------------------------------------------------------- */

static void delay_all(int64_t ns)
{
	for (unsigned i = 0; i < OUTPUTS; i++) {
		s.items[i].has_safe_delay = true;
		s.items[i].safe_delay_ns = ns;
	}
}

static void test_with_safe_delay_0_a_hang_up_leaves_safevalue_at_once(void)
{
	controller_set_all(true);
	delay_all(0);
	scene_leave(&s, 1);
	scene_run(&s, 20 * SCENE_MS);
	expect_outputs(lost_running);
}

static void test_with_safe_delay_0_a_missed_beat_is_still_waited_for(void)
{
	controller_set_all(true);
	delay_all(0);
	scene_run(&s, 200 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 500 * SCENE_MS);
	expect_outputs(lost_running);
}

static void test_with_safe_delay_0_a_goodbye_changes_nothing(void)
{
	controller_set_all(true);
	delay_all(0);
	scene_goodbye(&s, 1);
	scene_run(&s, 5 * SCENE_S);
	expect_outputs(nothing);
}

static void test_a_longer_safe_delay_keeps_the_outputs_of_a_controller_that_hangs(void)
{
	controller_set_all(true);
	delay_all(3 * SCENE_S);
	scene_run(&s, 2500 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, SCENE_S);
	expect_outputs(lost_running);
}

static void test_a_controller_that_beats_again_within_safe_delay_keeps_its_outputs(void)
{
	controller_set_all(true);
	delay_all(3 * SCENE_S);
	scene_run(&s, 2 * SCENE_S);
	beat_on(5 * SCENE_S);
	expect_outputs(nothing);
	scene_leave(&s, 1);
	scene_run(&s, 2900 * SCENE_MS);
	expect_outputs(nothing);
	scene_run(&s, 500 * SCENE_MS);
	expect_outputs(lost_running);
}

/* --- The device lost its power ---------------------------------------------------------------- */

static void test_a_device_that_lost_its_power_gets_the_command_again(void)
{
	controller_set_all(false);
	scene_tell(&s, 0, BUS_POR, "/29.000000000001");
	scene_run(&s, SCENE_S);
	expect_outputs(command);
}

static void test_a_device_that_lost_its_power_gets_safevalue_if_that_is_in_force(void)
{
	controller_set_all(true);
	scene_run(&s, 5 * SCENE_S);
	scene_clear_trace(&s);
	scene_tell(&s, 0, BUS_POR, "/29.000000000001");
	scene_run(&s, SCENE_S);
	expect_outputs((struct row){NEXT, NEXT, SAFE, SAFE, NEXT, NEXT, SAFE, SAFE});
}

static void test_a_device_that_lost_its_power_gets_nothing_while_its_controller_is_awaited(void)
{
	controller_set_all(true);
	restart_owsd();
	scene_tell(&s, 0, BUS_POR, "/29.000000000001");
	scene_run(&s, SCENE_S);
	expect_outputs(nothing);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_over_a_reload_the_command_stays_in_force);
	RUN_TEST(test_over_a_reload_a_controller_that_beats_goes_on_answering_for_its_outputs);
	RUN_TEST(test_over_a_reload_a_controller_that_hung_up_goes_on_being_awaited);
	RUN_TEST(test_a_controller_without_room_for_its_memory_at_a_reload_is_lost);
	RUN_TEST(test_after_a_reboot_outputs_have_initvalue_or_what_was_stored_last);
	RUN_TEST(test_after_a_reboot_a_controller_brings_nothing_back);
	RUN_TEST(test_without_anything_stored_start_last_has_initvalue);
	RUN_TEST(test_safevalue_becomes_last);
	RUN_TEST(test_a_controller_that_dies_and_never_beat_leaves_its_outputs_as_they_are);
	RUN_TEST(test_a_controller_that_says_goodbye_leaves_its_outputs_as_they_are);
	RUN_TEST(test_a_controller_that_hangs_leaves_safevalue_when_its_time_is_over);
	RUN_TEST(test_a_controller_that_dies_without_goodbye_is_awaited_for_its_promised_time);
	RUN_TEST(test_a_controller_that_hung_up_and_is_back_in_time_goes_on);
	RUN_TEST(test_a_controller_that_connects_anew_before_its_end_is_seen_goes_on);
	RUN_TEST(test_with_safe_delay_0_a_hang_up_leaves_safevalue_at_once);
	RUN_TEST(test_with_safe_delay_0_a_missed_beat_is_still_waited_for);
	RUN_TEST(test_with_safe_delay_0_a_goodbye_changes_nothing);
	RUN_TEST(test_a_longer_safe_delay_keeps_the_outputs_of_a_controller_that_hangs);
	RUN_TEST(test_a_controller_that_beats_again_within_safe_delay_keeps_its_outputs);
	RUN_TEST(test_a_device_that_lost_its_power_gets_the_command_again);
	RUN_TEST(test_a_device_that_lost_its_power_gets_safevalue_if_that_is_in_force);
	RUN_TEST(test_a_device_that_lost_its_power_gets_nothing_while_its_controller_is_awaited);
	return UNITY_END();
}
