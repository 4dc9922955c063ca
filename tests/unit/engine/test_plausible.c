/* SPDX-License-Identifier: MIT */
/* Answers that cannot be true: out of the chip's range, or no value of the signal's type. */
#include <errno.h>
#include <stdlib.h>

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
#define T2 "/28.063BC8040000/temperature12"
#define SENSED "/29.B89115000000/sensed.BYTE"

static void two_thermometers(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	scene_put(&s, T2, "22.5", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 150 * SCENE_MS);
}

static void test_a_value_that_the_chip_cannot_measure_is_never_published(void)
{
	static const char *const lies[] = {"-999.9", "4095", "-127", "1e9", "     -60", "130.5"};

	two_thermometers();
	for (size_t i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
		scene_put(&s, T1, lies[i], 0);
		for (int k = 0; k < 50; k++) {
			scene_run(&s, 100 * SCENE_MS);
			TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
		}
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
		TEST_ASSERT_EQUAL_INT(-EDOM, scene_sample(&s, 1).err);
		scene_expect(&s, 2, OWS_Q_GOOD, 0);
		scene_put(&s, T1, "21.5", 0);
		scene_run(&s, 61 * SCENE_S);
		scene_expect(&s, 1, OWS_Q_GOOD, 0);
	}
	TEST_ASSERT_GREATER_THAN(6, scene_counter(&s, "out_of_range"));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "power_faults"));
}

static void test_one_value_out_of_range_is_a_retry_and_does_not_vouch_for_85(void)
{
	two_thermometers();
	scene_put(&s, T1, "-999.9", 0);
	scene_run(&s, 50 * SCENE_MS);
	scene_put(&s, T1, "22.5", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_INT(0, scene_sample(&s, 1).err);
}

static void test_both_ends_of_the_chips_range_are_believed(void)
{
	static const char *const truths[] = {"-55", "-56.5", "125", "126.9375", "0", "-0.0625"};

	two_thermometers();
	for (size_t i = 0; i < sizeof(truths) / sizeof(truths[0]); i++) {
		scene_put(&s, T1, truths[i], 0);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_DOUBLE(strtod(truths[i], NULL), scene_number(&s, 1));
		scene_expect(&s, 1, OWS_Q_GOOD, 0);
	}
}

static void test_what_a_simulated_target_makes_up_is_not_measured_against_a_chip(void)
{
	two_thermometers();
	s.bus[0].detail = BUS_DETAIL_SIMULATED;
	scene_put(&s, T1, "400", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(400, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_fraction_for_an_integer_is_an_error_of_the_item(void)
{
	scene_input(&s, "in", SENSED, OWS_BYTE);
	scene_put(&s, SENSED, "21", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_put(&s, SENSED, "21.5", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT64(21, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TYPE, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT(-EILSEQ, scene_sample(&s, 1).err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_that_the_chip_cannot_measure_is_never_published);
	RUN_TEST(test_one_value_out_of_range_is_a_retry_and_does_not_vouch_for_85);
	RUN_TEST(test_both_ends_of_the_chips_range_are_believed);
	RUN_TEST(test_what_a_simulated_target_makes_up_is_not_measured_against_a_chip);
	RUN_TEST(test_a_fraction_for_an_integer_is_an_error_of_the_item);
	return UNITY_END();
}
