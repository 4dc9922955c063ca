/* SPDX-License-Identifier: MIT */
/* Tests of Record on a virtual clock: which samples are kept. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/config/read/recorder.h"
#include "src/history/recorder/rule.h"

static struct config_record rule;
static struct rule_kept kept;
static char took[256]; /* the numbers that were kept, with commas */

void setUp(void)
{
	kept = (struct rule_kept){0};
	*took = '\0';
}

void tearDown(void)
{
}

static void record(const char *text)
{
	char why[128];

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, record_parse(text, &rule, why, sizeof(why)), text);
}

static void keep(const struct ows_value *sample)
{
	size_t len = strlen(took);

	kept.any = true;
	kept.sample = *sample;
	snprintf(took + len, sizeof(took) - len, "%g%s,", sample->number + (double)sample->integer,
	         ows_good(sample->quality) ? "" : "!");
}

static void sample_of(double number, uint8_t quality, int64_t second)
{
	struct ows_value sample = {.type = OWS_DOUBLE,
	                           .quality = quality,
	                           .number = number,
	                           .measured_ns = second * NS_PER_S};

	if (rule_change(&rule, &kept, &sample))
		keep(&sample);
}

static void good(double number, int64_t second)
{
	sample_of(number, OWS_Q_GOOD, second);
}

static void test_each_change_is_kept_and_nothing_else(void)
{
	record("change");
	good(20, 1);
	good(20, 2);
	good(20.0625, 3);
	good(20.0625, 4);
	good(20, 5);
	TEST_ASSERT_EQUAL_STRING("20,20.0625,20,", took);
}

static void test_a_deadband_counts_from_what_was_kept_so_that_a_drift_is_seen(void)
{
	record("deadband 0.5");
	good(20, 1);
	for (int i = 1; i <= 12; i++)
		good(20 + 0.125 * i, 1 + i);
	good(21.25, 20);
	good(20.75, 21);
	TEST_ASSERT_EQUAL_STRING("20,20.625,21.25,", took);
}

static void test_a_change_of_quality_is_kept_by_every_rule_but_off(void)
{
	static const char *const rules[] = {"change", "deadband 5", "interval 60", "raw"};

	for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
		setUp();
		record(rules[i]);
		good(20, 1);
		sample_of(20, OWS_Q_NO_DEVICE, 1);
		sample_of(20, OWS_Q_NO_DEVICE, 1);
		sample_of(20, OWS_Q_TARGET, 1);
		good(20, 5);
		TEST_ASSERT_EQUAL_STRING_MESSAGE("20,20!,20!,20,", took, rules[i]);
	}
	setUp();
	record("off");
	good(20, 1);
	sample_of(20, OWS_Q_NO_DEVICE, 1);
	TEST_ASSERT_EQUAL_STRING("", took);
}

static void test_what_is_no_number_is_one_value_and_infinities_are_two(void)
{
	record("deadband 1");
	good(NAN, 1);
	good(NAN, 2);
	TEST_ASSERT_EQUAL_STRING("nan,", took);
	good(5, 3);
	good(NAN, 4);
	good(HUGE_VAL, 5);
	good(HUGE_VAL, 6);
	good(-HUGE_VAL, 7);
	TEST_ASSERT_EQUAL_STRING("nan,5,nan,inf,-inf,", took);
}

static void integer(int64_t value)
{
	struct ows_value sample = {.type = OWS_LARGE, .quality = OWS_Q_GOOD, .integer = value};

	if (rule_change(&rule, &kept, &sample))
		keep(&sample);
}

static void test_integers_that_a_double_cannot_tell_apart_are_two_values(void)
{
	record("change");
	integer(INT64_C(9007199254740993));
	integer(INT64_C(9007199254740992));
	integer(INT64_C(9007199254740992));
	TEST_ASSERT_EQUAL_STRING("9.0072e+15,9.0072e+15,", took);
	setUp();
	record("deadband 10");
	integer(100);
	integer(110);
	integer(111);
	TEST_ASSERT_EQUAL_STRING("100,111,", took);
	integer(INT64_MIN);
	integer(INT64_MAX);
	TEST_ASSERT_EQUAL_STRING("100,111,-9.22337e+18,9.22337e+18,", took);
}

static void test_a_signal_of_another_type_is_another_signal(void)
{
	record("deadband 10");
	good(5, 1);
	integer(5);
	TEST_ASSERT_EQUAL_STRING("5,5,", took);
}

/* A second of the clock: the newest value is offered at changes and at turns. */
static void second(int64_t wall_s, double number)
{
	struct ows_value sample = {.type = OWS_DOUBLE,
	                           .quality = OWS_Q_GOOD,
	                           .number = number,
	                           .measured_ns = wall_s * NS_PER_S};
	bool ticked = rule_tick(&rule, &kept, wall_s * NS_PER_S);

	if (rule_change(&rule, &kept, &sample) || (ticked && rule_interval(&kept, &sample)))
		keep(&sample);
}

static void test_an_interval_keeps_the_newest_value_at_its_multiples(void)
{
	record("interval 10");
	for (int64_t t = 3; t <= 43; t++)
		second(t, (double)t);
	TEST_ASSERT_EQUAL_STRING("3,10,20,30,40,", took);
	TEST_ASSERT_EQUAL_INT64(50 * NS_PER_S, rule_next_tick(&rule, 43 * NS_PER_S));
	TEST_ASSERT_EQUAL_INT64(50 * NS_PER_S, rule_next_tick(&rule, 40 * NS_PER_S));
}

static void test_an_interval_beside_a_deadband_adds_what_stayed_within_it(void)
{
	record("deadband 5, interval 10");
	for (int64_t t = 1; t <= 30; t++)
		second(t, t < 15 ? 1 : t < 18 ? 9 : 10);
	/* first, at 10 the same again, the jump at 15, then at 20 and 30 */
	TEST_ASSERT_EQUAL_STRING("1,1,9,10,10,", took);
}

static void test_a_value_that_was_not_read_anew_is_not_kept_again(void)
{
	struct ows_value sample = {.type = OWS_DOUBLE, .quality = OWS_Q_GOOD, .measured_ns = 5};

	record("interval 10");
	TEST_ASSERT_TRUE(rule_change(&rule, &kept, &sample));
	keep(&sample);
	TEST_ASSERT_TRUE(rule_tick(&rule, &kept, 10 * NS_PER_S));
	TEST_ASSERT_FALSE(rule_tick(&rule, &kept, 19 * NS_PER_S));
	TEST_ASSERT_FALSE(rule_interval(&kept, &sample));
	sample.measured_ns++;
	TEST_ASSERT_TRUE(rule_interval(&kept, &sample));
}

static void test_a_clock_that_is_set_back_turns_the_slot_too(void)
{
	record("interval 60");
	TEST_ASSERT_TRUE(rule_tick(&rule, &kept, 6000 * NS_PER_S));
	TEST_ASSERT_TRUE(rule_tick(&rule, &kept, 30 * NS_PER_S));
	TEST_ASSERT_TRUE(rule_tick(&rule, &kept, -NS_PER_S));
	TEST_ASSERT_EQUAL_INT64(0, rule_next_tick(&rule, -NS_PER_S));
}

static void test_without_an_interval_there_is_no_turn(void)
{
	record("change");
	TEST_ASSERT_FALSE(rule_tick(&rule, &kept, 6000 * NS_PER_S));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, rule_next_tick(&rule, 5));
}

static void test_a_change_may_be_missed_where_more_than_one_measurement_was_not_seen(void)
{
	struct config_record change = {.change = true}, deadband = {.deadband = 0.5}, none = {0};
	struct config_record interval = {.interval_ns = 10 * NS_PER_S};
	struct rule_kept before = {.any = true}, nothing = {0};

	TEST_ASSERT_FALSE(rule_missed(&change, &before, 1, false, 5, 9));
	TEST_ASSERT_TRUE(rule_missed(&change, &before, 2, false, 5, 9));
	TEST_ASSERT_TRUE(rule_missed(&deadband, &before, 2, false, 5, 9));
	TEST_ASSERT_FALSE(rule_missed(&none, &before, 2, false, 5, 9));
	TEST_ASSERT_FALSE(rule_missed(&change, &before, 2, false, 0, 9));
	TEST_ASSERT_FALSE(rule_missed(&change, &nothing, 2, false, 5, 9));
	TEST_ASSERT_FALSE(rule_missed(&interval, &before, 9, true, 1, 10 * NS_PER_S + 1));
	TEST_ASSERT_TRUE(rule_missed(&interval, &before, 9, true, 1, 10 * NS_PER_S + 2));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_change_is_kept_and_nothing_else);
	RUN_TEST(test_a_deadband_counts_from_what_was_kept_so_that_a_drift_is_seen);
	RUN_TEST(test_a_change_of_quality_is_kept_by_every_rule_but_off);
	RUN_TEST(test_what_is_no_number_is_one_value_and_infinities_are_two);
	RUN_TEST(test_integers_that_a_double_cannot_tell_apart_are_two_values);
	RUN_TEST(test_a_signal_of_another_type_is_another_signal);
	RUN_TEST(test_an_interval_keeps_the_newest_value_at_its_multiples);
	RUN_TEST(test_an_interval_beside_a_deadband_adds_what_stayed_within_it);
	RUN_TEST(test_a_value_that_was_not_read_anew_is_not_kept_again);
	RUN_TEST(test_a_clock_that_is_set_back_turns_the_slot_too);
	RUN_TEST(test_without_an_interval_there_is_no_turn);
	RUN_TEST(test_a_change_may_be_missed_where_more_than_one_measurement_was_not_seen);
	return UNITY_END();
}
