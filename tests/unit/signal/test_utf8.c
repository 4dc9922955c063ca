/* SPDX-License-Identifier: MIT */
/* Tests of UTF-8 and of the characters that disturb a line. */
#include <string.h>

#include "unity.h"

#include "src/ground/signal/utf8.h"

void setUp(void)
{
}
void tearDown(void)
{
}

/* By the table of RFC 3629 */
static size_t encode(uint32_t code, char *text)
{
	static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
	size_t bytes = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;

	for (size_t i = bytes; i-- > 1; code >>= 6)
		text[i] = (char)(0x80 | (code & 0x3f));
	text[0] = (char)(lead[bytes] | code);
	return bytes;
}

static void test_each_character_is_read_back_and_only_whole(void)
{
	for (uint32_t code = 0; code < 0x110000; code++) {
		char bytes[4];
		size_t size = encode(code, bytes);
		bool surrogate = code >= 0xd800 && code < 0xe000;

		for (size_t len = 1; len <= size; len++) {
			bool good = len == size && !surrogate;
			const char *text = bytes;
			size_t left = len;

			TEST_ASSERT_EQUAL_INT32(good ? (int32_t)code : -1, utf8_next(&text, &left));
			TEST_ASSERT_EQUAL_size_t(good ? 0 : len - 1, left);
			TEST_ASSERT_EQUAL_PTR(bytes + (len - left), text);
		}
	}
}

static void test_a_form_longer_than_needed_is_no_character(void)
{
	static const char *const forms[] = {"\xc0\xaf",
	                                    "\xe0\x80\xaf",
	                                    "\xe0\x9f\xbf",
	                                    "\xf0\x80\x80\xaf",
	                                    "\xf0\x8f\xbf\xbf",
	                                    "\xf4\x90\x80\x80",
	                                    "\xf8\x88\x80\x80",
	                                    "\x80",
	                                    "\xfe",
	                                    "\xff"};

	for (size_t i = 0; i < sizeof(forms) / sizeof(forms[0]); i++) {
		const char *text = forms[i];
		size_t left = strlen(text);

		while (left > 0)
			TEST_ASSERT_EQUAL_INT32(-1, utf8_next(&text, &left));
	}
}

static void test_what_would_disturb_a_line_is_told_from_what_would_not(void)
{
	static const int32_t bad[] = {-1,   0,      '\n',   0x1b,   0x7f,
	                              0x9b, 0x2028, 0x202e, 0x2066, 0x2069};
	static const int32_t good[] = {' ', '~', 0xa0, 0x10d, 0x2027, 0x202f, 0x206a, 0x1f321};

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_TRUE(utf8_disturbs(bad[i]));
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
		TEST_ASSERT_FALSE(utf8_disturbs(good[i]));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_character_is_read_back_and_only_whole);
	RUN_TEST(test_a_form_longer_than_needed_is_no_character);
	RUN_TEST(test_what_would_disturb_a_line_is_told_from_what_would_not);
	return UNITY_END();
}
