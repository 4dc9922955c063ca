/* SPDX-License-Identifier: MIT */
/* Tests of texts cut to columns of the terminal. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/text.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static char out[256];

static unsigned clean(const char *text, unsigned columns)
{
	return text_clean(text, strlen(text), columns, out, sizeof(out));
}

static void test_text_that_fits_stays(void)
{
	TEST_ASSERT_EQUAL(5, clean("room1", 5));
	TEST_ASSERT_EQUAL_STRING("room1", out);
	TEST_ASSERT_EQUAL(0, clean("", 0));
	TEST_ASSERT_EQUAL_STRING("", out);
}

static void test_text_that_does_not_fit_ends_in_a_tilde(void)
{
	TEST_ASSERT_EQUAL(4, clean("room1", 4));
	TEST_ASSERT_EQUAL_STRING("roo~", out);
	TEST_ASSERT_EQUAL(1, clean("room1", 1));
	TEST_ASSERT_EQUAL_STRING("~", out);
	TEST_ASSERT_EQUAL(0, clean("room1", 0));
	TEST_ASSERT_EQUAL_STRING("", out);
}

static void test_columns_are_not_bytes(void)
{
	TEST_ASSERT_EQUAL(5, clean("K\xc3\xa4lte", 5));
	TEST_ASSERT_EQUAL_STRING("K\xc3\xa4lte", out);
	TEST_ASSERT_EQUAL(5, text_columns("K\xc3\xa4lte"));
	/* a + combining diaeresis */
	TEST_ASSERT_EQUAL(1, text_columns("a\xcc\x88"));
	/* two wide characters */
	TEST_ASSERT_EQUAL(4, text_columns("\xe6\xb8\xa9\xe5\xba\xa6"));
}

static void test_a_wide_character_is_not_cut_in_half(void)
{
	TEST_ASSERT_EQUAL(3, clean("\xe6\xb8\xa9\xe5\xba\xa6", 3));
	TEST_ASSERT_EQUAL_STRING("\xe6\xb8\xa9~", out);
	TEST_ASSERT_EQUAL(1, clean("\xe6\xb8\xa9\xe5\xba\xa6", 2));
	TEST_ASSERT_EQUAL_STRING("~", out);
}

static void test_nothing_that_controls_the_terminal_gets_through(void)
{
	clean("\033[2J\x07\xc2\x9b\xe2\x80\xae\xff\x7f", 100);
	TEST_ASSERT_EQUAL_STRING("?[2J?????", out);
}

static void test_the_room_is_never_exceeded(void)
{
	unsigned seed = 20240611;

	for (int round = 0; round < 20000; round++) {
		char text[40], small[24];
		char message[40];
		size_t len, room;
		unsigned columns, used;

		snprintf(message, sizeof(message), "seed 20240611, round %d", round);
		len = (size_t)rand_r(&seed) % sizeof(text);
		for (size_t i = 0; i < len; i++)
			text[i] =
				(char)(rand_r(&seed) % 3
			                       ? "\xc3\xa4\xe6\xb8\xa9\xcc\x88 a"[rand_r(&seed) % 9]
			                       : rand_r(&seed));
		room = 1 + (size_t)rand_r(&seed) % (sizeof(small) - 2);
		columns = (unsigned)rand_r(&seed) % 30;
		memset(small, 0x55, sizeof(small));
		used = text_clean(text, len, columns, small, room);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x55, small[room], message);
		TEST_ASSERT_TRUE_MESSAGE(strlen(small) < room, message);
		TEST_ASSERT_TRUE_MESSAGE(used <= columns, message);
		TEST_ASSERT_EQUAL_MESSAGE(used, text_columns(small), message);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_text_that_fits_stays);
	RUN_TEST(test_text_that_does_not_fit_ends_in_a_tilde);
	RUN_TEST(test_columns_are_not_bytes);
	RUN_TEST(test_a_wide_character_is_not_cut_in_half);
	RUN_TEST(test_nothing_that_controls_the_terminal_gets_through);
	RUN_TEST(test_the_room_is_never_exceeded);
	return UNITY_END();
}
