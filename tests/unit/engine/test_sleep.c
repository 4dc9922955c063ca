/* SPDX-License-Identifier: MIT */
/*
 * The engine asks to be called when something is due, and not in each period; and what was due in
 * each period still is.
 */
#include <stdlib.h>

#include "unity.h"

#include "src/daemon/engine/engine.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define PIO "/05.000000000001/PIO"
#define PERIOD_NS (100 * SCENE_MS)

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

static void start(void)
{
	scene_put(&s, T1, "20", 0);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
}

/* The steps of so long a time; the heart is never older than it may be. */
static uint64_t steps_of(int64_t ns)
{
	int64_t end = s.now_ns + ns;
	uint64_t steps = 0;

	while (s.now_ns < end) {
		int64_t next = engine_step(s.engine, s.now_ns);

		steps++;
		TEST_ASSERT_GREATER_THAN_INT64(s.now_ns, next);
		TEST_ASSERT_LESS_OR_EQUAL_INT64(ENGINE_BEAT_NS,
		                                next - scene_sample(&s, 0).measured_ns);
		s.now_ns = next;
	}
	return steps;
}

static void test_without_signals_it_only_beats(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(21, steps_of(10 * SCENE_S));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "late_periods"));
	TEST_ASSERT_UINT64_WITHIN(6, 110, scene_counter(&s, "periods"));
}

static void test_a_long_period_has_a_beat_each(void)
{
	s.config.period_ns = 2 * SCENE_S;
	scene_start(&s);
	scene_up(&s);
	for (unsigned i = 0; i < 10; i++) {
		int64_t next = engine_step(s.engine, s.now_ns);

		TEST_ASSERT_LESS_OR_EQUAL_INT64(2 * SCENE_S, next - s.now_ns);
		s.now_ns = next;
		engine_step(s.engine, s.now_ns);
		TEST_ASSERT_EQUAL_INT64(s.now_ns, scene_sample(&s, 0).measured_ns);
	}
}

static void test_an_input_is_read_in_its_period(void)
{
	struct config_item *item = scene_input(&s, "t1", T1, OWS_DOUBLE);
	int64_t began;
	uint64_t steps;

	item->per_factor = 7;
	start();
	began = scene_sample(&s, 1).measured_ns;
	steps = scene_counter(&s, "steps");
	for (unsigned i = 0; i < 10; i++) {
		uint32_t count = scene_sample(&s, 1).count;
		int64_t before = began;

		scene_run(&s, 7 * PERIOD_NS);
		TEST_ASSERT_EQUAL_UINT32(count + 1, scene_sample(&s, 1).count);
		began = scene_sample(&s, 1).measured_ns;
		TEST_ASSERT_EQUAL_INT64(7 * PERIOD_NS, began - before);
	}
	scene_run(&s, ENGINE_BEAT_NS);
	/* of 75 boundaries: a reading, what follows from it, a beat between */
	TEST_ASSERT_LESS_THAN_UINT64(75, scene_counter(&s, "steps") - steps);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "late_periods"));
}

/* The bus answers in the middle of a sleep: the count of periods is that of the answer. */
static void test_an_answer_counts_the_periods_that_were_slept_through(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE)->per_factor = 1000;
	scene_put(&s, T1, "20", 0);
	s.bus[0].latency_ns = 450 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(4, scene_attrs(&s, 1).pend_last);
	TEST_ASSERT_EQUAL_UINT32(4, scene_attrs(&s, 1).per_base);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "late_periods"));
}

static void test_a_command_waits_for_no_period(void)
{
	scene_output(&s, "pump", PIO, OWS_BYTE);
	start();
	scene_run(&s, 10 * SCENE_S + 30 * SCENE_MS);
	scene_set(&s, 1, 7);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(s.now_ns + PERIOD_NS, engine_step(s.engine, s.now_ns));
	scene_run(&s, 20 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
}

static void test_a_value_is_stale_in_its_period(void)
{
	struct config_item *item = scene_input(&s, "t1", T1, OWS_DOUBLE);
	uint32_t head;
	int64_t measured;

	item->per_factor = 1000;
	item->stale_after_ns = 1230 * SCENE_MS;
	start();
	measured = scene_sample(&s, 1).measured_ns;
	head = s.image.header->change_head;
	scene_run(&s, measured + 1220 * SCENE_MS - s.now_ns);
	TEST_ASSERT_EQUAL_UINT32(head, s.image.header->change_head);
	scene_run(&s, 110 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(head + 1, s.image.header->change_head);
}

/* A beat rings nobody: owsd looks for it in each period as long as one is promised. */
static void test_a_controller_that_stops_beating_is_lost_in_its_period(void)
{
	struct config_item *item = scene_output(&s, "pump", PIO, OWS_BYTE);
	int64_t last;

	item->has_safe = true;
	item->safe_value = 20;
	start();
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], 300);
	scene_set_by(&s, 1, 1, 30);
	for (unsigned i = 0; i < 40; i++) {
		scene_run(&s, 250 * SCENE_MS);
		giving_beat(&s.controllers[1], 300);
	}
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, PIO));
	last = s.now_ns;
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("30", scene_at(&s, PIO));
	while (s.now_ns < last + 10 * SCENE_S && scene_counter(&s, "safe_outputs") == 0)
		scene_run(&s, 10 * SCENE_MS);
	/* the beat was heard a period later at most, and its end is seen a period later */
	TEST_ASSERT_LESS_OR_EQUAL_INT64(last + 500 * SCENE_MS + 50 * SCENE_MS, s.now_ns);
}

static void test_periods_that_nobody_ran_are_late(void)
{
	start();
	scene_run(&s, 10 * SCENE_S);
	engine_step(s.engine, s.now_ns);
	s.now_ns += 60 * SCENE_S;
	engine_step(s.engine, s.now_ns);
	engine_step(s.engine, s.now_ns + PERIOD_NS);
	TEST_ASSERT_UINT64_WITHIN(6, 600, scene_counter(&s, "late_periods"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_signals_it_only_beats);
	RUN_TEST(test_a_long_period_has_a_beat_each);
	RUN_TEST(test_an_input_is_read_in_its_period);
	RUN_TEST(test_an_answer_counts_the_periods_that_were_slept_through);
	RUN_TEST(test_a_command_waits_for_no_period);
	RUN_TEST(test_a_value_is_stale_in_its_period);
	RUN_TEST(test_a_controller_that_stops_beating_is_lost_in_its_period);
	RUN_TEST(test_periods_that_nobody_ran_are_late);
	return UNITY_END();
}
