/* SPDX-License-Identifier: MIT */
/* The file and the keys of OwsDrv: what is wrong with them, in which words and at which place. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_defaults_are_those_of_the_manual(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse("OwsDrv { }"));
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_UINT(5, config->max_cons_alarms);
	TEST_ASSERT_EQUAL_UINT(3, config->max_retries);
	TEST_ASSERT_EQUAL_INT64(20000000000, config->timeout_ns);
	TEST_ASSERT_EQUAL_INT64(100000000, config->period_ns);
	TEST_ASSERT_EQUAL_INT64(50000000, config->alarm_period_ns);
	TEST_ASSERT_EQUAL_UINT(1, config->target_count);
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
	TEST_ASSERT_EQUAL_UINT(0, config->item_count);
}

static void test_a_file_of_something_else_is_refused(void)
{
	static const struct line cases[] = {
		{"", "f:1:1: error: expected OwsDrv {\n"},
		{"# nothing\n", "f:1:1: error: expected OwsDrv {\n"},
		{"MbmDrv {\n}\n",
	         "f:1:1: error: expected OwsDrv {, found the block MbmDrv: is it the "
	         "file of another driver?\n"},
		{"Period 1\nOwsDrv { }", "f:1:1: error: expected OwsDrv {, found Period\n"},
		{"OwsDrv 1", "f:1:8: error: expected { after OwsDrv\n"},
		{"OwsDrv { }\nOwsDrv { }",
	         "f:2:1: error: OwsDrv is given twice, first in line 1\n"},
		{"OwsDrv {", "f:1:9: error: expected '}' to end OwsDrv of line 1\n"},
	};

	expect_errors(cases, COUNT(cases), parse);
}

static void test_wrong_driver_values_are_errors_with_what_was_expected(void)
{
	static const struct line cases[] = {
		{"Timeout abc",
	         "f:2:9: error: Timeout \"abc\": expected seconds from 0.001 to 86400\n"},
		{"Timeout 0",
	         "f:2:9: error: Timeout \"0\": expected seconds from 0.001 to 86400\n"},
		{"Timeout -1",
	         "f:2:9: error: Timeout \"-1\": expected seconds from 0.001 to 86400\n"},
		{"Period 61", "f:2:8: error: Period \"61\": expected seconds from 0.001 to 60\n"},
		{"Period 0,1", "f:2:8: error: Period \"0,1\": expected seconds from 0.001 to 60\n"},
		{"MaxRetries 101",
	         "f:2:12: error: MaxRetries \"101\": expected a whole number from 0 "
	         "to 100\n"},
		{"MaxRetries 1.5",
	         "f:2:12: error: MaxRetries \"1.5\": expected a whole number from 0 "
	         "to 100\n"},
		{"MaxConsAlarms 1001",
	         "f:2:15: error: MaxConsAlarms \"1001\": expected a whole number "
	         "from 0 to 1000\n"},
		{"Timeout 1\nAlarmPeriod 2",
	         "f:3:13: error: AlarmPeriod \"2\": expected no more than "
	         "Timeout, which is 1 s\n"},
		{"Timeout 1\nTimeout 2", "f:3:1: error: Timeout is given twice, first in line 2\n"},
		{"Timeout [ 1 ]", "f:2:9: error: Timeout: expected one value\n"},
		{"Timeout { }", "f:2:9: error: Timeout: expected one value\n"},
		{"Item 5", "f:2:6: error: Item: expected a block in { }\n"},
		{"TargetName \"a, ,b\"", "f:2:12: error: expected a target beside ',' or '|'\n"},
		{"TargetName \"a|\"", "f:2:12: error: expected a target beside ',' or '|'\n"},
		{"TargetName \"w1, i2c:/dev/i2c-1 | w1\"",
	         "f:2:12: error: the target \"w1\" is given twice; the first is \"w1\"\n"},
		{"TargetName \"localhost, LOCALHOST:4304\"",
	         "f:2:12: error: the target \"LOCALHOST:4304\" is given twice; the first is "
	         "\"localhost\"\n"},
		{"TargetName \"owserver:w1:4304, owserver:w1\"",
	         "f:2:12: error: the target \"owserver:w1\" is given twice; the first is "
	         "\"owserver:w1:4304\"\n"},
		{"TargetName \"[::1] | [::1]:4304\"",
	         "f:2:12: error: the target \"[::1]:4304\" is given twice; the first is \"[::1]\"\n"},
		{"Bus { }", "f:2:1: error: expected a Target in this Bus\n"},
		{"Bus { Target \"\" }", "f:2:1: error: expected a Target in this Bus\n"},
		{"TargetName w1 Bus { Target w1 }\nBus { Target \"w1\" }",
	         "f:3:14: error: there is a Bus for \"w1\" already\n"},
		{"Bus { Target \"i2c:/dev/i2c-1\" PowerOffMs 0 }",
	         "f:2:42: error: PowerOffMs \"0\": expected a whole number from 1 to 60000\n"},
	};

	expect_errors(cases, COUNT(cases), parse_driver);
}

static void test_each_word_for_a_flag_is_one_for_a_bus(void)
{
	static const struct {
		const char *line, *text;
	} rows[] = {
		{"Bus { Target w1 Touch yes }", "on"},  {"Bus { Target w1 Touch 1 }", "on"},
		{"Bus { Target w1 Touch True }", "on"}, {"Bus { Target w1 Touch on }", "on"},
		{"Bus { Target w1 Touch no }", "off"},  {"Bus { Target w1 Touch 0 }", "off"},
		{"Bus { Target w1 Touch OFF }", "off"},
	};

	for (unsigned i = 0; i < COUNT(rows); i++) {
		parse_driver(rows[i].line);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(rows[i].text, config->buses[0].options[0].text,
		                                 rows[i].line);
	}
}

static void test_what_can_be_understood_is_only_warned_about(void)
{
	static const struct line cases[] = {
		{"MaxConsAlarms 0", "f:2:15: warning: MaxConsAlarms 0 counts as 1\n"},
		{"MaxRequests 2", "f:2:13: warning: MaxRequests 2 counts as 1\n"},
		{"Version 2.00", "f:2:9: warning: Version 2.00: only 1.00 is known\n"},
		{"ItemCount 1", "f:2:11: warning: ItemCount is 1, but there are 0 items\n"},
		{"TargetName \"\"",
	         "f:2:12: warning: TargetName is empty: localhost:4304 is taken\n"},
		{"TimeOut 3",
	         "f:2:1: warning: unknown key TimeOut in OwsDrv is ignored; is it Timeout?\n"},
		{"TargetNam x", "f:2:1: warning: unknown key TargetNam in OwsDrv is ignored; is it "
	                        "TargetName?\n"},
		{"Elephant x", "f:2:1: warning: unknown key Elephant in OwsDrv is ignored\n"},
		{"Extra { A 1 }", "f:2:1: warning: unknown key Extra in OwsDrv is ignored\n"},
		{"TargetName w1 Bus { Target \"w1\" Colour red }",
	         "f:2:33: warning: unknown key Colour in Bus is ignored\n"},
		{"Version 1.0", ""},
		{"Timeout 0.01", ""},
		{"MaxRequests 1 MaxRetries 0x0A", ""},
		{"Timeout \"7.5\"", ""},
	};

	expect_warnings(cases, COUNT(cases), parse_driver);
	TEST_ASSERT_EQUAL_INT64(7500000000, config->timeout_ns);
	parse_driver("MaxConsAlarms 0");
	TEST_ASSERT_EQUAL_UINT(1, config->max_cons_alarms);
	parse_driver("Timeout 0.01");
	TEST_ASSERT_EQUAL_INT64(10000000, config->alarm_period_ns);
	parse_driver("TargetName \" \"");
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
}

static void test_all_errors_of_a_file_are_said_in_one_go(void)
{
	TEST_ASSERT_EQUAL_INT(-EINVAL,
	                      parse("OwsDrv {\n Timeout x\n Period 0\n Item { Name \"a b\"\n"
	                            "Path \"//\" Type foo\n}\n Item {\nName \"q\n}\n}\n"));
	TEST_ASSERT_EQUAL_UINT(6, report.errors);
	TEST_ASSERT_NULL_MESSAGE(strstr(said, "expected a Path in this Item"),
	                         "where syntax failed nothing is known to be missing");
}

static void test_bytes_of_the_file_cannot_steer_the_terminal(void)
{
	parse_driver("Timeout \"\x1b[2J\"");
	TEST_ASSERT_NULL(strchr(said, '\x1b'));
	TEST_ASSERT_EQUAL_UINT(1, report.errors);
}

static void test_a_file_that_is_not_there_is_said(void)
{
	TEST_ASSERT_EQUAL_INT(-ENOENT, config_load("tests/unit/data/none.rio", &report, &config));
	TEST_ASSERT_EQUAL_UINT(1, report.errors);
	TEST_ASSERT_NULL(config);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_defaults_are_those_of_the_manual);
	RUN_TEST(test_a_file_of_something_else_is_refused);
	RUN_TEST(test_wrong_driver_values_are_errors_with_what_was_expected);
	RUN_TEST(test_each_word_for_a_flag_is_one_for_a_bus);
	RUN_TEST(test_what_can_be_understood_is_only_warned_about);
	RUN_TEST(test_all_errors_of_a_file_are_said_in_one_go);
	RUN_TEST(test_bytes_of_the_file_cannot_steer_the_terminal);
	RUN_TEST(test_a_file_that_is_not_there_is_said);
	return UNITY_END();
}
