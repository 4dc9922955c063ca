/* SPDX-License-Identifier: MIT */
#include "src/printable.h"
#include "unity.h"

#include <string.h>

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
	TEST_ASSERT_EQUAL_STRING("?31m", made("\xc2\x9b""31m")); /* U+009B introduces too */
}

static void test_what_turns_the_direction_becomes_a_question_mark(void)
{
	TEST_ASSERT_EQUAL_STRING("a?b?c", made("a\xe2\x80\xae""b\xe2\x81\xa6""c"));
	TEST_ASSERT_EQUAL_STRING("??", made("\xe2\x80\xaa\xe2\x81\xa9"));
	TEST_ASSERT_EQUAL_STRING("\xe2\x80\xaf\xe2\x81\xaa", made("\xe2\x80\xaf\xe2\x81\xaa"));
}

static void test_a_character_cut_at_the_end_is_left_to_others(void)
{
	TEST_ASSERT_EQUAL_STRING("a\xe2\x80", made("a\xe2\x80"));
	TEST_ASSERT_EQUAL_STRING("a\xc2", made("a\xc2"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_harmless_stays);
	RUN_TEST(test_control_characters_become_question_marks);
	RUN_TEST(test_what_turns_the_direction_becomes_a_question_mark);
	RUN_TEST(test_a_character_cut_at_the_end_is_left_to_others);
	return UNITY_END();
}
