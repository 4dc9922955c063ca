/* SPDX-License-Identifier: MIT */
/* A comma: one table over several wires, each device served by the first that has it. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/two_wires.h"

static struct scene s;

void setUp(void)
{
	two_wires_begin(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

/* No sample is good but from the target that has the device. */
static void run_watching(unsigned record, int64_t ns, unsigned bad_source)
{
	for (int64_t t = 0; t < ns; t += SCENE_MS) {
		struct ows_sample sample;

		scene_run(&s, SCENE_MS);
		sample = scene_sample(&s, record);
		TEST_ASSERT_FALSE(ows_good(sample.quality) && sample.target == bad_source);
	}
}

static void test_each_device_is_served_by_the_target_that_has_it(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T2, "22.5", 0);
	two_wires_up(&s);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 2));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "moves_out"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_in"));
	/* and nothing is asked of the other any more */
	scene_clear_trace(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "1: R " T1));
	TEST_ASSERT_NULL(strstr(s.trace, "\nR " T2));
	TEST_ASSERT_EQUAL_UINT(0, s.bus[0].probes + s.bus[1].probes);
}

static void test_the_first_of_two_that_have_a_device_serves_it(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "1", 0);
	scene_put_on(&s, 1, T1, "2", 0);
	scene_start(&s);
	scene_up_on(&s, 1);
	scene_up_on(&s, 0);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_DOUBLE(1, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].reads);
}

static void test_a_device_is_not_given_up_before_its_retries_are_over(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T1, "2", 0);
	two_wires_up(&s);
	scene_run(&s, 350 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(4, s.bus[0].reads); /* 1 + MaxRetries */
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_device_that_is_plugged_to_another_wire_is_found_there(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_plug(&s, D1, 1);
	scene_run(&s, 120 * SCENE_MS); /* in its retries: the value is as it was, and old */
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_plug(&s, D1, 0);
	run_watching(1, 5 * SCENE_S, 9);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

/* Begun with the target that had the device, given up, and answered after another one serves it. */
static void test_a_late_value_does_not_fetch_a_device_back(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 0, T2, "1", 0);
	scene_put_on(&s, 1, T1, "23", 0);
	s.bus[0].depth = 4;
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	s.bus[0].slow = T1;
	s.bus[0].slow_ns = 25 * SCENE_S;
	scene_run(&s, 22 * SCENE_S); /* Timeout is 20 s */
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_tell(&s, 0, BUS_LOST, D1);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	run_watching(1, 5 * SCENE_S, 0);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "late_answers"));
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(23, scene_number(&s, 1));
}

static void test_between_two_wires_the_last_value_is_usable_and_not_good(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	/* known to be on the other: its search says so */
	scene_plug(&s, D1, 1);
	s.bus[1].latency_ns = 500 * SCENE_MS;
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_tell(&s, 0, BUS_LOST, D1);
	scene_run(&s, 100 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_put_on(&s, 1, T1, "23", 0);
	scene_run(&s, 500 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(23, scene_number(&s, 1));
}

/*
 * A step looks at the lanes in their order. The silence of a later one ends behind the turn of the
 * earlier one, and nobody rings for what that leads to: the engine has to ask for the next period.
 * The silent request is of a signal that has moved before, which nothing else shows.
 */
static void test_what_a_later_target_loses_is_asked_of_an_earlier_one_in_the_next_period(void)
{
	int64_t moved_ns = 0;
	unsigned reads;

	scene_input(&s, "t1", T1, OWS_DOUBLE)->per_factor = 1000;
	scene_input(&s, "t2", T2, OWS_DOUBLE)->per_factor = 1000;
	s.config.timeout_ns = 2 * SCENE_S;
	scene_put_on(&s, SCENE_NOWHERE, T1, "21.5", 0);
	scene_put_on(&s, SCENE_NOWHERE, T2, "22.5", 0);
	two_wires_up(&s);
	s.bus[1].mute = true;
	for (unsigned i = 0; i < 2000 && scene_sample(&s, 2).target != 1; i++)
		scene_run(&s, SCENE_MS);
	scene_run(&s, s.config.period_ns);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: R " T1));
	TEST_ASSERT_NULL(strstr(s.trace, "1: R " T2));
	/* both are on the first wire meanwhile; the one that was not asked would wait for a hold */
	scene_plug(&s, D1, 0);
	scene_plug(&s, D2, 0);
	scene_tell(&s, 0, BUS_FOUND, D1);
	scene_tell(&s, 1, BUS_LOST, D1);
	scene_tell(&s, 0, BUS_FOUND, D2);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	for (unsigned i = 0; i < 100 && scene_sample(&s, 2).target == 1; i++) {
		moved_ns = s.now_ns;
		s.now_ns = engine_step(s.engine, s.now_ns);
	}
	TEST_ASSERT_EQUAL_UINT8(0, scene_sample(&s, 2).target);
	reads = s.bus[0].reads;
	TEST_ASSERT_LESS_OR_EQUAL_INT64(moved_ns + s.config.period_ns, s.now_ns);
	scene_run(&s, 5 * SCENE_MS); /* a look for a device may come first */
	TEST_ASSERT_EQUAL_UINT(reads + 1, s.bus[0].reads);
}

static void test_an_answer_that_comes_after_the_move_is_not_believed(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "85.5", 0);
	scene_put_on(&s, 1, T1, "23", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].latency_ns = 400 * SCENE_MS;
	s.bus[1].latency_ns = 800 * SCENE_MS;
	scene_run(&s, 200 * SCENE_MS); /* a read is on its way */
	scene_tell(&s, 0, BUS_LOST, D1);
	run_watching(1, 700 * SCENE_MS, 0);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	scene_run(&s, 300 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(23, scene_number(&s, 1));
}

static void test_an_absent_device_stays_with_the_first_and_is_found_wherever_it_turns_up(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T2, "1", 0);
	scene_put_on(&s, SCENE_NOWHERE, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, 300 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_in"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_out"));
	/* with back-off: 1 2 4 ... 60 s */
	TEST_ASSERT_GREATER_THAN_UINT64(5, scene_counter_of(&s, 1, "probes"));
	TEST_ASSERT_LESS_THAN_UINT64(15, scene_counter_of(&s, 1, "probes"));
	TEST_ASSERT_LESS_THAN_UINT(40, s.bus[1].reads);
	scene_plug(&s, D1, 1);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_plug(&s, D1, SCENE_NOWHERE);
	scene_run(&s, 10 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, D1, 0);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_bus_that_searches_brings_an_absent_device_back_at_once(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, SCENE_NOWHERE, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, 100 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, D1, 1);
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_run(&s, 10 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_target_that_is_down_keeps_the_devices_it_had(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T1, "22.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_run(&s, 100 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_TARGET, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].reads + s.bus[1].probes);
	scene_up_on(&s, 0);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_device_found_elsewhere_leaves_a_target_that_is_down(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_plug(&s, D1, 1);
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_devices_of_a_target_that_never_came_up_are_looked_for_on_the_next(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T1, "22.5", 0);
	scene_start(&s);
	scene_up_on(&s, 1);
	scene_run(&s, SCENE_S);
	/* not a word of the first yet: it is waited for */
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].reads);
	scene_down_on(&s, 0, -ECONNREFUSED);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	/* when it comes, it is asked once whether it has the device */
	scene_up_on(&s, 0);
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].probes);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_device_returns_to_an_earlier_target_after_evidence_and_a_hold(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T1, "22.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_run(&s, 100 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1); /* nobody said so */
	scene_tell(&s, 0, BUS_FOUND, D1);
	scene_run(&s, 9 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_path_without_a_device_goes_to_the_first_target_that_is_up(void)
{
	scene_input(&s, "count", "/statistics/reads", OWS_DWORD);
	scene_put_on(&s, 0, "/statistics/reads", "1", 0);
	scene_put_on(&s, 1, "/statistics/reads", "2", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_up_on(&s, 0);
	scene_run(&s, 9 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_device_known_by_its_alias_is_found_by_answers_alone(void)
{
	scene_input(&s, "t1", "/boiler/temperature", OWS_DOUBLE);
	scene_put_on(&s, 1, "/boiler/temperature", "60.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_plug(&s, "/boiler", SCENE_NOWHERE);
	scene_run(&s, 30 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, "/boiler", 1);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_stuck_target_delays_no_other(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T2, "22.5", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	s.bus[1].reads = 0;
	scene_run(&s, 30 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_TARGET, 0);
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
	TEST_ASSERT_UINT_WITHIN(3, 300, s.bus[1].reads);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_device_is_served_by_the_target_that_has_it);
	RUN_TEST(test_the_first_of_two_that_have_a_device_serves_it);
	RUN_TEST(test_a_device_is_not_given_up_before_its_retries_are_over);
	RUN_TEST(test_a_device_that_is_plugged_to_another_wire_is_found_there);
	RUN_TEST(test_a_late_value_does_not_fetch_a_device_back);
	RUN_TEST(test_between_two_wires_the_last_value_is_usable_and_not_good);
	RUN_TEST(test_an_answer_that_comes_after_the_move_is_not_believed);
	RUN_TEST(test_what_a_later_target_loses_is_asked_of_an_earlier_one_in_the_next_period);
	RUN_TEST(test_an_absent_device_stays_with_the_first_and_is_found_wherever_it_turns_up);
	RUN_TEST(test_a_bus_that_searches_brings_an_absent_device_back_at_once);
	RUN_TEST(test_a_target_that_is_down_keeps_the_devices_it_had);
	RUN_TEST(test_a_device_found_elsewhere_leaves_a_target_that_is_down);
	RUN_TEST(test_devices_of_a_target_that_never_came_up_are_looked_for_on_the_next);
	RUN_TEST(test_a_device_returns_to_an_earlier_target_after_evidence_and_a_hold);
	RUN_TEST(test_a_path_without_a_device_goes_to_the_first_target_that_is_up);
	RUN_TEST(test_a_device_known_by_its_alias_is_found_by_answers_alone);
	RUN_TEST(test_a_stuck_target_delays_no_other);
	return UNITY_END();
}
