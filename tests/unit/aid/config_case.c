/* SPDX-License-Identifier: MIT */
/* Parses configurations from texts, and compares the messages about them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/config/check/know.h"
#include "src/config/check/targets.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

struct config *config;

void config_case_begin(void)
{
	config_free(config);
	config = NULL;
	said_begin();
}

void config_case_end(void)
{
	config_case_begin();
}

int parse(const char *text)
{
	config_case_begin();
	if (config_parse("f", text, strlen(text), &report, &config))
		return -EINVAL;
	for (unsigned i = 0; i < config->item_count; i++)
		know_item(&config->items[i], config->file, &report);
	if (config_check_targets(config, &report) == 0)
		return 0;
	config_free(config);
	config = NULL;
	return -EINVAL;
}

int parse_driver(const char *keys)
{
	char text[4096];

	snprintf(text, sizeof(text), "OwsDrv {\n%s\n}\n", keys);
	return parse(text);
}

int parse_item(const char *keys)
{
	char text[2048];

	snprintf(text, sizeof(text), "Item {\n%s\n}", keys);
	return parse_driver(text);
}

void expect_errors(const struct line *cases, size_t count, int (*by)(const char *))
{
	for (size_t i = 0; i < count; i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, by(cases[i].keys), cases[i].keys);
		TEST_ASSERT_NULL_MESSAGE(config, cases[i].keys);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].said, said, cases[i].keys);
	}
}

void expect_warnings(const struct line *cases, size_t count, int (*by)(const char *))
{
	for (size_t i = 0; i < count; i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, by(cases[i].keys), said);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].said, said, cases[i].keys);
	}
}
