/* SPDX-License-Identifier: MIT */
/* Whatever a bus says: what is taken for good is what the text says. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"

static const uint64_t seed = 0x5eed1a5eu;

void setUp(void)
{
}
void tearDown(void)
{
}

static uint64_t next_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

/*
 * Of any type and any text that a bus may say: blanks, signs, digits, points, exponents, rubbish.
 */
static void test_what_is_good_is_the_number_that_the_text_says(void)
{
	static const char alphabet[] = "  +-0011223456789..eE,xn";
	uint64_t state = seed;
	unsigned good[16] = {0};

	for (int i = 0; i < 200000; i++) {
		enum ows_type type = (enum ows_type)(next_random(&state) % 16);
		char text[16], back[VALUE_TEXT_MAX], note[40], *end;
		size_t len = next_random(&state) % (sizeof(text) - 1);
		uint8_t quality;
		int64_t value;

		for (size_t k = 0; k < len; k++)
			text[k] = alphabet[next_random(&state) % (sizeof(alphabet) - 1)];
		text[len] = '\0';
		if (!value_type_ok((int)type) || type == OWS_STRING ||
		    value_from_text(type, text, len, &value, &quality) || quality != OWS_Q_GOOD)
			continue;
		snprintf(note, sizeof(note), "\"%s\" as %s", text, value_type_name(type));
		good[type]++;
		value_to_text(type, value, back);
		double said = strtod(text, &end);
		TEST_ASSERT_TRUE_MESSAGE(strspn(end, " ") == strlen(end), note);
		if (type == OWS_BOOL)
			said = said > 0;
		if (type == OWS_DOUBLE)
			TEST_ASSERT_TRUE_MESSAGE(value == value_of_double(said), note);
		if (type == OWS_FLOAT)
			TEST_ASSERT_TRUE_MESSAGE(strtof(back, NULL) == strtof(text, NULL), note);
		else
			TEST_ASSERT_TRUE_MESSAGE(strtod(back, NULL) == said, note);
	}
	for (int type = 0; type < 16; type++)
		if (value_type_ok(type) && type != OWS_STRING)
			TEST_ASSERT_GREATER_THAN_UINT(100, good[type]);
}

/* Short and long, so that each way of reading is taken, and the last ones before the next. */
static void test_a_double_is_to_the_bit_what_the_c_library_reads(void)
{
	uint64_t state = seed;

	for (int i = 0; i < 200000; i++) {
		int digits = 1 + (int)(next_random(&state) % 19);
		int point = (int)(next_random(&state) % (uint64_t)(digits + 1));
		int exponent = (int)(next_random(&state) % 64) - 32;
		char text[48];
		int len = 0;
		uint8_t quality;
		int64_t value;

		if (next_random(&state) % 2)
			text[len++] = '-';
		for (int k = 0; k < digits; k++) {
			if (k == point)
				text[len++] = '.';
			text[len++] = (char)('0' + next_random(&state) % 10);
		}
		if (next_random(&state) % 2)
			len += snprintf(text + len, sizeof(text) - (size_t)len, "e%d", exponent);
		text[len] = '\0';
		TEST_ASSERT_EQUAL_INT(
			0, value_from_text(OWS_DOUBLE, text, (size_t)len, &value, &quality));
		TEST_ASSERT_TRUE_MESSAGE(value == value_of_double(strtod(text, NULL)), text);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_good_is_the_number_that_the_text_says);
	RUN_TEST(test_a_double_is_to_the_bit_what_the_c_library_reads);
	return UNITY_END();
}
