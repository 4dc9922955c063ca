/* SPDX-License-Identifier: MIT */
/* A bar: ways to one wire, of which exactly one is open. The scene fails when two are. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"

static struct scene s;

#define D1 "/28.551DDF030000"
#define T1 D1 "/temperature12"
#define D3 "/29.B89115000000"
#define PIO D3 "/PIO.BYTE"
#define SENSED D3 "/sensed.BYTE"

void setUp(void)
{
	scene_init(&s);
	s.bus[0].holds = true;
	scene_bus(&s, "second", 0)->holds = true;
	scene_bus(&s, "third", 0)->holds = true;
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
}
void tearDown(void)
{
	scene_end(&s);
}

static void reach(bool first, bool second, bool third)
{
	scene_reach(&s, 0, first);
	scene_reach(&s, 1, second);
	scene_reach(&s, 2, third);
}

static void test_the_first_way_is_open_and_the_others_are_not_touched(void)
{
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, 100 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].opened);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].opened + s.bus[2].opened);
	TEST_ASSERT_EQUAL_UINT32(1, scene_target_state(&s, 0));
	TEST_ASSERT_EQUAL_UINT32(2, scene_target_state(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter_of(&s, 0, "moves_out"));
}

static void test_ways_that_are_down_at_the_start_are_passed_over(void)
{
	reach(false, false, true);
	scene_start(&s);
	scene_run(&s, 200 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 2);
	TEST_ASSERT_EQUAL_UINT32(2, scene_target_state(&s, 0));
	TEST_ASSERT_EQUAL_UINT32(1, scene_target_state(&s, 2));
}

static void test_a_missing_device_moves_nothing(void)
{
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	scene_plug(&s, D1, SCENE_NOWHERE);
	scene_run(&s, 100 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].opened + s.bus[2].opened);
}

static void test_the_next_way_takes_over_and_no_old_value_is_good(void)
{
	reach(true, true, false);
	s.bus[0].turn_ns = 700 * SCENE_MS; /* it is slow to let go */
	scene_start(&s);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	s.bus[1].latency_ns = 50 * SCENE_MS;
	scene_reach(&s, 0, false);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_run(&s, 690 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].opened);
	scene_run(&s, 20 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	scene_put(&s, T1, "22", 0);
	scene_run(&s, 50 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(22, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "moves_out"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_in"));
}

static void test_it_returns_when_the_earlier_way_is_back_and_the_hold_is_over(void)
{
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	scene_reach(&s, 0, false);
	scene_run(&s, 20 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_reach(&s, 0, true);
	scene_run(&s, 9900 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].opened);
	scene_run(&s, 200 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT(2, s.bus[0].opened);
	TEST_ASSERT_EQUAL_UINT32(2, scene_target_state(&s, 1));
}

static void test_an_answer_of_the_way_that_lets_go_is_not_believed(void)
{
	reach(false, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	s.bus[1].latency_ns = 270 * SCENE_MS;
	s.bus[1].turn_ns = SCENE_S;
	scene_reach(&s, 0, true);
	scene_run(&s, 9500 * SCENE_MS);
	for (unsigned i = 0; i < 20 && scene_sample(&s, 1).target == 1; i++)
		scene_run(&s, 50 * SCENE_MS);
	/* it returns, and a read is with the other way still */
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].pending_count);
	for (unsigned i = 0; i < 18; i++) {
		scene_expect(&s, 1, OWS_Q_LAST_USABLE, 0);
		scene_run(&s, 50 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].pending_count);
	scene_run(&s, 200 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_return_that_fails_goes_to_the_way_that_worked_and_is_tried_less_often(void)
{
	int64_t before = 0, gap[4];
	unsigned returns = 0;

	reach(false, false, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 2);
	/* it is seen to be there each time, and fails when it is opened */
	for (int64_t t = 0; returns < 4 && t < 400000; t += 100) {
		unsigned opened = s.bus[0].opened;

		if (s.bus[0].released && !s.bus[0].there && !s.bus[0].asked)
			scene_reach(&s, 0, true);
		if (s.bus[0].asked && s.bus[0].released)
			s.bus[0].there = false;
		scene_run(&s, 1 * SCENE_MS);
		if (s.bus[0].asked && s.bus[0].released)
			s.bus[0].there = false;
		scene_run(&s, 99 * SCENE_MS);
		if (s.bus[0].opened != opened) {
			gap[returns++] = s.now_ns - before;
			before = s.now_ns;
			scene_run(&s, SCENE_S);
			scene_expect(&s, 1, OWS_Q_GOOD, 2);
		}
	}
	TEST_ASSERT_EQUAL_UINT(4, returns);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].opened);
	for (unsigned i = 2; i < 4; i++)
		TEST_ASSERT_INT64_WITHIN(3 * SCENE_S, 2 * gap[i - 1], gap[i]);
}

static void test_a_way_that_comes_and_goes_does_not_make_the_table_flap(void)
{
	reach(true, true, true);
	scene_start(&s);
	for (unsigned i = 0; i < 3600; i++) {
		scene_run(&s, SCENE_S);
		scene_reach(&s, 0, i % 8 < 4);
	}
	/* an hour of it, 450 times down: the hold doubles up to 640 s */
	TEST_ASSERT_LESS_THAN_UINT(12, s.bus[0].opened);
	scene_reach(&s, 0, true);
	scene_run(&s, 700 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_when_all_are_down_they_are_tried_in_turn_less_and_less_often(void)
{
	reach(false, false, false);
	scene_start(&s);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2, s.bus[0].opened);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2, s.bus[1].opened);
	TEST_ASSERT_LESS_THAN_UINT(6, s.bus[0].opened);
	scene_run(&s, 3600 * SCENE_S);
	TEST_ASSERT_UINT_WITHIN(8, 42, s.bus[1].opened); /* every 90 s */
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL & 0, scene_sample(&s, 1).quality & 0xc0);
	scene_reach(&s, 2, true);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 2);
}

static void test_ways_that_fail_for_hours_are_told_now_and_then(void)
{
	struct log *log = log_create(LOG_LEVEL_NOTICE);
	FILE *out = tmpfile();
	unsigned lines = 0;

	TEST_ASSERT_NOT_NULL(log);
	TEST_ASSERT_NOT_NULL(out);
	s.log = log;
	reach(false, false, false);
	scene_start(&s);
	for (unsigned minutes = 0; minutes < 600; minutes++) {
		scene_run(&s, 60 * SCENE_S);
		log_drain(log, fileno(out), 0);
	}
	TEST_ASSERT_EQUAL_UINT64(0, log_dropped(log));
	rewind(out);
	for (int c = fgetc(out); c != EOF; c = fgetc(out))
		lines += c == '\n';
	/* the first round with each way, the next ones, and then one line each hour */
	TEST_ASSERT_UINT_WITHIN(8, 22, lines);
	fclose(out);
	scene_end(&s);
	log_destroy(log);
	setUp();
}

static void test_a_way_that_is_stuck_is_left_for_the_next(void)
{
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	scene_run(&s, 20 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0); /* within Timeout */
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].opened);
	/* it cannot let go: after 5 s it is not waited for any more */
	scene_run(&s, 5 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "not_released"));
	/* it comes back to life, lets go, and is there again */
	s.bus[0].mute = false;
	scene_answer_on(&s, 0, s.bus[0].swallowed[0]->id, 0, "85.5", s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, 5 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_run(&s, 7 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_way_that_says_nothing_when_it_is_opened_is_passed_over(void)
{
	s.bus[0].mute = true;
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, 19 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].opened);
	s.bus[0].released = false; /* it hangs with the hardware in its hand */
	scene_run(&s, 7 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_write_in_doubt_on_a_stuck_way_waits_for_its_end(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].slow = PIO; /* the write hangs */
	s.bus[0].slow_ns = 100 * SCENE_S;
	scene_set(&s, 2, 1);
	scene_run(&s, 300 * SCENE_MS);
	s.bus[0].mute = true;
	scene_run(&s, 30 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_set(&s, 2, 2);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].writes);
	TEST_ASSERT_EQUAL_INT32(-EINPROGRESS, scene_sample(&s, 2).err);
	/* it lets go: whatever was to be written is not written any more, or was */
	s.bus[0].mute = false;
	scene_run(&s, 3 * SCENE_S);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(1, s.bus[1].writes);
	TEST_ASSERT_EQUAL_STRING("2", scene_at(&s, PIO));
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
}

static void test_outputs_are_written_again_by_the_way_that_is_open_now(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	reach(true, true, true);
	scene_start(&s);
	scene_set(&s, 2, 7);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].writes);
	scene_put(&s, PIO, "0", 0); /* who knows what it did when it went */
	scene_reach(&s, 0, false);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].writes);
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
}

static void test_an_alarm_item_moves_with_the_way(void)
{
	alarm_item(&s, "door", SENSED, "latch.BYTE", "por", NULL, "latch.BYTE=0")->fresh = true;
	scene_put(&s, SENSED, "0", 0);
	scene_put(&s, D3 "/latch.BYTE", "0", 0);
	scene_put(&s, D3 "/por", "0", 0);
	scene_put(&s, "/alarm", "", 0);
	reach(true, true, true);
	scene_start(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[0].lists);
	/* the list is on its way when the way goes */
	s.bus[0].latency_ns = SCENE_S;
	scene_run(&s, 200 * SCENE_MS);
	scene_reach(&s, 0, false);
	scene_put(&s, D3 "/latch.BYTE", "4", 0);
	scene_put(&s, "/alarm", D3 "\n", 0);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 2).alarms);
	TEST_ASSERT_GREATER_THAN_UINT(1, s.bus[1].lists);
}

static void test_a_bar_and_another_wire_make_one_table(void)
{
	struct scene_bus *other = scene_bus(&s, "other", 1);

	other->holds = true;
	scene_input(&s, "t2", "/28.063BC8040000/temperature12", OWS_DOUBLE);
	scene_put_on(&s, 1, "/28.063BC8040000/temperature12", "23", 0);
	reach(true, true, true);
	scene_reach(&s, 3, true);
	scene_start(&s);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_expect(&s, 2, OWS_Q_GOOD, 3);
	other->reads = 0;
	/* while the bar changes, its devices are not looked for elsewhere */
	s.bus[0].turn_ns = 3 * SCENE_S;
	scene_reach(&s, 0, false);
	scene_run(&s, 4 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_expect(&s, 2, OWS_Q_GOOD, 3);
	TEST_ASSERT_EQUAL_UINT(0, other->probes);
	TEST_ASSERT_UINT_WITHIN(2, 40, other->reads);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 3, "moves_in"));
}

static void test_a_bus_with_nothing_to_let_go_of_is_a_way_too(void)
{
	s.bus[0].holds = s.bus[1].holds = false;
	reach(false, false, true);
	scene_start(&s);
	scene_up_on(&s, 1); /* it does not know that it is not wanted */
	scene_up_on(&s, 0);
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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_way_is_open_and_the_others_are_not_touched);
	RUN_TEST(test_ways_that_are_down_at_the_start_are_passed_over);
	RUN_TEST(test_a_missing_device_moves_nothing);
	RUN_TEST(test_the_next_way_takes_over_and_no_old_value_is_good);
	RUN_TEST(test_it_returns_when_the_earlier_way_is_back_and_the_hold_is_over);
	RUN_TEST(test_an_answer_of_the_way_that_lets_go_is_not_believed);
	RUN_TEST(test_a_return_that_fails_goes_to_the_way_that_worked_and_is_tried_less_often);
	RUN_TEST(test_a_way_that_comes_and_goes_does_not_make_the_table_flap);
	RUN_TEST(test_when_all_are_down_they_are_tried_in_turn_less_and_less_often);
	RUN_TEST(test_ways_that_fail_for_hours_are_told_now_and_then);
	RUN_TEST(test_a_way_that_is_stuck_is_left_for_the_next);
	RUN_TEST(test_a_way_that_says_nothing_when_it_is_opened_is_passed_over);
	RUN_TEST(test_a_write_in_doubt_on_a_stuck_way_waits_for_its_end);
	RUN_TEST(test_outputs_are_written_again_by_the_way_that_is_open_now);
	RUN_TEST(test_an_alarm_item_moves_with_the_way);
	RUN_TEST(test_a_bar_and_another_wire_make_one_table);
	RUN_TEST(test_a_bus_with_nothing_to_let_go_of_is_a_way_too);
	return UNITY_END();
}
