/* SPDX-License-Identifier: MIT */
/* Tests of the reader of the writer's answers. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/web/writer.h"

static struct writer_answer answer;

void setUp(void)
{
	memset(&answer, 0, sizeof(answer));
}

void tearDown(void)
{
	problems_free(&answer.problems);
}

static int parse(const char *text, size_t len)
{
	char *copy = malloc(len + 1);
	int err;

	problems_free(&answer.problems);
	memcpy(copy, text, len);
	copy[len] = '\0';
	err = writer_parse(copy, len, &answer);
	free(copy);
	return err;
}

#define TAG "0123456789abcdef"
static const char whole[] = "status: invalid\ntag: " TAG "\nreload: done\n"
			    "backup: " TAG " 1764000000123\nwhy: it: is\nof-later: 1\n"
			    "problem: E 12 3 a word\nproblem: W 0 0 \n\n";

static void test_an_answer_is_read(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse(whole, strlen(whole)));
	TEST_ASSERT_EQUAL_INT(WRITER_INVALID, answer.status);
	TEST_ASSERT_EQUAL_STRING(TAG, answer.tag);
	TEST_ASSERT_EQUAL_STRING(TAG, answer.backup);
	TEST_ASSERT_EQUAL_INT64(1764000000123, answer.backup_ms);
	TEST_ASSERT_EQUAL_STRING("done", answer.reload);
	TEST_ASSERT_EQUAL_STRING("it: is", answer.why);
	TEST_ASSERT_EQUAL_UINT(2, answer.problems.count);
	TEST_ASSERT_TRUE(answer.problems.list[0].error);
	TEST_ASSERT_EQUAL_INT(12, answer.problems.list[0].line);
	TEST_ASSERT_EQUAL_STRING("a word", answer.problems.list[0].text);
	TEST_ASSERT_EQUAL_STRING("", answer.problems.list[1].text);
}

static void test_only_a_whole_answer_counts(void)
{
	for (size_t len = 0; len < strlen(whole); len++)
		TEST_ASSERT_EQUAL_INT(-EPROTO, parse(whole, len));
}

static void test_what_is_no_answer_is_refused(void)
{
	static const char *const cases[] = {
		"\n",
		"status: perhaps\n\n",
		"tag: " TAG "\n\n",
		"status: done\ntag: x\n\n",
		"status: done\nbackup: " TAG "\n\n",
		"status: done\nbackup: x 1\n\n",
		"status: done\nproblem: X 1 1 a\n\n",
		"status: done\nproblem: E 1\n\n",
		"status: done\nproblem: E -1 1 a\n\n",
		"status: done\nproblem: E 1 1x a\n\n",
		"status: done\nproblem: E 1 99999999999 a\n\n",
		"status: done\nbackup: " TAG " 1x\n\n",
		"status: done\nbackup: " TAG " 99999999999999999999\n\n",
		"status: done\nno colon\n\n",
		"status: done\n\nmore",
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EPROTO, parse(cases[i], strlen(cases[i])), cases[i]);
	TEST_ASSERT_EQUAL_INT(-EPROTO, parse("status: done\n\0\n", 15));
}

static void test_a_tag_has_sixteen_digits_or_none(void)
{
	TEST_ASSERT_TRUE(writer_is_tag("") && writer_is_tag(TAG));
	TEST_ASSERT_FALSE(writer_is_tag("0") || writer_is_tag("0123456789abcdeF") ||
	                  writer_is_tag(TAG "0") || writer_is_tag("0123456789abcde\n"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_answer_is_read);
	RUN_TEST(test_only_a_whole_answer_counts);
	RUN_TEST(test_what_is_no_answer_is_refused);
	RUN_TEST(test_a_tag_has_sixteen_digits_or_none);
	return UNITY_END();
}
