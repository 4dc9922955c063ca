/* SPDX-License-Identifier: MIT */
/* The table of keys, and the manual page that has to say the same. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/load.h"
#include "src/config/read/options.h"
#include "src/config/read/rio_file.h"
#include "tests/unit/aid/said.h"

#define MANUAL "docs/owsd.rio.5"
#define KEY "\n.TP\n\\fB" /* before each key */

static char *manual;
static struct config *config;

void setUp(void)
{
	size_t len;

	said_must_not_begin();
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, rio_read(MANUAL, &report, &manual, &len));
}

void tearDown(void)
{
	config_free(config);
	free(manual);
	manual = NULL;
}

/* The section of the keys of a place, which ends before *end. */
static const char *keys_of(enum option_place place, const char **end)
{
	char mark[40];
	const char *begin;

	snprintf(mark, sizeof(mark), "\n.SH %s KEYS\n",
	         place == PLACE_DRIVER ? "Driver" : option_place_name(place));
	for (char *at = mark + strlen("\n.SH "); *at; at++)
		*at = (char)toupper((unsigned char)*at);
	begin = strstr(manual, mark);
	TEST_ASSERT_NOT_NULL_MESSAGE(begin, mark);
	*end = strstr(begin + 1, "\n.SH ");
	TEST_ASSERT_NOT_NULL_MESSAGE(*end, mark);
	return begin;
}

/* The paragraph of a key, up to the next key or section; copied into section. */
static void find_section(const struct option_def *def, char *section, size_t size)
{
	char mark[96];
	const char *begin, *end, *other, *last;

	snprintf(mark, sizeof(mark), KEY "%s\\fR\n", def->key);
	begin = strstr(keys_of(def->place, &last), mark);
	TEST_ASSERT_TRUE_MESSAGE(begin && begin < last, def->key);
	begin += strlen(mark);
	end = strstr(begin, KEY);
	other = strstr(begin, "\n.S");
	if (!end || other < end)
		end = other;
	TEST_ASSERT_NOT_NULL_MESSAGE(end, def->key);
	snprintf(section, size, "%.*s", (int)(end - begin), begin);
}

static bool has_number(const char *text, double number)
{
	while (*text) {
		char *end;
		double found = strtod(text, &end);

		if (end != text && found == number)
			return true;
		text = end != text ? end : text + 1;
	}
	return false;
}

static void test_every_key_has_a_place_a_kind_and_help(void)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		TEST_ASSERT_NOT_NULL(def->key);
		TEST_ASSERT_NOT_NULL_MESSAGE(def->help, def->key);
		TEST_ASSERT_TRUE_MESSAGE(strlen(def->key) <= RIO_KEY_MAX, def->key);
		TEST_ASSERT_EQUAL_INT_MESSAGE(i, option_find(def->place, def->key), def->key);
		if (def->kind == OPTION_COUNT || def->kind == OPTION_SECONDS)
			TEST_ASSERT_TRUE_MESSAGE(def->least < def->most, def->key);
	}
	TEST_ASSERT_EQUAL_INT(-1, option_find(PLACE_DRIVER, "Name"));
	TEST_ASSERT_EQUAL_INT(-1, option_find(PLACE_ITEM, "name"));
}

static void test_the_nearest_key_is_near(void)
{
	static const struct {
		enum option_place place;
		const char *key, *nearest;
	} cases[] = {
		{PLACE_DRIVER, "timeout", "Timeout"},
		{PLACE_DRIVER, "MaxRetrys", "MaxRetries"},
		{PLACE_ITEM, "PerFaktor", "PerFactor"},
		{PLACE_ITEM, "Readible", "Readable"},
		{PLACE_ITEM, "LimitHi", "LimitHH or LimitH"},
		{PLACE_ITEM, "Limit", "LimitH or LimitL"},
		{PLACE_ITEM, "limith", "LimitH"},
		{PLACE_ITEM, "Elephant", NULL},
		{PLACE_DRIVER, "Name", NULL},
	};
	char text[OPTION_NEAREST];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const char *nearest = option_nearest(cases[i].place, cases[i].key, text);

		if (cases[i].nearest)
			TEST_ASSERT_EQUAL_STRING(cases[i].nearest, nearest);
		else
			TEST_ASSERT_NULL_MESSAGE(nearest, cases[i].key);
	}
}

static void test_the_manual_has_every_key_with_default_and_limits(void)
{
	char section[2048];

	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		find_section(def, section, sizeof(section));
		if (def->preset && *def->preset)
			TEST_ASSERT_NOT_NULL_MESSAGE(strstr(section, def->preset), def->key);
		if ((def->kind == OPTION_COUNT && i != OPT_IO_TYPE && i != OPT_ITEM_COUNT) ||
		    def->kind == OPTION_SECONDS) {
			TEST_ASSERT_TRUE_MESSAGE(has_number(section, def->least), def->key);
			TEST_ASSERT_TRUE_MESSAGE(has_number(section, def->most), def->key);
		}
	}
}

static void test_each_key_of_the_manual_is_a_row(void)
{
	for (int place = PLACE_DRIVER; place < PLACE_COUNT; place++) {
		const char *end, *at = keys_of((enum option_place)place, &end);
		char key[64];

		while ((at = strstr(at, KEY)) && at < end) {
			at += strlen(KEY);
			snprintf(key, sizeof(key), "%.*s", (int)strcspn(at, "\\"), at);
			TEST_ASSERT_TRUE_MESSAGE(option_find((enum option_place)place, key) >= 0,
			                         key);
		}
	}
}

static void test_the_example_of_the_manual_is_a_configuration(void)
{
	const char *begin = strstr(manual, "\nOwsDrv {\n"), *end = strstr(manual, "\n.EE");

	TEST_ASSERT_TRUE(begin && end && begin < end);
	TEST_ASSERT_EQUAL_INT(0,
	                      config_parse(MANUAL, begin, (size_t)(end - begin), &report, &config));
	TEST_ASSERT_EQUAL_UINT(2, config->item_count);
	TEST_ASSERT_TRUE(config->items[1].has_safe);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_key_has_a_place_a_kind_and_help);
	RUN_TEST(test_the_nearest_key_is_near);
	RUN_TEST(test_the_manual_has_every_key_with_default_and_limits);
	RUN_TEST(test_each_key_of_the_manual_is_a_row);
	RUN_TEST(test_the_example_of_the_manual_is_a_configuration);
	return UNITY_END();
}
