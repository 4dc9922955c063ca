/* SPDX-License-Identifier: MIT */
/* The keys of an Item that make alarms: limits, and what the alarm machine reads and writes. */
#include <errno.h>

#include "unity.h"

#include "src/config/read/alarm.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_wrong_limits_are_errors_with_what_was_expected(void)
{
#define NUMBER "Name x Path /a/b Type double\n"
	static const struct line cases[] = {
		{NUMBER "LimitH hot", "f:4:8: error: LimitH \"hot\": expected a number\n"},
		{NUMBER "LimitH nan", "f:4:8: error: LimitH \"nan\": expected a number\n"},
		{NUMBER "LimitL 1 LimitH 1",
	         "f:4:17: error: LimitH \"1\": expected more than LimitL, which is 1 in line 4\n"},
		{NUMBER "LimitHH 5\nLimitLL 7",
	         "f:4:9: error: LimitHH \"5\": expected more than LimitLL, which is 7 in line 5\n"},
		{NUMBER "LimitH 3 LimitHH 2 LimitL 4 LimitLL 5",
	         "f:4:27: error: LimitL \"4\": expected more than LimitLL, which is 5 in line 4\n"
	         "f:4:8: error: LimitH \"3\": expected more than LimitL, which is 4 in line 4\n"
	         "f:4:18: error: LimitHH \"2\": expected more than LimitH, which is 3 in line 4\n"},
		{NUMBER "LimitH 3 Hysteresis -0.1",
	         "f:4:21: error: Hysteresis \"-0.1\": expected a number, not negative\n"},
		{NUMBER "LimitL 1 LimitH 3 Hysteresis 2",
	         "f:4:30: error: Hysteresis \"2\": expected less than the 2 between LimitL and "
	         "LimitH\n"},
		{NUMBER "LimitLL 1 LimitHH 3 Hysteresis 2.5",
	         "f:4:32: error: Hysteresis \"2.5\": expected less than the 2 between LimitLL and "
	         "LimitHH\n"},
		{NUMBER "LimitH 3 OnDelay -1",
	         "f:4:18: error: OnDelay \"-1\": expected seconds from 0 to 86400\n"},
		{NUMBER "LimitH 3 OffDelay 86401",
	         "f:4:19: error: OffDelay \"86401\": expected seconds from 0 to 86400\n"},
		{"Name x Path /a/b Type string\nLimitH 3",
	         "f:4:1: error: LimitH: a string has no limits\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_limits_make_limit_alarms(void)
{
	static const struct line cases[] = {
		{NUMBER "Hysteresis 1 OffDelay 2",
	         "f:4:1: warning: Hysteresis does nothing: this Item has no limit\n"
	         "f:4:14: warning: OffDelay does nothing: this Item has no limit\n"},
		{NUMBER "", ""},
	};
	const struct config_limits *limits;

	expect_warnings(cases, COUNT(cases), parse_item);
	TEST_ASSERT_FALSE(config->items[0].limits.any);
	TEST_ASSERT_EQUAL_INT(0,
	                      parse_item(NUMBER "LimitLL -10 LimitH 30.5 Hysteresis 0.5 OnDelay 2 "
	                                        "OffDelay 0.25"));
	limits = &config->items[0].limits;
	TEST_ASSERT_TRUE(limits->any);
	TEST_ASSERT_TRUE(limits->has[CONFIG_LIMIT_LL]);
	TEST_ASSERT_FALSE(limits->has[CONFIG_LIMIT_L]);
	TEST_ASSERT_TRUE(limits->has[CONFIG_LIMIT_H]);
	TEST_ASSERT_FALSE(limits->has[CONFIG_LIMIT_HH]);
	TEST_ASSERT_EQUAL_DOUBLE(-10, limits->limit[CONFIG_LIMIT_LL]);
	TEST_ASSERT_EQUAL_DOUBLE(30.5, limits->limit[CONFIG_LIMIT_H]);
	TEST_ASSERT_EQUAL_DOUBLE(0.5, limits->hysteresis);
	TEST_ASSERT_EQUAL_INT64(2000000000, limits->on_delay_ns);
	TEST_ASSERT_EQUAL_INT64(250000000, limits->off_delay_ns);
}

static void test_an_alarm_that_can_do_nothing_is_told_what_to_write(void)
{
#define NO_POR \
	"warning: this alarm can never do anything: PorAlarm is not defined; write PorAlarm " \
	"\"por\", or PorAlarm \"\" if the device has no such property\n"
#define NO_LATCH(why) \
	"warning: this alarm never reads anything: LatchAlarm is " why \
	"; write the device's latch such as LatchAlarm \"latch.BYTE\", or LatchAlarm \"present\" " \
	"if it has none\n"
#define NO_SET \
	"warning: this alarm cannot be armed after a restart of its device: SetAlarm is not " \
	"defined, so por is never cleared; write SetAlarm \"property=value\", or SetAlarm \"\" if " \
	"nothing has to be set\n"
	static const struct line cases[] = {
		{ITEM "Alarm on", "f:3:34: " NO_POR "f:3:34: " NO_LATCH("not defined")},
		{ITEM "Alarm on PorAlarm \"por\"",
	         "f:3:34: " NO_LATCH("not defined") "f:3:34: " NO_SET},
		{ITEM "Alarm on PorAlarm \"por\" LatchAlarm x", "f:3:34: " NO_SET},
		{ITEM "Alarm on PorAlarm \"\" LatchAlarm x", ""},
		{ITEM "Alarm on PorAlarm \"por\" LatchAlarm x SetAlarm \"\"", ""},
		{ITEM "Alarm on PorAlarm \"\" LatchAlarm \"\"", "f:3:34: " NO_LATCH("empty")},
		{ITEM "Alarm on LatchAlarm \"latch.BYTE\"", "f:3:34: " NO_POR},
		{ITEM "Alarm on PorAlarm \"\" LatchAlarm \"present\"", ""},
		{ITEM "Alarm off LatchAlarm \"\"", ""},
		{ITEM "PorAlarm \"\" SetAlarm \"\" ResetLatch \"\"", ""},
		{ITEM "Alarm off LatchAlarm latch.BYTE PorAlarm por",
	         "f:3:38: warning: LatchAlarm does nothing while Alarm is off: write Alarm on, or take "
	         "the keys of the alarm out\n"},
		{ITEM "LatchAlarm \"\" ResetLatch latch.BYTE=0",
	         "f:3:42: warning: ResetLatch does nothing without Alarm: write Alarm on, or take the "
	         "keys of the alarm out\n"},
		{"Name x Path /29.000000000001/sensed.BYTE IOType 0x0312 Alarm off LatchAlarm latch.BYTE",
	         "f:3:49: warning: IOType 0x0312 has the unknown bits 0x0200, which are ignored\n"
	         "f:3:66: warning: LatchAlarm does nothing while Alarm is off: write Alarm on, or take "
	         "the keys of the alarm out\n"},
		{ITEM
	         "Alarm on PorAlarm \"por\" LatchAlarm \"latch\" SetAlarm \"set_alarm\" ResetLatch \"\"",
	         "f:3:80: warning: SetAlarm \"set_alarm\" has no '=': nothing is written, and the alarm "
	         "cannot be armed after a restart of its device; expected property=value\n"},
		{ITEM
	         "Alarm on PorAlarm \"por\" LatchAlarm \"latch\" SetAlarm \"a=b\" ResetLatch \"latch=0\"",
	         ""},
	};

	expect_warnings(cases, COUNT(cases), parse_item);
	TEST_ASSERT_EQUAL_STRING("a=b", config->items[0].set_alarm);
	TEST_ASSERT_EQUAL_STRING("latch=0", config->items[0].reset_latch);
}

static void test_strings_without_alarm_beside_unknown_bits_are_an_error(void)
{
#define BITS "warning: IOType 0x0312 has the unknown bits 0x0200, which are ignored\n"
	static const struct line cases[] = {
		{"Name x Path /29.000000000001/sensed.BYTE IOType 0x0312 PorAlarm por LatchAlarm l",
	         "f:3:49: " BITS
	         "f:3:69: error: LatchAlarm is there and Alarm is not, and IOType 0x0312 has the "
	         "unknown bits 0x0200: write Alarm on, or Alarm off if it is to do nothing\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_absent_alarm_strings_are_not_defined_and_empty_ones_are_empty(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM "LatchAlarm \"\" PorAlarm \"por\""));
	TEST_ASSERT_EQUAL_STRING("", config->items[0].latch_alarm);
	TEST_ASSERT_EQUAL_STRING("por", config->items[0].por_alarm);
	TEST_ASSERT_NULL(config->items[0].set_alarm);
	TEST_ASSERT_NULL(config->items[0].reset_latch);
	TEST_ASSERT_FALSE(config->items[0].alarm);
}

static void test_a_string_of_an_alarm_names_a_property_of_the_item_s_device(void)
{
	static const struct config_item item = {.path = "/bus.0/29.000000000001/sensed.3"};
	static const struct config_item none = {.path = "/29.000000000001"};
	char path[ALARM_PATH];

	TEST_ASSERT_EQUAL_STRING("latch.BYTE", alarm_path(&item, "latch.BYTE=1", path));
	TEST_ASSERT_EQUAL_STRING("/bus.0/29.000000000001/latch.BYTE", path);
	TEST_ASSERT_NULL(alarm_path(&item, "", path));
	TEST_ASSERT_NULL(alarm_path(&item, "=1", path));
	TEST_ASSERT_NULL(alarm_path(&item, NULL, path));
	TEST_ASSERT_NULL(alarm_path(&none, "por", path));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_wrong_limits_are_errors_with_what_was_expected);
	RUN_TEST(test_limits_make_limit_alarms);
	RUN_TEST(test_an_alarm_that_can_do_nothing_is_told_what_to_write);
	RUN_TEST(test_strings_without_alarm_beside_unknown_bits_are_an_error);
	RUN_TEST(test_absent_alarm_strings_are_not_defined_and_empty_ones_are_empty);
	RUN_TEST(test_a_string_of_an_alarm_names_a_property_of_the_item_s_device);
	return UNITY_END();
}
