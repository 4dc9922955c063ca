/* SPDX-License-Identifier: MIT */
/* A target that has a device by its own word alone, and what it may hold of it. */
#include <errno.h>

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

static uint64_t moves(void)
{
	return scene_counter_of(&s, 0, "moves_in") + scene_counter_of(&s, 1, "moves_in");
}

/* Run, and nothing is ever good that did not come from the target `true_one`. */
static void run_watching(unsigned record, int64_t ns, unsigned true_one)
{
	for (int64_t t = 0; t < ns; t += 10 * SCENE_MS) {
		struct ows_sample sample;

		scene_run(&s, 10 * SCENE_MS);
		sample = scene_sample(&s, record);
		TEST_ASSERT_FALSE(ows_good(sample.quality) && sample.target != true_one);
	}
}

static void test_a_liar_that_stands_first_does_not_keep_a_device(void)
{
	static const struct {
		const char *text;
		int err;
	} lies[] = {{"-999.9", -EDOM}, {"85", -ERANGE}, {"abc", 0},    {"", 0},
	            {"", -EIO},        {"", -ENOENT},   {"", -EACCES}, {"", -EINPROGRESS}};

	for (size_t i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
		tearDown();
		setUp();
		scene_input(&s, "t1", T1, OWS_DOUBLE);
		scene_put_on(&s, 0, T1, lies[i].text, lies[i].err);
		scene_put_on(&s, 1, T1, "21.5", 0);
		two_wires_up(&s);
		run_watching(1, 2 * SCENE_S, 1);
		scene_expect(&s, 1, OWS_Q_GOOD, 1);
		/* and it stays with the one that has it */
		run_watching(1, 1800 * SCENE_S, 1);
		scene_expect(&s, 1, OWS_Q_GOOD, 1);
		TEST_ASSERT_EQUAL_UINT64(1, moves());
	}
}

static void test_what_a_liar_takes_for_written_keeps_no_device_either(void)
{
	scene_input(&s, "in", SENSED, OWS_BYTE);
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put_on(&s, 0, SENSED, "abc", 0);
	scene_put_on(&s, 0, PIO, "0", 0);
	scene_put_on(&s, 1, SENSED, "7", 0);
	scene_put_on(&s, 1, PIO, "0", 0);
	two_wires_up(&s);
	scene_set(&s, 2, 3);
	scene_run(&s, 3 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
	scene_set(&s, 2, 4);
	scene_run(&s, SCENE_S);
	scene_expect(&s, 2, OWS_Q_GOOD, 1);
	TEST_ASSERT_EQUAL_UINT64(2, moves());
}

static void test_one_signal_that_fails_beside_a_good_one_moves_nothing(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "low", D1 "/templow", OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 0, D1 "/templow", "", -ENOENT);
	scene_put_on(&s, 1, T1, "22.5", 0);
	two_wires_up(&s);
	scene_run(&s, 300 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT64(0, moves());
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].probes);
}

static void test_a_device_that_fails_stays_where_nobody_else_has_it(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "", -EIO);
	two_wires_up(&s);
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT64(0, moves());
	TEST_ASSERT_LESS_OR_EQUAL_UINT(20, s.bus[1].probes); /* 1, 2, 4 ... 60 s */
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_run(&s, 61 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	s.bus[1].probes = 0;
	scene_run(&s, 300 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].probes);
}

static void test_a_device_that_fails_for_less_than_its_retries_moves_nowhere(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "21.5", 0);
	scene_put_on(&s, 1, T1, "22.5", 0);
	two_wires_up(&s);
	for (int i = 0; i < 100; i++) {
		scene_put_on(&s, 0, T1, "-999.9", -EDOM);
		scene_run(&s, 250 * SCENE_MS);
		scene_put_on(&s, 0, T1, "21.5", 0);
		scene_run(&s, 500 * SCENE_MS);
		scene_expect(&s, 1, OWS_Q_GOOD, 0);
	}
	TEST_ASSERT_EQUAL_UINT64(0, moves());
}

/* Two that both claim it and both fail: each gets its chance, and not many. */
static void test_between_two_that_fail_a_device_does_not_swing(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "-999.9", -EDOM);
	scene_put_on(&s, 1, T1, "", -EIO);
	two_wires_up(&s);
	run_watching(1, 3600 * SCENE_S, 9);
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(13, moves()); /* two in ten minutes */
	TEST_ASSERT_GREATER_THAN_UINT64(1, moves());
	/* and the one that mends itself gets it */
	scene_put_on(&s, 0, T1, "20.5", 0);
	scene_run(&s, 720 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_put_on(&s, 1, T1, "22.5", 0);
	scene_run(&s, 3600 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_what_failed_on_one_wire_is_served_from_there_when_the_other_has_lost_it(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put_on(&s, 0, T1, "-999.9", -EDOM);
	scene_put_on(&s, 1, T1, "21.5", 0);
	two_wires_up(&s);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 1);
	scene_plug(&s, D1, 0);
	scene_put_on(&s, 0, T1, "22.5", 0);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_liar_that_stands_first_does_not_keep_a_device);
	RUN_TEST(test_what_a_liar_takes_for_written_keeps_no_device_either);
	RUN_TEST(test_one_signal_that_fails_beside_a_good_one_moves_nothing);
	RUN_TEST(test_a_device_that_fails_stays_where_nobody_else_has_it);
	RUN_TEST(test_a_device_that_fails_for_less_than_its_retries_moves_nowhere);
	RUN_TEST(test_between_two_that_fail_a_device_does_not_swing);
	RUN_TEST(test_what_failed_on_one_wire_is_served_from_there_when_the_other_has_lost_it);
	return UNITY_END();
}
