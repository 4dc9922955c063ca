/* SPDX-License-Identifier: MIT */
/* Tests of the reader of a command's JSON. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/kit/body.h"

static struct body body;

void setUp(void)
{
}

void tearDown(void)
{
}

static int parse(const char *text)
{
	static char bytes[4096];
	size_t len = strlen(text);

	TEST_ASSERT_LESS_THAN_size_t(sizeof(bytes), len);
	memcpy(bytes, text, len);
	bytes[len] = 'x'; /* what stands behind it is no part of it */
	return body_parse(bytes, len, &body);
}

static void test_members_have_their_kinds_and_texts(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse(" { \"name\" : \"pump\", \"value\":-1.5e+3,\r\n\t\"a\":true,"
	                               "\"b\":false,\"c\":null}\n"));
	TEST_ASSERT_EQUAL_INT(5, (int)body.count);
	TEST_ASSERT_EQUAL_STRING("pump", body_string(&body, "name"));
	TEST_ASSERT_EQUAL_INT(BODY_NUMBER, body_find(&body, "value")->kind);
	TEST_ASSERT_EQUAL_STRING("-1.5e+3", body_find(&body, "value")->text);
	TEST_ASSERT_EQUAL_INT(BODY_TRUE, body_find(&body, "a")->kind);
	TEST_ASSERT_EQUAL_INT(BODY_FALSE, body_find(&body, "b")->kind);
	TEST_ASSERT_EQUAL_INT(BODY_NULL, body_find(&body, "c")->kind);
	TEST_ASSERT_NULL(body_find(&body, "d"));
	TEST_ASSERT_EQUAL_STRING("", body_string(&body, "value"));
	TEST_ASSERT_EQUAL_INT(0, parse("{}"));
	TEST_ASSERT_EQUAL_INT(0, (int)body.count);
}

static void test_escapes_become_the_characters_that_they_mean(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse("{\"a\":\"\\\"\\\\\\/\\b\\f\\n\\r\\t\\u0041\\u00e4\\u20AC"
	                               "\\ud83d\\uDE00\xc3\xa4\"}"));
	TEST_ASSERT_EQUAL_STRING("\"\\/\b\f\n\r\tA\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\xc3\xa4",
	                         body_string(&body, "a"));
}

static void test_what_is_no_flat_object_is_refused(void)
{
	static const char *const cases[] = {
		"",
		"[]",
		"1",
		"{",
		"{}x",
		"{,}",
		"{\"a\":1,}",
		"{\"a\" 1}",
		"{a:1}",
		"{'a':1}",
		"{\"a\":{}}",
		"{\"a\":[1]}",
		"{\"a\":01}",
		"{\"a\":+1}",
		"{\"a\":.5}",
		"{\"a\":1.}",
		"{\"a\":1e}",
		"{\"a\":0x1}",
		"{\"a\":NaN}",
		"{\"a\":tru}",
		"{\"a\":truex}",
		"{\"a\":1,\"a\":2}",
		"{\"a\":\"\n\"}",
		"{\"a\":\"\\x\"}",
		"{\"a\":\"\\u0000\"}",
		"{\"a\":\"\\u12\"}",
		"{\"a\":\"\\ud83d\"}",
		"{\"a\":\"\\ude00\"}",
		"{\"a\":\"\\ud83dx\"}",
		"{\"a\":\"\xff\"}",
		"{\"a\":\"\xc3\"}",
		"{\"a\":\"b}",
		"{\"a\":-}",
		"{\"a\":}",
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, parse(cases[i]), cases[i]);
}

static void test_strings_are_as_long_as_the_body(void)
{
	size_t len = 1 << 20;
	char *text = malloc(len + 32);
	int at = sprintf(text, "{\"a\":\"");

	memset(text + at, 'x', len);
	memcpy(text + at + len, "\",\"b\":7}", 8);
	TEST_ASSERT_EQUAL_INT(0, body_parse(text, (size_t)at + len + 8, &body));
	TEST_ASSERT_EQUAL_size_t(len, strlen(body_string(&body, "a")));
	TEST_ASSERT_EQUAL_STRING("7", body_find(&body, "b")->text);
	free(text);
}

static void test_too_many_members_are_refused(void)
{
	char text[BODY_MEMBERS * 8 + 16];
	size_t len = 0;

	for (int n = 0; n <= BODY_MEMBERS; n++)
		len += (size_t)sprintf(text + len, "%c\"%c\":1", n ? ',' : '{', 'a' + n);
	TEST_ASSERT_EQUAL_INT(-E2BIG, parse(strcat(text, "}")));
	text[len - strlen(",\"q\":1")] = '}';
	text[len - strlen(",\"q\":1") + 1] = '\0';
	TEST_ASSERT_EQUAL_INT(0, parse(text));
	TEST_ASSERT_EQUAL_INT(BODY_MEMBERS, (int)body.count);
}

static void test_no_beginning_of_a_body_is_read_past_its_end(void)
{
	static const char text[] =
		"{\"a\":\"\\ud83d\\ude00\xe2\x82\xac\",\"b\":-1.5e-3,\"c\":null}";

	for (size_t len = 0; len < sizeof(text) - 1; len++) {
		char *copy = malloc(len + 1);

		memcpy(copy, text, len);
		TEST_ASSERT_EQUAL_INT(-EINVAL, body_parse(copy, len, &body));
		free(copy);
	}
	TEST_ASSERT_EQUAL_INT(0, parse(text));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_members_have_their_kinds_and_texts);
	RUN_TEST(test_escapes_become_the_characters_that_they_mean);
	RUN_TEST(test_what_is_no_flat_object_is_refused);
	RUN_TEST(test_strings_are_as_long_as_the_body);
	RUN_TEST(test_too_many_members_are_refused);
	RUN_TEST(test_no_beginning_of_a_body_is_read_past_its_end);
	return UNITY_END();
}
