/* SPDX-License-Identifier: MIT */
/* Tests of what the engine does with the commands of programs. */
#include <errno.h>
#include <math.h>
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

#define T1 "/28.551DDF030000/temperature12"
#define PIO "/29.B89115000000/PIO.BYTE"
#define PIO2 "/3A.B89115000000/PIO.BYTE"

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

static void test_a_value_that_the_type_cannot_hold_is_refused_and_its_controller_gets_to_know(void)
{
	one_of_each();
	scene_set(&s, 2, 256);
	scene_run(&s, SCENE_S);
	scene_set(&s, 2, -1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_INT32(-ERANGE, scene_slot(&s, 2)->err);
	TEST_ASSERT_EQUAL_UINT32(scene_slot(&s, 2)->stamp, scene_slot(&s, 2)->taken);
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 2));
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 2).err); /* no harm to others */
	TEST_ASSERT_EQUAL_UINT64(2, scene_counter(&s, "refused_commands"));
}

static void test_not_a_number_is_refused(void)
{
	double nan_value = NAN;
	int64_t bits;

	scene_output(&s, "out", "/28.551DDF030000/temphigh", OWS_DOUBLE);
	scene_put(&s, "/28.551DDF030000/temphigh", "0", 0);
	scene_start(&s);
	scene_up(&s);
	memcpy(&bits, &nan_value, sizeof(bits));
	scene_set(&s, 1, bits);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "refused_commands"));
}

static void a_text(void)
{
	scene_output(&s, "alias", "/28.551DDF030000/alias", OWS_STRING);
	scene_put(&s, "/28.551DDF030000/alias", "", 0);
	scene_start(&s);
	scene_up(&s);
}

static void test_a_text_that_is_being_written_is_taken_when_it_is_whole(void)
{
	struct ows_command_text *text;

	a_text();
	scene_set_text(&s, 1, "boiler");
	text = giving_text(&s.controllers[0], 1);
	text->check++;
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "refused_commands"));
	text->check--;
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W /28.551DDF030000/alias=boiler\n", s.trace);
}

static void test_a_text_that_is_not_whole_after_a_second_is_refused(void)
{
	a_text();
	scene_set_text(&s, 1, "boiler");
	giving_text(&s.controllers[0], 1)->check++;
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_INT32(-EBADMSG, scene_slot(&s, 1)->err);
	TEST_ASSERT_EQUAL_UINT32(1, scene_slot(&s, 1)->taken);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_set_text(&s, 1, "boiler");
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_INT32(0, scene_slot(&s, 1)->err);
}

static void test_a_text_that_is_longer_than_its_room_is_refused(void)
{
	a_text();
	scene_set_text(&s, 1, "boiler");
	giving_text(&s.controllers[0], 1)->len = 0xfffffff0u;
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_INT32(-EBADMSG, scene_slot(&s, 1)->err);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void test_reading_disabled_keeps_the_value_and_says_so(void)
{
	one_of_each();
	scene_enable_reads(&s, 1, false);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.reads);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_enable_reads(&s, 1, true);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(1, s.reads);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_writing_disabled_keeps_what_was_set_until_it_is_enabled(void)
{
	one_of_each();
	scene_enable_writes(&s, 2, false);
	scene_set(&s, 2, 9);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_enable_writes(&s, 2, true);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_STRING("9", scene_at(&s, PIO));
}

static void test_a_command_is_not_confirmed_while_writing_is_disabled(void)
{
	one_of_each();
	scene_enable_writes(&s, 2, false);
	scene_set(&s, 2, 9);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 2));
	scene_enable_writes(&s, 2, true);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 2));
	/* back to what the bus has, while disabled: enabling leaves nothing to write */
	scene_enable_writes(&s, 2, false);
	scene_set(&s, 2, 9);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 2));
	scene_enable_writes(&s, 2, true);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(2, scene_applied(&s, 2));
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_the_same_value_set_again_during_its_write_is_confirmed_with_it(void)
{
	one_of_each();
	s.bus[0].latency_ns = 50 * SCENE_MS;
	scene_set(&s, 2, 9);
	scene_run(&s, 10 * SCENE_MS);
	scene_set(&s, 2, 9);
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 2));
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(2, scene_applied(&s, 2));
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_one_shot_writes_once_changed_or_not_enabled_or_not(void)
{
	one_of_each();
	scene_set(&s, 2, 9);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
	scene_slot(&s, 2)->one_shot++;
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_enable_writes(&s, 2, false);
	scene_slot(&s, 2)->one_shot++;
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
}

static void test_diagnostics_are_reset_and_the_value_stays(void)
{
	struct ows_attrs before, after;

	one_of_each();
	scene_run(&s, SCENE_S);
	before = scene_attrs(&s, 1);
	TEST_ASSERT_GREATER_THAN(5, before.transactions);
	scene_slot(&s, 1)->dgn_reset++;
	scene_ring(&s, 1);
	engine_step(s.engine, s.now_ns);
	after = scene_attrs(&s, 1);
	TEST_ASSERT_EQUAL_UINT64(0, after.transactions);
	TEST_ASSERT_LESS_OR_EQUAL_UINT32(1, after.per_max);
	TEST_ASSERT_EQUAL_UINT32(before.per_base, after.per_base);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_the_driver_reset_clears_its_counters_and_every_signal(void)
{
	one_of_each();
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	scene_up(&s);
	scene_slot(&s, 0)->dgn_reset++;
	scene_ring(&s, 0);
	engine_step(s.engine, s.now_ns);
	TEST_ASSERT_EQUAL_UINT64(0, scene_attrs(&s, 1).transactions);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 0).value);
	TEST_ASSERT_LESS_THAN(5, scene_attrs(&s, 0).transactions);
}

static void test_a_controller_that_stops_beating_leaves_its_outputs_safe(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->has_safe = true;
	item->safe_value = 128;
	scene_output(&s, "other", PIO2, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO2, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_join(&s, 3, 7);
	for (int i = 0; i < 20; i++) {
		giving_beat(&s.controllers[3], 500);
		scene_set_by(&s, 3, 1, i);
		scene_set_by(&s, 3, 2, i);
		scene_run(&s, 200 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_STRING("19", scene_at(&s, PIO));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("128", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_STRING("19", scene_at(&s, PIO2));
	TEST_ASSERT_BITS_HIGH(OWS_SAMPLE_SAFE, scene_sample(&s, 1).flags);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_controllers"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "safe_outputs"));
	/* the next command counts again */
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
	TEST_ASSERT_BITS_LOW(OWS_SAMPLE_SAFE, scene_sample(&s, 1).flags);
}

static void test_a_controller_that_says_goodbye_leaves_its_outputs_as_they_are(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->has_safe = true;
	item->safe_value = 128;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	giving_beat(&s.controllers[0], 500);
	scene_set(&s, 1, 3);
	scene_run(&s, 200 * SCENE_MS);
	scene_goodbye(&s, 0);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
}

static void test_what_is_set_just_before_the_end_is_taken(void)
{
	one_of_each();
	scene_set(&s, 2, 77);
	scene_leave(&s, 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("77", scene_at(&s, PIO));
}

/* As a hole punched into the file leaves it. */
static void test_a_memory_of_zeros_commands_nothing(void)
{
	one_of_each();
	scene_slot(&s, 2)->one_shot = 7;
	scene_slot(&s, 2)->dgn_reset = 7;
	scene_set(&s, 2, 3);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	scene_clear_trace(&s);
	memset(s.controllers[0].memory.base, 0, s.layout->header.size);
	scene_ring(&s, 0);
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_INT64(3, scene_attrs(&s, 2).commanded);
	TEST_ASSERT_GREATER_THAN_UINT64(0, scene_attrs(&s, 2).transactions);
}

static void test_between_controllers_the_last_command_taken_is_in_force(void)
{
	one_of_each();
	scene_join(&s, 1, 2);
	scene_set(&s, 2, 3);
	scene_run(&s, 100 * SCENE_MS);
	scene_set_by(&s, 1, 2, 4);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("4", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 2));
	TEST_ASSERT_EQUAL_UINT32(1, giving_slot(&s.controllers[1], 2)->applied);
	/* the first one's look at other things does not bring its command back */
	scene_slot(&s, 2)->dgn_reset++;
	scene_ring(&s, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("4", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_STRING("controller1", scene_origin(&s, 2).who.name);
}

static void test_a_signal_that_the_controller_may_not_command_is_refused(void)
{
	one_of_each();
	scene_allow(&s, 1, 1);
	scene_join(&s, 1, 2);
	giving_enable(&giving_slot(&s.controllers[1], 2)->write_enable, false);
	giving_slot(&s.controllers[1], 2)->one_shot++;
	scene_set_by(&s, 1, 2, 4);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_INT32(-EACCES, giving_slot(&s.controllers[1], 2)->err);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_WRITE_ENABLE, scene_attrs(&s, 2).flags);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "refused_commands"));
	giving_slot(&s.controllers[1], 0)->dgn_reset++;
	giving_mark(&s.controllers[1], 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT64(15, scene_attrs(&s, 1).transactions);
}

static void test_per_count_and_pend_count_are_counted_in_periods(void)
{
	int64_t beat;

	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "1", 0);
	s.bus[0].latency_ns = 350 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 320 * SCENE_MS);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_IN_WORK, scene_attrs(&s, 1).flags);
	/* as a reader computes it: owsd need not beat meanwhile */
	beat = scene_sample(&s, 0).measured_ns;
	TEST_ASSERT_EQUAL_UINT32(3, scene_attrs(&s, 0).per_base +
	                                    (s.now_ns - beat) / (100 * SCENE_MS) -
	                                    scene_attrs(&s, 1).pend_base);
	scene_run(&s, 40 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(3, scene_attrs(&s, 1).pend_last);
	TEST_ASSERT_EQUAL_UINT32(3, scene_attrs(&s, 1).pend_max);
	TEST_ASSERT_EQUAL_UINT32(3, scene_attrs(&s, 1).per_base);
	s.bus[0].latency_ns = 10 * SCENE_MS;
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(0, scene_attrs(&s, 1).pend_last);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT32(3, scene_attrs(&s, 1).pend_max);
	TEST_ASSERT_EQUAL_INT64(100 * SCENE_MS, scene_attrs(&s, 1).update_ns);
}

/* A bus with a cache gives the same measurement twice. */
static void test_age_and_period_are_of_the_updates_though_the_measurement_is_old(void)
{
	int64_t measured;

	scene_input(&s, "t1", T1, OWS_DOUBLE);
	s.bus[0].mute = true;
	scene_start(&s);
	scene_up(&s);
	measured = s.now_ns;
	for (int i = 0; i < 3; i++) {
		struct bus_answer answer = {.measured_ns = measured, .kind = BUS_NUMBER};

		scene_run(&s, 400 * SCENE_MS);
		TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
		answer.id = s.bus[0].swallowed[0]->id;
		s.bus[0].swallowed_count = 0;
		engine_answer(s.engine, 0, &answer, s.now_ns);
	}
	TEST_ASSERT_EQUAL_INT64(400 * SCENE_MS, scene_attrs(&s, 1).update_ns);
	TEST_ASSERT_EQUAL_INT64(1200 * SCENE_MS, scene_attrs(&s, 1).age_max_ns);
}

static void test_transactions_count_requests_that_ended(void)
{
	one_of_each();
	scene_run(&s, 2 * SCENE_S);
	scene_put(&s, T1, NULL, -EIO);
	scene_run(&s, 300 * SCENE_MS);
	scene_enable_reads(&s, 1, false);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT64(scene_counter(&s, "requests"), scene_attrs(&s, 0).transactions);
	TEST_ASSERT_EQUAL_UINT64(s.reads + 2, scene_attrs(&s, 1).transactions);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_that_the_type_cannot_hold_is_refused_and_its_controller_gets_to_know);
	RUN_TEST(test_not_a_number_is_refused);
	RUN_TEST(test_a_text_that_is_being_written_is_taken_when_it_is_whole);
	RUN_TEST(test_a_text_that_is_not_whole_after_a_second_is_refused);
	RUN_TEST(test_a_text_that_is_longer_than_its_room_is_refused);
	RUN_TEST(test_reading_disabled_keeps_the_value_and_says_so);
	RUN_TEST(test_writing_disabled_keeps_what_was_set_until_it_is_enabled);
	RUN_TEST(test_a_command_is_not_confirmed_while_writing_is_disabled);
	RUN_TEST(test_the_same_value_set_again_during_its_write_is_confirmed_with_it);
	RUN_TEST(test_one_shot_writes_once_changed_or_not_enabled_or_not);
	RUN_TEST(test_diagnostics_are_reset_and_the_value_stays);
	RUN_TEST(test_the_driver_reset_clears_its_counters_and_every_signal);
	RUN_TEST(test_a_controller_that_stops_beating_leaves_its_outputs_safe);
	RUN_TEST(test_a_controller_that_says_goodbye_leaves_its_outputs_as_they_are);
	RUN_TEST(test_what_is_set_just_before_the_end_is_taken);
	RUN_TEST(test_a_memory_of_zeros_commands_nothing);
	RUN_TEST(test_between_controllers_the_last_command_taken_is_in_force);
	RUN_TEST(test_a_signal_that_the_controller_may_not_command_is_refused);
	RUN_TEST(test_per_count_and_pend_count_are_counted_in_periods);
	RUN_TEST(test_age_and_period_are_of_the_updates_though_the_measurement_is_old);
	RUN_TEST(test_transactions_count_requests_that_ended);
	return UNITY_END();
}
