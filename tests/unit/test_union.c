/* SPDX-License-Identifier: MIT */
/* A comma: one table over several wires, each device served by the first that has it. */
#include "scene.h"
#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static struct scene s;

void setUp(void)
{
	scene_init(&s);
	scene_bus(&s, "other", 1);
}
void tearDown(void)
{
	scene_end(&s);
}

#define D1 "/28.551DDF030000"
#define D2 "/28.063BC8040000"
#define T1 D1 "/temperature12"
#define T2 D2 "/temperature12"
#define D3 "/29.B89115000000"
#define PIO D3 "/PIO.BYTE"
#define SENSED D3 "/sensed.BYTE"

static void both_up(void)
{
	scene_start(&s);
	scene_up_on(&s, 0);
	scene_up_on(&s, 1);
}

static void expect(unsigned record, uint8_t quality, unsigned target)
{
	struct ows_sample sample = scene_sample(&s, record);

	TEST_ASSERT_EQUAL_HEX8(quality, sample.quality);
	TEST_ASSERT_EQUAL_UINT(target, sample.target);
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
	both_up();
	scene_run(&s, 2 * SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
	expect(2, OWS_Q_GOOD, 1);
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
	expect(1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_DOUBLE(1, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].reads);
}

static void test_a_device_is_not_given_up_before_its_retries_are_over(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T1, "2", 0);
	both_up();
	scene_run(&s, 350 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(4, s.bus[0].reads); /* 1 + MaxRetries */
	expect(1, OWS_Q_GOOD, 1);
}

static void test_a_device_that_is_plugged_to_another_wire_is_found_there(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
	scene_plug(&s, D1, 1);
	scene_run(&s, 120 * SCENE_MS); /* in its retries: the value is as it was, and old */
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_plug(&s, D1, 0);
	run_watching(1, 5 * SCENE_S, 9);
	expect(1, OWS_Q_GOOD, 0);
}

static void test_between_two_wires_the_last_value_is_usable_and_not_good(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	/* known to be on the other: its search says so */
	scene_plug(&s, D1, 1);
	s.bus[1].latency_ns = 500 * SCENE_MS;
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_tell(&s, 0, BUS_LOST, D1);
	scene_run(&s, 100 * SCENE_MS);
	expect(1, OWS_Q_LAST_USABLE, 1);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_put_on(&s, 1, T1, "23", 0);
	scene_run(&s, 500 * SCENE_MS);
	expect(1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(23, scene_number(&s, 1));
}

static void test_an_answer_that_comes_after_the_move_is_not_believed(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "85.5", 0);
	scene_put_on(&s, 1, T1, "23", 0);
	both_up();
	scene_run(&s, SCENE_S);
	s.bus[0].latency_ns = 400 * SCENE_MS;
	s.bus[1].latency_ns = 800 * SCENE_MS;
	scene_run(&s, 200 * SCENE_MS); /* a read is on its way */
	scene_tell(&s, 0, BUS_LOST, D1);
	run_watching(1, 700 * SCENE_MS, 0);
	expect(1, OWS_Q_LAST_USABLE, 1);
	scene_run(&s, 300 * SCENE_MS);
	expect(1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_DOUBLE(23, scene_number(&s, 1));
}

static void test_an_absent_device_stays_with_the_first_and_is_found_wherever_it_turns_up(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T2, "1", 0);
	scene_put_on(&s, SCENE_NOWHERE, T1, "21.5", 0);
	both_up();
	scene_run(&s, 300 * SCENE_S);
	expect(1, OWS_Q_NO_DEVICE, 0);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_in"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 1, "moves_out"));
	/* with back-off: 1 2 4 ... 60 s */
	TEST_ASSERT_GREATER_THAN_UINT64(5, scene_counter_of(&s, 1, "probes"));
	TEST_ASSERT_LESS_THAN_UINT64(15, scene_counter_of(&s, 1, "probes"));
	TEST_ASSERT_LESS_THAN_UINT(40, s.bus[1].reads);
	scene_plug(&s, D1, 1);
	scene_run(&s, 61 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_plug(&s, D1, SCENE_NOWHERE);
	scene_run(&s, 10 * SCENE_S);
	expect(1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, D1, 0);
	scene_run(&s, 61 * SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
}

static void test_a_bus_that_searches_brings_an_absent_device_back_at_once(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, SCENE_NOWHERE, T1, "21.5", 0);
	both_up();
	scene_run(&s, 100 * SCENE_S);
	expect(1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, D1, 1);
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_run(&s, 10 * SCENE_MS);
	expect(1, OWS_Q_GOOD, 1);
}

static void test_a_target_that_is_down_keeps_the_devices_it_had(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T1, "22.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_run(&s, 100 * SCENE_S);
	expect(1, OWS_Q_TARGET, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].reads + s.bus[1].probes);
	scene_up_on(&s, 0);
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
}

static void test_a_device_found_elsewhere_leaves_a_target_that_is_down(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_plug(&s, D1, 1);
	scene_tell(&s, 1, BUS_FOUND, D1);
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
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
	expect(1, OWS_Q_GOOD, 1);
	/* when it comes, it is asked once whether it has the device */
	scene_up_on(&s, 0);
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].probes);
	expect(1, OWS_Q_GOOD, 1);
}

static void test_a_device_returns_to_an_earlier_target_after_evidence_and_a_hold(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T1, "22.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_run(&s, 100 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1); /* nobody said so */
	scene_tell(&s, 0, BUS_FOUND, D1);
	scene_run(&s, 9 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_run(&s, 2 * SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
}

static void test_a_path_without_a_device_goes_to_the_first_target_that_is_up(void)
{
	scene_input(&s, "count", "/statistics/reads", OWS_DWORD);
	scene_put_on(&s, 0, "/statistics/reads", "1", 0);
	scene_put_on(&s, 1, "/statistics/reads", "2", 0);
	both_up();
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_up_on(&s, 0);
	scene_run(&s, 9 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_run(&s, 2 * SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
}

static void test_a_device_known_by_its_alias_is_found_by_answers_alone(void)
{
	scene_input(&s, "t1", "/boiler/temperature", OWS_DOUBLE);
	scene_put_on(&s, 1, "/boiler/temperature", "60.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	scene_plug(&s, "/boiler", SCENE_NOWHERE);
	scene_run(&s, 30 * SCENE_S);
	expect(1, OWS_Q_NO_DEVICE, 0);
	scene_plug(&s, "/boiler", 1);
	scene_run(&s, 61 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
}

/* --- Outputs --------------------------------------------------------------------------------- */

static void test_an_output_is_written_again_where_its_device_is_now(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);

	pio->has_init = true;
	pio->init_value = 3;
	pio->init_text = "3";
	scene_put_on(&s, 0, PIO, "0", 0);
	both_up();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=3\n", s.trace);
	scene_set(&s, 1, 5);
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_GOOD, 0);
	scene_clear_trace(&s);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 0, BUS_LOST, D3);
	expect(1, OWS_Q_LAST_USABLE, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=5\n", s.trace);
	expect(1, OWS_Q_GOOD, 1);
	/* and what is set after the move goes there too */
	scene_set(&s, 1, 6);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=5\n1: W " PIO "=6\n", s.trace);
}

static void test_a_safe_value_follows_the_device(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);
	struct ows_client *client;

	pio->has_safe = true;
	pio->safe_value = 9;
	scene_put_on(&s, 0, PIO, "0", 0);
	both_up();
	client = scene_client(&s, 0);
	client->pid = 4711;
	client->period_ms = 1000;
	scene_run(&s, 100 * SCENE_MS);
	scene_slot(&s, 1)->client = 1;
	scene_set(&s, 1, 5);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("5", scene_at(&s, PIO));
	/* the program dies while its device is nowhere */
	scene_plug(&s, D3, SCENE_NOWHERE);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, 10 * SCENE_S);
	scene_plug(&s, D3, 1);
	scene_run(&s, 61 * SCENE_S);
	expect(1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_STRING("9", scene_at(&s, PIO));
}

static void test_a_write_in_doubt_holds_the_other_target_back_and_is_made_good(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put_on(&s, 0, PIO, "0", 0);
	both_up();
	s.bus[0].mute = true;
	scene_set(&s, 1, 1);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 1, BUS_FOUND, D3);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_set(&s, 1, 2);
	scene_run(&s, 60 * SCENE_S);
	/* the old write may still switch the relay: nobody else writes */
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].writes);
	expect(1, OWS_Q_INITIAL, 1);
	TEST_ASSERT_EQUAL_INT32(-EINPROGRESS, scene_sample(&s, 1).err);
	scene_clear_trace(&s);
	s.bus[0].mute = false;
	scene_answer_on(&s, 0, s.bus[0].swallowed[0]->id, 0, NULL, s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=2\n", s.trace);
	expect(1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
}

static void test_a_write_in_flight_during_a_move_is_made_good_in_its_turn(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put_on(&s, 0, PIO, "0", 0);
	both_up();
	s.bus[0].latency_ns = 300 * SCENE_MS;
	scene_set(&s, 1, 1);
	scene_run(&s, 100 * SCENE_MS);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_plug(&s, D3, 1);
	scene_set(&s, 1, 2);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].writes);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("2", scene_at(&s, PIO));
	expect(1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].writes);
}

static void test_a_single_write_that_was_on_its_way_is_asked_of_the_new_target(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);

	pio->writable = false;
	scene_put_on(&s, 0, PIO, "0", 0);
	both_up();
	s.bus[0].latency_ns = 300 * SCENE_MS;
	scene_set(&s, 1, 4);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_slot(&s, 1)->one_shot++;
	scene_ring(&s, 1);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].writes);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("4", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].writes);
}

/* One input after as many writes as the target has outputs: those that went count no more. */
static void test_inputs_are_not_starved_by_outputs_that_came(void)
{
	static char path[6][32], name[6][8];

	for (unsigned i = 0; i < 6; i++) {
		snprintf(path[i], sizeof(path[i]), D3 "/PIO.%u", i);
		snprintf(name[i], sizeof(name[i]), "pio%u", i);
		scene_output(&s, name[i], path[i], OWS_BYTE);
		scene_put_on(&s, 0, path[i], "0", 0);
	}
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 1, T2, "1", 0);
	scene_put_on(&s, 0, T1, "1", 0);
	both_up();
	scene_run(&s, SCENE_S);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 0, BUS_LOST, D3);
	s.bus[1].latency_ns = 50 * SCENE_MS;
	s.bus[1].reads = s.bus[1].writes = 0;
	for (unsigned i = 0; i < 200; i++) {
		for (unsigned k = 1; k <= 6; k++)
			scene_set(&s, k, i);
		scene_run(&s, 10 * SCENE_MS);
	}
	TEST_ASSERT_UINT_WITHIN(3, 34, s.bus[1].writes);
	TEST_ASSERT_UINT_WITHIN(2, 6, s.bus[1].reads);
	/* and the target they came from serves what is left as if they had never been there */
	TEST_ASSERT_EQUAL_UINT8(0, scene_sample(&s, 8).target);
	TEST_ASSERT_TRUE(ows_good(scene_sample(&s, 8).quality));
}

/* --- Faults of one, and the others ------------------------------------------------------------ */

static void test_a_stuck_target_delays_no_other(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T2, "22.5", 0);
	both_up();
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	s.bus[1].reads = 0;
	scene_run(&s, 30 * SCENE_S);
	expect(1, OWS_Q_TARGET, 0);
	expect(2, OWS_Q_GOOD, 1);
	TEST_ASSERT_UINT_WITHIN(3, 300, s.bus[1].reads);
}

/* --- Alarms ---------------------------------------------------------------------------------- */

static void alarm_item(void)
{
	struct config_item *item = scene_input(&s, "door", SENSED, OWS_BYTE);

	item->alarm = true;
	item->fresh = true;
	item->latch_alarm = "latch.BYTE";
	item->por_alarm = "por";
	item->set_alarm = "set_alarm=133333333";
	item->reset_latch = "latch.BYTE=0";
	scene_put_on(&s, 0, SENSED, "0", 0);
	scene_put_on(&s, 0, D3 "/latch.BYTE", "0", 0);
	scene_put_on(&s, 0, D3 "/por", "0", 0);
	scene_put_on(&s, 0, D3 "/set_alarm", "133333333", 0);
	scene_put_on(&s, 0, "/alarm", "", 0);
	scene_put_on(&s, 1, "/alarm", "", 0);
}

static void test_a_target_without_alarm_items_is_not_asked_for_alarms(void)
{
	alarm_item();
	both_up();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[0].lists);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].lists);
}

static void test_an_alarm_item_is_armed_and_served_where_its_device_is_now(void)
{
	alarm_item();
	both_up();
	scene_run(&s, SCENE_S);
	scene_plug(&s, D3, 1);
	scene_put_on(&s, 1, D3 "/set_alarm", "000000000", 0);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_clear_trace(&s);
	s.bus[0].lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(1, s.bus[0].lists);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[1].lists);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: W " D3 "/set_alarm=133333333"));
	/* an alarm there is seen, from the power-on flag on */
	scene_put_on(&s, 1, D3 "/latch.BYTE", "4", 0);
	scene_put_on(&s, 1, "/alarm", D3 "\n", 0);
	scene_clear_trace(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: r " D3 "/por\n1: r " D3 "/latch.BYTE"));
	TEST_ASSERT_GREATER_THAN_UINT32(0, scene_attrs(&s, 1).alarms);
}

static void test_the_machine_goes_on_when_the_item_it_works_on_moves(void)
{
	alarm_item();
	s.bus[0].slow = D3 "/por";
	s.bus[0].slow_ns = 500 * SCENE_MS;
	scene_input(&s, "t1", T1, OWS_DOUBLE)->alarm = true;
	scene_put_on(&s, 0, T1, "21", 0);
	scene_put_on(&s, 0, "/alarm", D3 "\n", 0);
	both_up();
	scene_run(&s, 300 * SCENE_MS); /* the read of por is on its way */
	scene_plug(&s, D3, 1);
	scene_put_on(&s, 0, "/alarm", "", 0);
	scene_put_on(&s, 1, "/alarm", D3 "\n", 0);
	scene_put_on(&s, 1, D3 "/latch.BYTE", "4", 0);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, 600 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	s.bus[0].lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[0].lists);
}

static void test_types_are_checked_on_the_target_that_serves_a_signal(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, "/structure/28/temperature12", "t,000000,000001,ro,000012,v,", 0);
	scene_put_on(&s, 1, "/structure/28/temperature12", "D,000000,000001,ro,000012,v,", 0);
	scene_put_on(&s, 1, T1, NULL, -EISDIR);
	both_up();
	scene_run(&s, SCENE_S);
	expect(1, OWS_Q_NO_PROPERTY, 1);
	TEST_ASSERT_EQUAL_UINT(2, s.structure_reads);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_device_is_served_by_the_target_that_has_it);
	RUN_TEST(test_the_first_of_two_that_have_a_device_serves_it);
	RUN_TEST(test_a_device_is_not_given_up_before_its_retries_are_over);
	RUN_TEST(test_a_device_that_is_plugged_to_another_wire_is_found_there);
	RUN_TEST(test_between_two_wires_the_last_value_is_usable_and_not_good);
	RUN_TEST(test_an_answer_that_comes_after_the_move_is_not_believed);
	RUN_TEST(test_an_absent_device_stays_with_the_first_and_is_found_wherever_it_turns_up);
	RUN_TEST(test_a_bus_that_searches_brings_an_absent_device_back_at_once);
	RUN_TEST(test_a_target_that_is_down_keeps_the_devices_it_had);
	RUN_TEST(test_a_device_found_elsewhere_leaves_a_target_that_is_down);
	RUN_TEST(test_devices_of_a_target_that_never_came_up_are_looked_for_on_the_next);
	RUN_TEST(test_a_device_returns_to_an_earlier_target_after_evidence_and_a_hold);
	RUN_TEST(test_a_path_without_a_device_goes_to_the_first_target_that_is_up);
	RUN_TEST(test_a_device_known_by_its_alias_is_found_by_answers_alone);
	RUN_TEST(test_an_output_is_written_again_where_its_device_is_now);
	RUN_TEST(test_a_safe_value_follows_the_device);
	RUN_TEST(test_a_write_in_doubt_holds_the_other_target_back_and_is_made_good);
	RUN_TEST(test_a_write_in_flight_during_a_move_is_made_good_in_its_turn);
	RUN_TEST(test_a_single_write_that_was_on_its_way_is_asked_of_the_new_target);
	RUN_TEST(test_inputs_are_not_starved_by_outputs_that_came);
	RUN_TEST(test_a_stuck_target_delays_no_other);
	RUN_TEST(test_a_target_without_alarm_items_is_not_asked_for_alarms);
	RUN_TEST(test_an_alarm_item_is_armed_and_served_where_its_device_is_now);
	RUN_TEST(test_the_machine_goes_on_when_the_item_it_works_on_moves);
	RUN_TEST(test_types_are_checked_on_the_target_that_serves_a_signal);
	return UNITY_END();
}
