/* SPDX-License-Identifier: MIT */
/* Tests of the Recorder block and of the key Record. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "src/config/read/recorder.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static struct config_record rule;
static char why[128];

static int rule_of(const char *text)
{
	return record_parse(text, &rule, why, sizeof(why));
}

static void test_each_occasion_has_its_word(void)
{
	TEST_ASSERT_EQUAL_INT(0, rule_of("change"));
	TEST_ASSERT_TRUE(rule.change && !rule.off && !rule.raw && !rule.interval_ns);
	TEST_ASSERT_EQUAL_INT(0, rule_of("off"));
	TEST_ASSERT_TRUE(rule.off && !rule.change);
	TEST_ASSERT_EQUAL_INT(0, rule_of("deadband 0.1"));
	TEST_ASSERT_EQUAL_DOUBLE(0.1, rule.deadband);
	TEST_ASSERT_FALSE(rule.change);
	TEST_ASSERT_EQUAL_INT(0, rule_of("interval 0.5"));
	TEST_ASSERT_EQUAL_INT64(500000000, rule.interval_ns);
	TEST_ASSERT_FALSE(rule.change);
	TEST_ASSERT_EQUAL_INT(0, rule_of(" deadband\t1e-3 ,interval 600 , raw "));
	TEST_ASSERT_EQUAL_DOUBLE(0.001, rule.deadband);
	TEST_ASSERT_EQUAL_INT64(600000000000, rule.interval_ns);
	TEST_ASSERT_TRUE(rule.raw && !rule.change);
	TEST_ASSERT_EQUAL_INT(0, rule_of("interval 60, change"));
	TEST_ASSERT_TRUE(rule.change && rule.interval_ns);
	TEST_ASSERT_EQUAL_INT(0, rule_of("raw"));
	TEST_ASSERT_TRUE(rule.raw && rule.change);
}

static void test_what_is_no_rule_is_refused_with_a_reason(void)
{
	static const char *const cases[][2] = {
		{"", "expected change"},
		{"always", "expected change"},
		{"Change", "expected change"},
		{"change,", "expected change"},
		{", change", "expected change"},
		{"change deadband 1", "expected change"},
		{"change 5", "change takes no number"},
		{"deadband 1 2", "expected change"},
		{"deadband", "a number above 0 after deadband"},
		{"deadband 0", "a number above 0 after deadband"},
		{"deadband -1", "a number above 0 after deadband"},
		{"deadband nan", "a number above 0 after deadband"},
		{"deadband inf", "a number above 0 after deadband"},
		{"deadband 1, deadband 2", "deadband is given twice"},
		{"deadband 1, change", "exclude each other"},
		{"interval", "seconds above 0 and up to 86400 after interval"},
		{"interval 0", "seconds above 0 and up to 86400 after interval"},
		{"interval 86401", "seconds above 0 and up to 86400 after interval"},
		{"interval 1, interval 1", "interval is given twice"},
		{"change, change", "change is given twice"},
		{"off, raw", "off stands alone"},
		{"off, interval 5", "off stands alone"},
		{"off 5", "takes no number"},
	};
	char longest[RECORD_TEXT_MAX + 2];

	for (size_t i = 0; i < COUNT(cases); i++) {
		*why = '\0';
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, rule_of(cases[i][0]), cases[i][0]);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, cases[i][1]), why);
	}
	memset(longest, ' ', sizeof(longest));
	memcpy(longest, "change", 6);
	longest[RECORD_TEXT_MAX + 1] = '\0';
	TEST_ASSERT_EQUAL_INT(-EINVAL, rule_of(longest));
	longest[RECORD_TEXT_MAX] = '\0';
	TEST_ASSERT_EQUAL_INT(0, rule_of(longest));
}

static void test_a_file_without_the_block_has_its_defaults(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM));
	TEST_ASSERT_FALSE(config->recorder.given);
	TEST_ASSERT_NULL(config->recorder.directory);
	TEST_ASSERT_EQUAL_UINT(90, config->recorder.keep_days);
	TEST_ASSERT_EQUAL_UINT(730, config->recorder.keep_minutes);
	TEST_ASSERT_EQUAL_UINT(0, config->recorder.keep_hours);
	TEST_ASSERT_EQUAL_UINT(2000, config->recorder.size_mb);
	TEST_ASSERT_EQUAL_INT64(600000000000, config->recorder.flush_ns);
	TEST_ASSERT_TRUE(config_record_of(config, &config->items[0]).change);
}

static void test_the_block_is_read(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Recorder { Directory \"/mnt/usb/h\" Keep 90 Size 0\n"
	                                      "Flush 30 Record \"interval 5\" }"));
	TEST_ASSERT_TRUE(config->recorder.given);
	TEST_ASSERT_EQUAL_STRING("/mnt/usb/h", config->recorder.directory);
	TEST_ASSERT_EQUAL_UINT(90, config->recorder.keep_days);
	TEST_ASSERT_EQUAL_UINT(0, config->recorder.size_mb);
	TEST_ASSERT_EQUAL_INT64(30000000000, config->recorder.flush_ns);
	TEST_ASSERT_EQUAL_INT64(5000000000, config->recorder.record.interval_ns);
	TEST_ASSERT_FALSE(config->recorder.record.change);
}

static void test_an_item_without_a_rule_has_that_of_the_block(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse("OwsDrv { Recorder { Record \"deadband 2, interval 60\" }\n"
	                               "Item { Name a Path /a/b Type double }\n"
	                               "Item { Name b Path /a/b Type bool }\n"
	                               "Item { Name c Path /a/b Type double Record \"change\" }\n"
	                               "Item { Name d Path /a/b Type string Record \"off\" } }"));
	TEST_ASSERT_EQUAL_DOUBLE(2, config_record_of(config, &config->items[0]).deadband);
	rule = config_record_of(config, &config->items[1]);
	TEST_ASSERT_TRUE(rule.change && rule.deadband == 0 && rule.interval_ns);
	rule = config_record_of(config, &config->items[2]);
	TEST_ASSERT_TRUE(rule.change && rule.deadband == 0 && !rule.interval_ns);
	TEST_ASSERT_TRUE(config_record_of(config, &config->items[3]).off);
}

static void test_what_cannot_be_is_an_error_at_its_place(void)
{
	static const struct line items[] = {
		{ITEM "Record \"offf\"",
	         "f:3:35: error: Record \"offf\": expected change, deadband NUMBER, interval "
	         "SECONDS, raw, or off alone\n"},
		{"Name x Path /a/b Type bool Record \"deadband 1\"",
	         "f:3:35: error: Record \"deadband 1\": a bool has no deadband; write change\n"},
		{"Name x Path /a/b Type string Record \"raw, deadband 1\"",
	         "f:3:37: error: Record \"raw, deadband 1\": a string has no deadband; write "
	         "change\n"},
	};
	static const struct line blocks[] = {
		{"Recorder { Directory \"history\" }",
	         "f:2:22: error: Directory \"history\": expected a path from the root, at most 255 "
	         "bytes\n"},
		{"Recorder { Keep -1 }",
	         "f:2:17: error: Keep \"-1\": expected a whole number from 0 to 36500\n"},
		{"Recorder { Size 1000001 }",
	         "f:2:17: error: Size \"1000001\": expected a whole number from 0 to 1000000\n"},
		{"Recorder { Flush 0 }",
	         "f:2:18: error: Flush \"0\": expected seconds from 1 to 600\n"},
		{"Recorder { Record \"never\" }",
	         "f:2:19: error: Record \"never\": expected change, deadband NUMBER, interval "
	         "SECONDS, raw, or off alone\n"},
		{"Recorder on", "f:2:10: error: Recorder: expected a block in { }\n"},
		{"Recorder { } Recorder { }",
	         "f:2:14: error: Recorder is given twice, first in line 2\n"},
	};

	expect_errors(items, COUNT(items), parse_item);
	expect_errors(blocks, COUNT(blocks), parse_driver);
}

static void test_an_unknown_key_of_the_block_is_a_warning(void)
{
	static const struct line blocks[] = {
		{"Recorder { Flash 5 }",
	         "f:2:12: warning: unknown key Flash in Recorder is ignored; is it Flush?\n"},
	};

	expect_warnings(blocks, COUNT(blocks), parse_driver);
}

static void test_what_is_printed_has_block_and_rules(void)
{
	size_t len;
	char *text;
	FILE *out = open_memstream(&text, &len);

	TEST_ASSERT_NOT_NULL(out);
	TEST_ASSERT_EQUAL_INT(0, parse("OwsDrv { Recorder { Keep 7 Record \"interval 9\" }\n"
	                               "Item { Name a Path /a/b Type double "
	                               "Record \"deadband 0.5, raw\" } }"));
	config_print(config, out);
	TEST_ASSERT_EQUAL_INT(0, fclose(out));
	config_free(config);
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, parse(text));
	free(text);
	TEST_ASSERT_EQUAL_UINT(7, config->recorder.keep_days);
	TEST_ASSERT_EQUAL_INT64(9000000000, config->recorder.record.interval_ns);
	TEST_ASSERT_EQUAL_DOUBLE(0.5, config->items[0].record.deadband);
	TEST_ASSERT_TRUE(config->items[0].record.raw);
}

static struct rio *rio;

static void edit(const char *name, const char *setting)
{
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, name, &setting, 1, &report));
}

static void test_an_edit_keeps_the_block_with_its_comments_and_makes_one_that_is_missing(void)
{
	static const char with[] = "OwsDrv {\n  Recorder {\n    # of the card\n    Keep 90 # days\n"
				   "    Record \"interval 5\"\n  }\n  ItemCount 0\n}\n";
	static const char without[] = "OwsDrv {\n  Timeout 10 # s\n}\n";
	const char *key = "Record";

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", with, strlen(with), &report, &rio));
	edit("Recorder", "Keep=30");
	edit("OwsDrv", "Timeout=5");
	TEST_ASSERT_EQUAL_INT(0, edit_unset(&rio, "Recorder", &key, 1, &report));
	TEST_ASSERT_EQUAL_STRING("OwsDrv {\n  Recorder {\n    # of the card\n    Keep 30 # days\n"
	                         "  }\n  ItemCount 0\n  Timeout                 5\n}\n",
	                         rio->text);
	rio_free(rio);
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", without, strlen(without), &report, &rio));
	edit("Recorder", "Flush=60");
	TEST_ASSERT_EQUAL_STRING("OwsDrv {\n  Timeout 10 # s\n  Recorder {\n"
	                         "    Flush                   60\n  }\n}\n",
	                         rio->text);
	rio_free(rio);
	TEST_ASSERT_EQUAL_STRING("", said);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_occasion_has_its_word);
	RUN_TEST(test_what_is_no_rule_is_refused_with_a_reason);
	RUN_TEST(test_a_file_without_the_block_has_its_defaults);
	RUN_TEST(test_the_block_is_read);
	RUN_TEST(test_an_item_without_a_rule_has_that_of_the_block);
	RUN_TEST(test_what_cannot_be_is_an_error_at_its_place);
	RUN_TEST(test_an_unknown_key_of_the_block_is_a_warning);
	RUN_TEST(test_an_edit_keeps_the_block_with_its_comments_and_makes_one_that_is_missing);
	RUN_TEST(test_what_is_printed_has_block_and_rules);
	return UNITY_END();
}
