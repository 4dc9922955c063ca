/* SPDX-License-Identifier: MIT */
/* Outputs of devices that go from one wire to another: each is written where its device is now. */
#include <errno.h>
#include <stdio.h>

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

static void test_an_output_is_written_again_where_its_device_is_now(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);

	pio->has_init = true;
	pio->init_value = 3;
	pio->init_text = "3";
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=3\n", s.trace);
	scene_set(&s, 1, 5);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_clear_trace(&s);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_expect(&s, 1, OWS_Q_LAST_USABLE, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=5\n", s.trace);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	/* and what is set after the move goes there too */
	scene_set(&s, 1, 6);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=5\n1: W " PIO "=6\n", s.trace);
}

static void test_an_input_is_not_written_again_where_its_device_is_now(void)
{
	scene_input(&s, "pio", PIO, OWS_BYTE)->writable = true;
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
	scene_set(&s, 1, 5);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].writes);
}

static void test_a_safe_value_follows_the_device(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);

	pio->has_safe = true;
	pio->safe_value = 9;
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
	giving_beat(&s.controllers[0], 1000);
	scene_run(&s, 100 * SCENE_MS);
	scene_set(&s, 1, 5);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("5", scene_at(&s, PIO));
	/* the program dies while its device is nowhere */
	scene_plug(&s, D3, SCENE_NOWHERE);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, 10 * SCENE_S);
	scene_plug(&s, D3, 1);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_STRING("9", scene_at(&s, PIO));
}

static void test_a_write_in_doubt_holds_the_other_target_back_and_is_made_good(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
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
	scene_expect(&s, 1, OWS_Q_INITIAL, 1);
	TEST_ASSERT_EQUAL_INT32(-EINPROGRESS, scene_sample(&s, 1).err);
	scene_clear_trace(&s);
	s.bus[0].mute = false;
	scene_answer_on(&s, 0, s.bus[0].swallowed[0]->id, 0, NULL, s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1: W " PIO "=2\n", s.trace);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
}

/* A set of an input was an event: the other target does not do it once more. */
static void test_a_set_of_an_input_in_doubt_is_not_repeated_elsewhere(void)
{
	scene_input(&s, "pio", PIO, OWS_BYTE)->writable = true;
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	scene_set(&s, 1, 5);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].writes);
	scene_plug(&s, D3, 1);
	scene_tell(&s, 1, BUS_FOUND, D3);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, 10 * SCENE_S);
	s.bus[0].mute = false;
	for (unsigned i = 0; i < s.bus[0].swallowed_count; i++)
		scene_answer_on(&s, 0, s.bus[0].swallowed[i]->id,
		                s.bus[0].swallowed[i]->op == BUS_WRITE ? 0 : -ENODEV, NULL,
		                s.bus[0].swallowed[i]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
}

static void test_a_write_in_flight_during_a_move_is_made_good_in_its_turn(void)
{
	scene_output(&s, "pio", PIO, OWS_BYTE);
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
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
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[1].writes);
}

static void test_a_single_write_that_was_on_its_way_is_asked_of_the_new_target(void)
{
	struct config_item *pio = scene_output(&s, "pio", PIO, OWS_BYTE);

	pio->writable = false;
	scene_put_on(&s, 0, PIO, "0", 0);
	two_wires_up(&s);
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
	two_wires_up(&s);
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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_output_is_written_again_where_its_device_is_now);
	RUN_TEST(test_an_input_is_not_written_again_where_its_device_is_now);
	RUN_TEST(test_a_safe_value_follows_the_device);
	RUN_TEST(test_a_write_in_doubt_holds_the_other_target_back_and_is_made_good);
	RUN_TEST(test_a_set_of_an_input_in_doubt_is_not_repeated_elsewhere);
	RUN_TEST(test_a_write_in_flight_during_a_move_is_made_good_in_its_turn);
	RUN_TEST(test_a_single_write_that_was_on_its_way_is_asked_of_the_new_target);
	RUN_TEST(test_inputs_are_not_starved_by_outputs_that_came);
	return UNITY_END();
}
