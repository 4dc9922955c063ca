/* SPDX-License-Identifier: MIT */
/* Entries of the journals as JSON, for a browser and for programs. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/journal_entry.h"

#define ROUNDED INT64_C(9007199254740993) /* a double has ...992 and ...994 */

static char *text;

void setUp(void)
{
}

void tearDown(void)
{
	free(text);
	text = NULL;
}

static void holds(const struct journal_entry *entry, bool browser, const char *part)
{
	static const struct when now = {.boot = 1000, .wall = 2000};
	struct json json;
	size_t len;

	free(text);
	json_open(&json, open_memstream(&text, &len));
	TEST_ASSERT_NOT_NULL(json.out);
	journal_json(&json, &now, entry, browser);
	fclose(json.out);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, part), text);
}

static void test_a_command_that_a_browser_would_round_is_a_text_for_it_alone(void)
{
	struct journal_entry entry = {
		.when_ns = 500,
		.name = "meter",
		.is_command = true,
		.this_boot = true,
		.command = {.type = OWS_LARGE, .reason = OWS_REASON_SET, .integer = ROUNDED},
	};

	holds(&entry, true, "\"value\":\"9007199254740993\",");
	holds(&entry, false, "\"value\":9007199254740993,");
	entry.command.integer = INT64_MIN;
	holds(&entry, true, "\"value\":\"-9223372036854775808\",");
	entry.command.integer = ROUNDED - 2;
	holds(&entry, true, "\"value\":9007199254740991,");
}

static void test_values_before_and_after_an_alarm_are_exact_too(void)
{
	const struct journal_entry entry = {
		.when_ns = 500,
		.name = "meter",
		.this_boot = true,
		.alarm = {.type = OWS_LARGE,
	                  .has_before = 1,
	                  .has_after = 1,
	                  .before_integer = 7,
	                  .after_integer = ROUNDED,
	                  .kind = OWS_ALARM_H,
	                  .event = OWS_ALARM_RAISED},
	};

	holds(&entry, true,
	      "\"value\":\"9007199254740993\",\"before\":7,\"after\":\"9007199254740993\",");
	holds(&entry, false, "\"value\":9007199254740993,\"before\":7,\"after\":9007199254740993,");
}

/* Its text is that of the nearest double, which a browser has. */
static void test_a_double_is_a_number_however_large(void)
{
	const struct journal_entry entry = {
		.when_ns = 500,
		.name = "room",
		.is_command = true,
		.this_boot = true,
		.command = {.type = OWS_DOUBLE, .reason = OWS_REASON_SET, .number = 0x1p60},
	};

	holds(&entry, true, "\"value\":1");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_command_that_a_browser_would_round_is_a_text_for_it_alone);
	RUN_TEST(test_values_before_and_after_an_alarm_are_exact_too);
	RUN_TEST(test_a_double_is_a_number_however_large);
	return UNITY_END();
}
