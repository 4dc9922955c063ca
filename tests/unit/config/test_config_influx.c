/* SPDX-License-Identifier: MIT */
/* Tests of the Influx block. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

#define URL "Url \"http://127.0.0.1:8428/write\" "

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_a_file_without_the_block_pushes_nothing(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM));
	TEST_ASSERT_FALSE(config->influx.given);
	TEST_ASSERT_NULL(config->influx.url);
}

static void test_the_block_has_defaults_but_for_the_server(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Influx { " URL "}"));
	TEST_ASSERT_TRUE(config->influx.given);
	TEST_ASSERT_EQUAL_STRING("http://127.0.0.1:8428/write", config->influx.url);
	TEST_ASSERT_EQUAL_INT64(10000000000, config->influx.every_ns);
	TEST_ASSERT_EQUAL_STRING("ows", config->influx.measurement);
	TEST_ASSERT_NULL(config->influx.token_file);
	TEST_ASSERT_EQUAL_INT64(600000000000, config->influx.clock_wait_ns);
}

static void test_what_is_printed_is_what_was_read(void)
{
	size_t len;
	char *text;
	FILE *out = open_memstream(&text, &len);

	TEST_ASSERT_NOT_NULL(out);
	TEST_ASSERT_EQUAL_INT(
		0, parse_driver("Influx { Url \"https://[::1]/api/v2/write?org=a&precision=ns\"\n"
	                        "Every 2.5 TokenFile \"token\" Measurement \"house.1\"\n"
	                        "ClockWait 0 }"));
	config_print(config, out);
	TEST_ASSERT_EQUAL_INT(0, fclose(out));
	config_free(config);
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, parse(text));
	free(text);
	TEST_ASSERT_EQUAL_STRING("https://[::1]/api/v2/write?org=a&precision=ns",
	                         config->influx.url);
	TEST_ASSERT_EQUAL_INT64(2500000000, config->influx.every_ns);
	TEST_ASSERT_EQUAL_STRING("token", config->influx.token_file);
	TEST_ASSERT_EQUAL_STRING("house.1", config->influx.measurement);
	TEST_ASSERT_EQUAL_INT64(0, config->influx.clock_wait_ns);
}

static void test_what_cannot_be_is_an_error_at_its_place(void)
{
	static const struct line blocks[] = {
		{"Influx { }", "f:2:1: error: Influx without Url: write it, as Url "
	                       "\"http://127.0.0.1:8428/write\"\n"},
		{"Influx { Url \"localhost:8428\" }",
	         "f:2:14: error: Url \"localhost:8428\": expected http://HOST:PORT/PATH or "
	         "https://..., at most 255 bytes\n"},
		{"Influx { Url \"http:///write\" }",
	         "f:2:14: error: Url \"http:///write\": expected http://HOST:PORT/PATH or "
	         "https://..., at most 255 bytes\n"},
		{"Influx { Url \"http://h/a b\" }",
	         "f:2:14: error: Url \"http://h/a b\": expected no blank and no special letter: "
	         "write it as %20\n"},
		{"Influx { Url \"http://u:p@h/\" }",
	         "f:2:14: error: Url: no password stands in a Url: put "
	         "USER:PASSWORD into the file of TokenFile\n"},
		{"Influx { Url \"http://h/?u=a&p=b\" }",
	         "f:2:14: error: Url: no password stands in a Url: put "
	         "USER:PASSWORD into the file of TokenFile\n"},
		{"Influx { Url \"http://h/?precision=ms\" }",
	         "f:2:14: error: Url: the times are in nanoseconds: "
	         "leave precision out\n"},
		{"Influx { " URL "Every 0 }",
	         "f:2:50: error: Every \"0\": expected seconds from 0.1 to 3600\n"},
		{"Influx { " URL "TokenFile \"../t\" }",
	         "f:2:54: error: TokenFile \"../t\": expected a path from the root, or the name of "
	         "a credential\n"},
		{"Influx { " URL "Measurement \"a b\" }",
	         "f:2:56: error: Measurement \"a b\": expected letters, digits, '-', '_' and '.', "
	         "at most 63\n"},
		{"Influx { " URL "ClockWait -1 }",
	         "f:2:54: error: ClockWait \"-1\": expected seconds from 0 to 86400\n"},
	};

	expect_errors(blocks, COUNT(blocks), parse_driver);
}

static void test_an_edit_makes_the_block(void)
{
	static const char without[] = "OwsDrv {\n  Timeout 10 # s\n}\n";
	const char *const settings[] = {"Url=http://h/write", "Every=5"};
	struct rio *rio;

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", without, strlen(without), &report, &rio));
	TEST_ASSERT_EQUAL_INT(0, edit_set(&rio, "Influx", settings, 2, &report));
	TEST_ASSERT_EQUAL_STRING("OwsDrv {\n  Timeout 10 # s\n  Influx {\n"
	                         "    Url                     \"http://h/write\"\n"
	                         "    Every                   5\n  }\n}\n",
	                         rio->text);
	rio_free(rio);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_file_without_the_block_pushes_nothing);
	RUN_TEST(test_the_block_has_defaults_but_for_the_server);
	RUN_TEST(test_what_is_printed_is_what_was_read);
	RUN_TEST(test_what_cannot_be_is_an_error_at_its_place);
	RUN_TEST(test_an_edit_makes_the_block);
	return UNITY_END();
}
