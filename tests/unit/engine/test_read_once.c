/* SPDX-License-Identifier: MIT */
/* A reading that somebody asks for: at once, past the caches, and not twice in a period. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

#define T1 "/28.551DDF030000/temperature12"
#define PIO "/29.B89115000000/PIO.BYTE"
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

/* One that is read once in 100 s, and was read 10 s ago. */
static struct config_item *slow_input(void)
{
	struct config_item *item = scene_input(&s, "t1", T1, OWS_DOUBLE);

	item->per_factor = 1000;
	scene_put(&s, T1, "21.5", 0);
	return item;
}

static void start(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 10 * SCENE_S);
	scene_clear_trace(&s);
	s.reads = 0;
}

static void ask(unsigned record)
{
	scene_slot(&s, record)->dgn_reset += OWS_STEP_READ;
	scene_ring(&s, record);
}

static void test_it_is_read_at_once_past_the_caches(void)
{
	slow_input();
	start();
	scene_put(&s, T1, "22.5", 0);
	ask(1);
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\n", s.trace);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
	/* its diagnostics were not reset */
	TEST_ASSERT_EQUAL_UINT64(2, scene_attrs(&s, 1).transactions);
	scene_run(&s, 99 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.reads);
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\nR " T1 "\n", s.trace);
}

static void test_a_flood_costs_one_reading_in_a_period(void)
{
	slow_input();
	start();
	for (int i = 0; i < 1000; i++) {
		ask(1);
		scene_run(&s, SCENE_MS);
	}
	TEST_ASSERT_UINT_WITHIN(1, 10, s.reads);
}

static void test_one_asked_for_while_a_reading_is_under_way_follows_it(void)
{
	slow_input();
	start();
	s.bus[0].latency_ns = 30 * SCENE_MS;
	ask(1);
	scene_run(&s, 10 * SCENE_MS);
	scene_put(&s, T1, "22.5", 0);
	ask(1);
	scene_run(&s, 2 * PERIOD_NS);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\nr " T1 "\n", s.trace);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
}

static void test_what_is_not_read_else_is_read_once(void)
{
	slow_input()->readable = false;
	scene_output(&s, "out", PIO, OWS_BYTE)->read_back_ns = 0;
	scene_put(&s, PIO, "7", 0);
	start();
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	ask(1);
	ask(2);
	scene_run(&s, 9 * SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT64(7, scene_sample(&s, 2).value);
	/* nobody looks whether it is so still */
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	ask(1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_run(&s, 200 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\nr " PIO "\nr " T1 "\n", s.trace);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
}

static void test_a_reload_ends_what_was_good_for_a_moment(void)
{
	slow_input()->readable = false;
	start();
	ask(1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
}

static void test_one_that_fails_is_tried_again_by_nobody_but_the_cycle(void)
{
	slow_input()->readable = false;
	start();
	scene_put(&s, T1, NULL, -EBADMSG);
	ask(1);
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.reads);
	TEST_ASSERT_EQUAL_INT32(-EBADMSG, scene_sample(&s, 1).err);
}

static void test_a_request_that_did_not_begin_is_no_reading(void)
{
	slow_input()->readable = false;
	start();
	scene_put(&s, T1, NULL, -ETIME);
	ask(1);
	scene_run(&s, 10 * SCENE_MS);
	scene_put(&s, T1, "22.5", 0);
	scene_run(&s, 2 * PERIOD_NS);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
}

static void test_a_target_that_is_down_is_asked_when_it_is_back(void)
{
	slow_input()->readable = false;
	start();
	scene_down(&s, -ECONNREFUSED);
	ask(1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\n", s.trace);
}

static void test_who_may_not_command_the_signal_has_nothing_read(void)
{
	slow_input();
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "7", 0);
	start();
	scene_allow(&s, 1, 2);
	scene_join(&s, 1, 0);
	giving_slot(&s.controllers[1], 1)->dgn_reset += OWS_STEP_READ;
	giving_mark(&s.controllers[1], 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.reads);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_is_read_at_once_past_the_caches);
	RUN_TEST(test_a_flood_costs_one_reading_in_a_period);
	RUN_TEST(test_one_asked_for_while_a_reading_is_under_way_follows_it);
	RUN_TEST(test_what_is_not_read_else_is_read_once);
	RUN_TEST(test_a_reload_ends_what_was_good_for_a_moment);
	RUN_TEST(test_one_that_fails_is_tried_again_by_nobody_but_the_cycle);
	RUN_TEST(test_a_request_that_did_not_begin_is_no_reading);
	RUN_TEST(test_a_target_that_is_down_is_asked_when_it_is_back);
	RUN_TEST(test_who_may_not_command_the_signal_has_nothing_read);
	return UNITY_END();
}
