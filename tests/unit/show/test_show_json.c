/* SPDX-License-Identifier: MIT */
/* Tests of the JSON that owsctl writes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/json.h"

static char *text;
static size_t len;
static FILE *out;
static struct json json;

void setUp(void)
{
	out = open_memstream(&text, &len);
	TEST_ASSERT_NOT_NULL(out);
	json_open(&json, out);
}

void tearDown(void)
{
	fclose(out);
	free(text);
}

static const char *written(void)
{
	fflush(out);
	return text;
}

static void test_members_and_elements_are_separated_by_commas(void)
{
	json_object(&json, NULL);
	json_int(&json, "a", 1);
	json_array(&json, "b");
	json_int(&json, NULL, 2);
	json_object(&json, NULL);
	json_object_end(&json);
	json_array(&json, NULL);
	json_array_end(&json);
	json_array_end(&json);
	json_bool(&json, "c", true);
	json_object_end(&json);
	json_end(&json);
	TEST_ASSERT_EQUAL_STRING("{\"a\":1,\"b\":[2,{},[]],\"c\":true}\n", written());
}

static void test_a_whole_number_for_a_browser_is_a_text_from_2_to_the_53_on(void)
{
	json_array(&json, NULL);
	json_exact(&json, NULL, INT64_C(9007199254740991));
	json_exact(&json, NULL, INT64_C(9007199254740992));
	json_exact(&json, NULL, INT64_C(-9007199254740991));
	json_exact(&json, NULL, INT64_MIN);
	json_array_end(&json);
	TEST_ASSERT_EQUAL_STRING("[9007199254740991,\"9007199254740992\",-9007199254740991,"
	                         "\"-9223372036854775808\"]",
	                         written());
}

static void test_documents_follow_each_other_on_lines(void)
{
	json_int(&json, NULL, 1);
	json_end(&json);
	json_null(&json, NULL);
	json_end(&json);
	TEST_ASSERT_EQUAL_STRING("1\nnull\n", written());
}

static void test_strings_are_escaped(void)
{
	json_string(&json, NULL, "\"\\/\b\n\r\t\x1f\x7f");
	TEST_ASSERT_EQUAL_STRING("\"\\\"\\\\/\\u0008\\n\\u000d\\u0009\\u001f\\u007f\"", written());
}

static void test_zero_bytes_are_kept(void)
{
	json_bytes(&json, NULL, "a\0b", 3);
	TEST_ASSERT_EQUAL_STRING("\"a\\u0000b\"", written());
}

static void test_utf8_goes_through(void)
{
	json_string(&json, NULL, "K\xc3\xa4lte \xe2\x82\xac \xf0\x9f\x8c\xa1");
	TEST_ASSERT_EQUAL_STRING("\"K\xc3\xa4lte \xe2\x82\xac \xf0\x9f\x8c\xa1\"", written());
}

static void test_what_is_not_utf8_is_replaced(void)
{
	static const char *const wrong[] = {
		"\xff",
		"\x80",
		"\xc3",
		"\xc0\xaf",
		"\xe0\x80\x80",
		"\xed\xa0\x80",
		"\xf4\x90\x80\x80",
		"\xf8\x88\x80\x80\x80",
		"\xe2\x82",
	};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		rewind(out);
		json_string(&json, NULL, wrong[i]);
		json_end(&json);
		TEST_ASSERT_EQUAL_STRING_LEN("\"\xef\xbf\xbd", written(), 4);
		TEST_ASSERT_NULL(strstr(text, wrong[i]));
	}
}

/* What a JSON string stands for, in UTF-8. Returns its length. */
static size_t decoded(const char *at, char *bytes)
{
	char *to = bytes;

	for (; *at != '"'; at++) {
		unsigned code;

		if (*at != '\\') {
			*to++ = *at;
			continue;
		}
		at++;
		if (*at != 'u') {
			*to++ = *at == 'n' ? '\n' : *at;
			continue;
		}
		TEST_ASSERT_EQUAL_INT(1, sscanf(at + 1, "%4x", &code));
		at += 4;
		if (code < 0x80) {
			*to++ = (char)code;
		} else {
			*to++ = (char)(0xc0 | code >> 6);
			*to++ = (char)(0x80 | (code & 0x3f));
		}
	}
	return (size_t)(to - bytes);
}

static void test_no_byte_of_a_value_is_lost(void)
{
	static const char *const parts[] = {
		"a",        "\xc3\xa4",     "\xe2\x82\xac", "\"",   "\\",   "\n", "\x7f",
		"\xc2\x85", "\xef\xbf\xbd", "\xff",         "\x80", "\xc3", " "};
	unsigned with = 0;

	srand(7);
	for (int i = 0; i < 3000; i++) {
		char bytes[64] = "", back[64];
		size_t count = 0, parts_left = (size_t)rand() % 8, n = 0;
		const char *hex;

		while (parts_left-- > 0) {
			const char *part = parts[(size_t)rand() % (i & 1 ? 9 : 13)];

			memcpy(bytes + count, part, strlen(part));
			count += strlen(part);
			if (rand() % 20 == 0)
				bytes[count++] = '\0';
		}
		rewind(out);
		json_object(&json, NULL);
		json_text(&json, bytes, count);
		json_object_end(&json);
		json_end(&json);
		written();
		*strchr(text, '\n') = '\0'; /* behind it is what was there before */
		hex = strstr(text, ",\"hex\":\"");
		if (hex) {
			with++;
			TEST_ASSERT_FALSE_MESSAGE(i & 1, text);
			for (hex += 8; *hex != '"'; hex += 2) {
				unsigned byte;

				TEST_ASSERT_EQUAL_INT(1, sscanf(hex, "%2x", &byte));
				back[n++] = (char)byte;
			}
		} else {
			n = decoded(strstr(text, "\"value\":\"") + 9, back);
		}
		TEST_ASSERT_EQUAL_size_t_MESSAGE(count, n, text);
		if (count > 0)
			TEST_ASSERT_EQUAL_MEMORY_MESSAGE(bytes, back, count, text);
	}
	TEST_ASSERT_GREATER_THAN_UINT(500, with);
}

static void test_integers_of_64_bits_are_exact(void)
{
	json_array(&json, NULL);
	json_int(&json, NULL, INT64_MAX);
	json_int(&json, NULL, INT64_MIN);
	json_uint(&json, NULL, UINT64_MAX);
	json_array_end(&json);
	TEST_ASSERT_EQUAL_STRING("[9223372036854775807,-9223372036854775808,18446744073709551615]",
	                         written());
}

static void test_text_that_is_no_json_number_becomes_null(void)
{
	static const char *const numbers[] = {"0", "-0", "21.5", "1e+20", "-1.5E-7", "1e5"};
	static const char *const none[] = {"nan", "-inf", "",   "1.",  ".5", "01",
	                                   "+1",  "0x1",  "1 ", "--1", "1e", "1e+"};

	for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
		rewind(out);
		json_number(&json, NULL, numbers[i]);
		json_end(&json);
		TEST_ASSERT_EQUAL_STRING_LEN(numbers[i], written(), strlen(numbers[i]));
	}
	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++) {
		rewind(out);
		json_number(&json, NULL, none[i]);
		json_end(&json);
		TEST_ASSERT_EQUAL_STRING_LEN("null\n", written(), 5);
	}
}

static void test_seconds_have_three_digits(void)
{
	json_array(&json, NULL);
	json_seconds(&json, NULL, 0);
	json_seconds(&json, NULL, 1002999999);
	json_seconds(&json, NULL, -1500000000);
	json_seconds(&json, NULL, -500000000);
	json_array_end(&json);
	TEST_ASSERT_EQUAL_STRING("[0.000,1.002,-1.500,-0.500]", written());
}

static void test_no_string_is_null(void)
{
	json_string(&json, NULL, NULL);
	TEST_ASSERT_EQUAL_STRING("null", written());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_members_and_elements_are_separated_by_commas);
	RUN_TEST(test_a_whole_number_for_a_browser_is_a_text_from_2_to_the_53_on);
	RUN_TEST(test_documents_follow_each_other_on_lines);
	RUN_TEST(test_strings_are_escaped);
	RUN_TEST(test_zero_bytes_are_kept);
	RUN_TEST(test_utf8_goes_through);
	RUN_TEST(test_what_is_not_utf8_is_replaced);
	RUN_TEST(test_no_byte_of_a_value_is_lost);
	RUN_TEST(test_integers_of_64_bits_are_exact);
	RUN_TEST(test_text_that_is_no_json_number_becomes_null);
	RUN_TEST(test_seconds_have_three_digits);
	RUN_TEST(test_no_string_is_null);
	return UNITY_END();
}
