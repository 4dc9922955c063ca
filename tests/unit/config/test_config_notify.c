/* SPDX-License-Identifier: MIT */
/* Tests of the Notify block. */
#include <string.h>

#include "unity.h"

#include "src/config/read/load.h"
#include "src/config/read/texts.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_the_block_has_defaults_but_for_the_way(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Notify { Mail \"root\" }"));
	TEST_ASSERT_TRUE(config->notify.given);
	TEST_ASSERT_EQUAL_STRING("root", config->notify.mail);
	TEST_ASSERT_EQUAL_STRING("/usr/sbin/sendmail", config->notify.sendmail);
	TEST_ASSERT_EQUAL_STRING("*", config->notify.signals);
	TEST_ASSERT_EQUAL_STRING("warning", config->notify.least);
	TEST_ASSERT_EQUAL_INT64(10000000000, config->notify.gather_ns);
	TEST_ASSERT_EQUAL_INT64(60000000000, config->notify.every_ns);
	TEST_ASSERT_EQUAL_INT64(0, config->notify.escalate_ns);
	TEST_ASSERT_NULL(config->notify.quiet);
}

static void test_what_cannot_be_is_refused_with_a_reason(void)
{
	static const struct line cases[] = {
		{"Notify { }", "f:2:8: error: Notify tells nobody: write Mail, Url or Command\n"},
		{"Notify { Mail \"a b\" }",
	         "f:2:15: error: Mail \"a b\": expected ADDRESS, or several with commas, at most "
	         "255 bytes\n"},
		{"Notify { Command \"sms\" }",
	         "f:2:18: error: Command \"sms\": expected a path from the root, at most 255 bytes\n"},
		{"Notify { Mail \"a\" Quiet \"22-6\" }",
	         "f:2:25: error: Quiet \"22-6\": expected two times of a day, such as "
	         "\"22:00-06:30\"\n"},
		{"Notify { Mail \"a\" Least \"high\" }",
	         "f:2:25: error: Least \"high\": expected warning or critical\n"},
		{"Notify { Mail \"a\" Fields \"topic\" }",
	         "f:2:26: error: Fields \"topic\": expected NAME=TEXT, with blanks between them and "
	         "none in TEXT\n"},
		{"Notify { Mail \"a\" EscalateMail \"b\" }",
	         "f:2:32: error: EscalateMail without EscalateAfter: write after how many seconds\n"},
	};

	expect_errors(cases, COUNT(cases), parse_driver);
}

static void test_an_address_has_no_blank_no_line_end_and_is_no_option(void)
{
	TEST_ASSERT_NULL(text_is_mail("root"));
	TEST_ASSERT_NULL(text_is_mail("a.b+c@d-e.example, f@g,h"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a@b\nBcc: c"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a@b\r"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a@"));
	TEST_ASSERT_NOT_NULL(text_is_mail("@b"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a@b@c"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a,"));
	TEST_ASSERT_NOT_NULL(text_is_mail("-oQ/tmp"));
	TEST_ASSERT_NOT_NULL(text_is_mail("a, -v"));
}

static void test_hours_are_two_times_of_a_day(void)
{
	unsigned from, until;

	TEST_ASSERT_TRUE(text_hours("22:00-06:30", &from, &until));
	TEST_ASSERT_EQUAL_UINT(1320, from);
	TEST_ASSERT_EQUAL_UINT(390, until);
	TEST_ASSERT_FALSE(text_hours("22:00-06:60", &from, &until));
	TEST_ASSERT_FALSE(text_hours("25:00-06:00", &from, &until));
	TEST_ASSERT_FALSE(text_hours("2:00-6:00", &from, &until));
	TEST_ASSERT_FALSE(text_hours("", &from, &until));
	TEST_ASSERT_NOT_NULL(text_is_hours("06:00-06:00"));
	TEST_ASSERT_NULL(text_is_hours("00:00-24:00"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_block_has_defaults_but_for_the_way);
	RUN_TEST(test_what_cannot_be_is_refused_with_a_reason);
	RUN_TEST(test_an_address_has_no_blank_no_line_end_and_is_no_option);
	RUN_TEST(test_hours_are_two_times_of_a_day);
	return UNITY_END();
}
