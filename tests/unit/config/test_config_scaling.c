/* SPDX-License-Identifier: MIT */
/* The keys of an item that say what its value means: how they are read, and what is wrong. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

#define ANALOG "Name x Path /a/b Type double "

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_an_item_without_the_keys_is_not_scaled(void)
{
	const struct config_item *item;

	TEST_ASSERT_EQUAL_INT(0, parse_item(ANALOG));
	item = &config->items[0];
	TEST_ASSERT_NULL(item->unit);
	TEST_ASSERT_NULL(item->description);
	TEST_ASSERT_NULL(item->calibrated);
	TEST_ASSERT_FALSE(item->has_decimals);
	TEST_ASSERT_FALSE(scale_changes(&item->scale));
	TEST_ASSERT_FALSE(item->scale.has_min || item->scale.has_max);
	TEST_ASSERT_EQUAL_DOUBLE(0, item->filter_s);
	TEST_ASSERT_EQUAL_DOUBLE(0, item->deadband);
	TEST_ASSERT_EQUAL_DOUBLE(0, item->max_step);
}

#define ALL_KEYS \
	"Unit \"m\xc2\xb3/h\" Decimals 2 Description \"Supply, \\\"cold\\\"\" Scale 0.5\n" \
	"Offset -3 Min -3 Max 1e3 MaxStep 1.5 Filter 2.5 Deadband 0.25 Calibrated \"2024-02-29\"\n" \
	"Group \"Ground floor\""

static void expect_all_keys(const struct config_item *item)
{
	TEST_ASSERT_EQUAL_STRING("m\xc2\xb3/h", item->unit);
	TEST_ASSERT_EQUAL_UINT(2, item->decimals);
	TEST_ASSERT_EQUAL_STRING("Supply, \"cold\"", item->description);
	TEST_ASSERT_EQUAL_STRING("Ground floor", item->group);
	TEST_ASSERT_TRUE(item->scale.linear);
	TEST_ASSERT_EQUAL_DOUBLE(0.5, item->scale.factor);
	TEST_ASSERT_EQUAL_DOUBLE(-3, item->scale.offset);
	TEST_ASSERT_TRUE(item->scale.has_min && item->scale.has_max);
	TEST_ASSERT_EQUAL_DOUBLE(-3, item->scale.min);
	TEST_ASSERT_EQUAL_DOUBLE(1000, item->scale.max);
	TEST_ASSERT_EQUAL_DOUBLE(1.5, item->max_step);
	TEST_ASSERT_EQUAL_DOUBLE(2.5, item->filter_s);
	TEST_ASSERT_EQUAL_DOUBLE(0.25, item->deadband);
	TEST_ASSERT_EQUAL_STRING("2024-02-29", item->calibrated);
}

static void test_all_keys_are_read_and_printed(void)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out;

	TEST_ASSERT_EQUAL_INT(0, parse_item(ANALOG ALL_KEYS));
	expect_all_keys(&config->items[0]);
	out = open_memstream(&text, &size);
	TEST_ASSERT_NOT_NULL(out);
	config_print(config, out);
	fclose(out);
	config_case_end();
	config_case_begin();
	TEST_ASSERT_EQUAL_INT(0, parse(text));
	expect_all_keys(&config->items[0]);
	free(text);
}

static void test_points_are_read_and_kept_as_written(void)
{
	const struct scale *scale;

	TEST_ASSERT_EQUAL_INT(0, parse_item(ANALOG "Points \" 4:0  12:50.5 20:100\" Unit \"\""));
	scale = &config->items[0].scale;
	TEST_ASSERT_EQUAL_STRING(" 4:0  12:50.5 20:100", config->items[0].points);
	TEST_ASSERT_EQUAL_UINT(3, scale->count);
	TEST_ASSERT_EQUAL_DOUBLE(12, scale->points[1].raw);
	TEST_ASSERT_EQUAL_DOUBLE(50.5, scale->points[1].value);
	TEST_ASSERT_FALSE(scale->linear);
	TEST_ASSERT_EQUAL_STRING("", config->items[0].unit);
}

/* And so it is printed, and read again. */
static void expect_unit(const char *keys, const char *unit, double factor, double offset)
{
	const struct config_item *item;
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);

	TEST_ASSERT_NOT_NULL(out);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse_item(keys), keys);
	config_print(config, out);
	fclose(out);
	for (int again = 0; again < 2; again++) {
		item = &config->items[0];
		TEST_ASSERT_EQUAL_STRING_MESSAGE(unit, item->unit, keys);
		TEST_ASSERT_EQUAL_MESSAGE(factor != 1 || offset != 0, item->scale.linear, keys);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-9, factor, item->scale.factor, keys);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-9, offset, item->scale.offset, keys);
		config_case_end();
		config_case_begin();
		TEST_ASSERT_EQUAL_INT(0, parse(text));
	}
	config_case_end();
	config_case_begin();
	free(text);
}

static void test_a_unit_of_the_same_quantity_converts(void)
{
#define THERMOMETER "Name x Path /28.551DDF030000/temperature Type double "
#define SENSOR "Name x Path /7E.551DDF030000/EDS0068/pressure Type double "
	expect_unit(THERMOMETER "Unit F", "°F", 1.8, 32);
	expect_unit(THERMOMETER "Unit K", "K", 1, 273.15);
	expect_unit(THERMOMETER "Unit Cel", "°C", 1, 0);
	expect_unit(THERMOMETER "Unit V", "V", 1, 0);
	expect_unit(THERMOMETER "Unit \"\"", "", 1, 0);
	expect_unit(THERMOMETER "Unit F Scale 2", "F", 2, 0);
	expect_unit(THERMOMETER "Unit F Scale 1.8 Offset 32", "F", 1.8, 32);
	expect_unit("Name x Path /room/temperature Type float Unit °F", "°F", 1.8, 32);
	expect_unit("Name x Path /28.551DDF030000/temperature Type string Unit F", "F", 1, 0);
	expect_unit(SENSOR "Unit hPa", "hPa", 1, 0);
	expect_unit(SENSOR "Unit kPa", "kPa", 0.1, 0);
	expect_unit("Name x Path /26.551DDF030000/VDD Type double Unit mV", "mV", 1000, 0);
	expect_unit("Name x Path /1D.551DDF030000/counter.A Type dword Unit m3", "m3", 1, 0);
	expect_unit("Name x Path /26.551DDF030000/tempoffset Type double Unit °F", "°F", 1.8, 0);
}

static void test_a_command_is_given_in_the_unit(void)
{
	double raw;

	TEST_ASSERT_EQUAL_INT(0, parse_item("Name x Path /28.551DDF030000/temphigh Type double IO "
	                                    "output Unit °F InitValue 70 Max 212"));
	TEST_ASSERT_EQUAL_INT(0, scale_raw(&config->items[0].scale, 70, &raw));
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 21.0 + 1 / 9.0, raw);
	TEST_ASSERT_EQUAL_INT(-ERANGE, scale_raw(&config->items[0].scale, 213, &raw));
}

static void test_a_scale_that_changes_nothing_is_none(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ANALOG "Scale 1 Offset 0"));
	TEST_ASSERT_FALSE(scale_changes(&config->items[0].scale));
}

static void test_wrong_keys_are_errors_that_say_what_to_write(void)
{
	static const struct line cases[] = {
		{ANALOG "Unit \"12345678901234567\"",
	         "f:3:35: error: Unit \"12345678901234567\": expected at most 16 bytes\n"},
		{ANALOG "Unit \"\xb0"
	                "C\"",
	         "f:3:35: error: Unit \"?C\": expected UTF-8: convert the file, as with iconv -f "
	         "cp1250 -t utf-8\n"},
		{ANALOG "Unit \"a\tb\"",
	         "f:3:35: error: Unit \"a?b\": expected no control character\n"},
		{ANALOG "Description \"a\xe2\x80\xae"
	                "b\"",
	         "f:3:42: error: Description \"a?b\": expected no control character\n"},
		{ANALOG "Decimals 16",
	         "f:3:39: error: Decimals \"16\": expected a whole number from 0 to 15\n"},
		{ANALOG "Scale 0", "f:3:36: error: Scale \"0\": expected a number other than 0\n"},
		{ANALOG "Scale wide", "f:3:36: error: Scale \"wide\": expected a number\n"},
		{ANALOG "Scale 2\nPoints \"4:0 20:100\"",
	         "f:4:1: error: Points contradicts Scale in line 3: expected one of the two\n"},
		{ANALOG "Offset 2\nPoints \"4:0 20:100\"",
	         "f:4:1: error: Points contradicts Offset in line 3: expected one of the two\n"},
		{ANALOG "Points \"4 20\"",
	         "f:3:37: error: Points \"4 20\": expected points RAW:VALUE with blanks between, "
	         "such as \"4:0 20:100\"\n"},
		{ANALOG "Points \"4:0\"",
	         "f:3:37: error: Points \"4:0\": expected two points at least, such as \"4:0 "
	         "20:100\"\n"},
		{ANALOG "Points \"4:0 4:1\"",
	         "f:3:37: error: Points \"4:0 4:1\": expected raw values that rise from point to "
	         "point\n"},
		{ANALOG "Points \"4:0 5:1 6:0\"",
	         "f:3:37: error: Points \"4:0 5:1 6:0\": expected values that all rise or all "
	         "fall: else a value has no single raw value\n"},
		{ANALOG "Min 5\nMax 5",
	         "f:4:5: error: Max \"5\": expected more than Min, which is 5 in line 3\n"},
		{ANALOG "Filter -1",
	         "f:3:37: error: Filter \"-1\": expected seconds from 0 to 86400\n"},
		{ANALOG "MaxStep -1",
	         "f:3:38: error: MaxStep \"-1\": expected a number, not negative\n"},
		{ANALOG "MaxStep inf",
	         "f:3:38: error: MaxStep \"inf\": expected a number, not negative\n"},
		{"Name x Path /a/b Type string MaxStep 3",
	         "f:3:30: error: MaxStep: a string has none; remove it, or write a Type of "
	         "numbers\n"},
		{"Name x Path /a/b Type bool MaxStep 3",
	         "f:3:28: error: MaxStep: a bool has none; remove it, or write a Type of "
	         "numbers\n"},
		{ANALOG "Deadband -1",
	         "f:3:39: error: Deadband \"-1\": expected a number, not negative\n"},
		{ANALOG "Calibrated \"2023-02-29\"",
	         "f:3:41: error: Calibrated \"2023-02-29\": expected a date such as "
	         "\"2026-11-22\"\n"},
		{ANALOG "Calibrated \"22.11.2026\"",
	         "f:3:41: error: Calibrated \"22.11.2026\": expected a date such as "
	         "\"2026-11-22\"\n"},
		{ANALOG "Min 0 InitValue -1",
	         "f:3:46: error: InitValue \"-1\": expected a value from Min to Max, and of the "
	         "Points\n"},
		{ANALOG "IO output Points \"0:0 1:5\" SafeValue 6",
	         "f:3:67: error: SafeValue \"6\": expected a value from Min to Max, and of the "
	         "Points\n"},
		{"Name x Path /a/b Type string Min 3",
	         "f:3:30: error: Min: a string has none; remove it, or write a Type of numbers\n"},
		{"Name x Path /a/b Type bool Decimals 3",
	         "f:3:28: error: Decimals: a bool has none; remove it, or write a Type of "
	         "numbers\n"},
		{"Name x Path /a/b Type bool Scale 2",
	         "f:3:28: error: a bool can only be inverted: expected Scale -1 and Offset 1\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_a_text_and_a_bool_have_what_makes_sense(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item("Name x Path /a/b Type string Description d Unit u "
	                                    "Calibrated 2000-02-29"));
	config_case_end();
	config_case_begin();
	TEST_ASSERT_EQUAL_INT(
		0, parse_item("Name x Path /a/b Type bool Scale -1 Offset 1 InitValue on"));
	TEST_ASSERT_TRUE(config->items[0].scale.linear);
}

static void test_what_does_nothing_is_warned_of(void)
{
	static const struct line cases[] = {
		{ANALOG "IO output Filter 3",
	         "f:3:40: warning: Filter does nothing: this Item is an output\n"},
		{ANALOG "IO output MaxStep 3",
	         "f:3:40: warning: MaxStep does nothing: this Item is an output\n"},
	};

	expect_warnings(cases, COUNT(cases), parse_item);
}

static void test_a_scaled_integer_of_a_property_with_decimals_is_no_mistake(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item("Name x Path /20.000000000001/volt.A Type byte "
	                                    "Points \"0:0 5:100\""));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_item_without_the_keys_is_not_scaled);
	RUN_TEST(test_all_keys_are_read_and_printed);
	RUN_TEST(test_points_are_read_and_kept_as_written);
	RUN_TEST(test_a_unit_of_the_same_quantity_converts);
	RUN_TEST(test_a_command_is_given_in_the_unit);
	RUN_TEST(test_a_scale_that_changes_nothing_is_none);
	RUN_TEST(test_wrong_keys_are_errors_that_say_what_to_write);
	RUN_TEST(test_a_text_and_a_bool_have_what_makes_sense);
	RUN_TEST(test_what_does_nothing_is_warned_of);
	RUN_TEST(test_a_scaled_integer_of_a_property_with_decimals_is_no_mistake);
	return UNITY_END();
}
