/* SPDX-License-Identifier: MIT */
/* Tests of text made fit for a terminal. */
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/printable.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static const char *made(const char *from)
{
	static char text[128];
	size_t len = strlen(from);

	memcpy(text, from, len + 1);
	len = printable(text, len);
	text[len] = '\0';
	return text;
}

static void test_what_is_harmless_stays(void)
{
	TEST_ASSERT_EQUAL_STRING("", made(""));
	TEST_ASSERT_EQUAL_STRING("plain ~", made("plain ~"));
	TEST_ASSERT_EQUAL_STRING("21 °C, č, 温度, 🌡", made("21 °C, č, 温度, 🌡"));
}

static void test_control_characters_become_question_marks(void)
{
	TEST_ASSERT_EQUAL_STRING("a?[31mb?", made("a\x1b[31mb\x7f"));
	TEST_ASSERT_EQUAL_STRING("a?b?c", made("a\nb\tc"));
	TEST_ASSERT_EQUAL_STRING("?31m", made("\xc2\x9b"
	                                      "31m")); /* U+009B introduces too */
}

static void test_what_turns_the_direction_becomes_a_question_mark(void)
{
	TEST_ASSERT_EQUAL_STRING("a?b?c", made("a\xe2\x80\xae"
	                                       "b\xe2\x81\xa6"
	                                       "c"));
	TEST_ASSERT_EQUAL_STRING("??", made("\xe2\x80\xaa\xe2\x81\xa9"));
	TEST_ASSERT_EQUAL_STRING("\xe2\x80\xaf\xe2\x81\xaa", made("\xe2\x80\xaf\xe2\x81\xaa"));
}

/* Of Windows-1250, or of a terminal's eight-bit commands */
static void test_bytes_that_are_not_utf8_become_question_marks(void)
{
	TEST_ASSERT_EQUAL_STRING("?31m", made("\x9b"
	                                      "31m"));
	TEST_ASSERT_EQUAL_STRING("venkovn?", made("venkovn\xed"));
	TEST_ASSERT_EQUAL_STRING("??x", made("\xc0\x80x"));
	TEST_ASSERT_EQUAL_STRING("a??", made("a\xe2\x80"));
	TEST_ASSERT_EQUAL_STRING("a?", made("a\xc2"));
}

static void test_a_text_is_cut_between_characters(void)
{
	static const char text[] = "a\xc2\xb0\xe2\x82\xac\xf0\x9f\x8c\xa1";
	static const size_t lengths[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};

	for (size_t most = 0; most < sizeof(lengths) / sizeof(lengths[0]); most++)
		TEST_ASSERT_EQUAL_UINT(lengths[most], printable_cut(text, most));
}

__attribute__((format(printf, 1, 2))) static char *line(const char *format, ...)
{
	va_list args;
	char *text;

	va_start(args, format);
	text = printable_line(format, args);
	va_end(args);
	TEST_ASSERT_NOT_NULL(text);
	return text;
}

static void test_a_long_message_loses_its_middle_and_keeps_its_reason(void)
{
	static const char *const characters[] = {"x", "\xc4\x8d", "\xe6\xb8\xa9",
	                                         "\xf0\x9f\x8c\xa1"};
	char word[8001], *text = line("%s is %d\n", "short", 5);

	TEST_ASSERT_EQUAL_STRING("short is 5?", text);
	free(text);
	for (size_t i = 0; i < 4; i++) {
		size_t len = strlen(characters[i]);

		word[0] = '\0';
		for (size_t k = 0; k < 8000 / len; k++)
			memcpy(word + k * len, characters[i], len + 1);
		text = line("the word '%s' is wrong", word);
		TEST_ASSERT_LESS_OR_EQUAL_size_t(PRINTABLE_LINE, strlen(text));
		TEST_ASSERT_GREATER_THAN_size_t(PRINTABLE_LINE - 10, strlen(text));
		TEST_ASSERT_EQUAL_STRING_LEN("the word '", text, 10);
		TEST_ASSERT_EQUAL_STRING("' is wrong", text + strlen(text) - 10);
		/* whole characters on both sides of the gap */
		for (char *p = text + 10, *end = text + strlen(text) - 10; p < end; p += len)
			if (strncmp(p, " ... ", 5) == 0)
				p += 5 - len;
			else
				TEST_ASSERT_EQUAL_MEMORY(characters[i], p, len);
		free(text);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_harmless_stays);
	RUN_TEST(test_control_characters_become_question_marks);
	RUN_TEST(test_what_turns_the_direction_becomes_a_question_mark);
	RUN_TEST(test_bytes_that_are_not_utf8_become_question_marks);
	RUN_TEST(test_a_text_is_cut_between_characters);
	RUN_TEST(test_a_long_message_loses_its_middle_and_keeps_its_reason);
	return UNITY_END();
}
