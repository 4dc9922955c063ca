/* SPDX-License-Identifier: MIT */
/* Alarms beside readings and writes: who waits for whom, and that nobody starves. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

static void test_after_max_cons_alarms_one_other_request_goes_through(void)
{
	s.config.max_cons_alarms = 1;
	figure_3_3(&s);
	alarm_item(&s, "second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	alarm_device(&s, "1", "0");
	scene_put(&s, E "/sensed.BYTE", "1", 0);
	scene_put(&s, E "/latch.BYTE", "1", 0);
	scene_put(&s, T_TEMP, "21", 0);
	s.bus[0].latency_ns = 30 * SCENE_MS;
	scene_start(&s);
	s.on_read = alarm_on_read;
	scene_up(&s);
	scene_run(&s, 2 * SCENE_S);
	/* between the last request of one alarm and the first of the next stands a reading */
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "r " D "/sensed.BYTE\nR "));
}

static void test_an_alarm_does_not_wait_for_a_conversion(void)
{
	static const char *const values[] = {"254", "253", "252", "251", "250", "249"};

	s.bus[0].depth = 4;
	s.bus[0].slow = T_TEMP;
	s.bus[0].slow_ns = 750 * SCENE_MS;
	figure_3_3(&s);
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	alarm_device(&s, "0", "0");
	scene_put(&s, T_TEMP, "21", 0);
	alarm_begin(&s);
	for (unsigned i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		scene_put(&s, D "/sensed.BYTE", values[i], 0);
		scene_put(&s, D "/latch.BYTE", "1", 0);
		scene_run(&s, 120 * SCENE_MS);
		TEST_ASSERT_EQUAL_INT64(254 - i, scene_sample(&s, 1).value);
		TEST_ASSERT_EQUAL_UINT32(i + 1, scene_attrs(&s, 1).alarms);
	}
	TEST_ASSERT_GREATER_THAN(0, scene_sample(&s, 2).count);
}

static void test_the_engine_sleeps_while_a_write_holds_the_alarms_up(void)
{
	uint64_t steps;

	s.bus[0].depth = 4;
	s.bus[0].slow = D "/PIO.BYTE";
	s.bus[0].slow_ns = SCENE_S;
	figure_3_3(&s);
	scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	steps = scene_counter(&s, "steps");
	scene_set(&s, 2, 1);
	scene_run(&s, 900 * SCENE_MS);
	/* Nine periods, and a list or two before them. */
	TEST_ASSERT_LESS_THAN_UINT64(steps + 30, scene_counter(&s, "steps"));
}

static void test_a_storm_of_alarms_starves_neither_reads_nor_writes(void)
{
	figure_3_3(&s);
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	scene_output(&s, "out", D "/PIO.BYTE", OWS_BYTE);
	alarm_device(&s, "1", "0");
	scene_put(&s, T_TEMP, "21", 0);
	scene_put(&s, "/alarm", "/alarm" D "\n", 0);
	scene_start(&s);
	scene_up(&s);
	for (int i = 0; i < 200; i++) {
		scene_put(&s, D "/latch.BYTE", "1", 0);
		scene_set(&s, 3, i & 127);
		scene_run(&s, 50 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_INT64(199 & 127, scene_sample(&s, 3).value);
	TEST_ASSERT_GREATER_THAN(50, scene_sample(&s, 2).count);
	TEST_ASSERT_GREATER_THAN(50, scene_sample(&s, 3).count);
	TEST_ASSERT_GREATER_THAN(50, scene_attrs(&s, 1).alarms);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_after_max_cons_alarms_one_other_request_goes_through);
	RUN_TEST(test_an_alarm_does_not_wait_for_a_conversion);
	RUN_TEST(test_the_engine_sleeps_while_a_write_holds_the_alarms_up);
	RUN_TEST(test_a_storm_of_alarms_starves_neither_reads_nor_writes);
	return UNITY_END();
}
