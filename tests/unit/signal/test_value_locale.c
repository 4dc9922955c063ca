/* SPDX-License-Identifier: MIT */
/*
 * A control program may set a locale with a decimal comma. Not every machine has one installed, so
 * the C library's functions are given that habit here.
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int comma_snprintf(char *text, size_t size, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
static int comma_snprintf(char *text, size_t size, const char *format, ...)
{
	va_list args;
	int n;

	va_start(args, format);
	n = vsnprintf(text, size, format, args);
	va_end(args);
	for (char *p = strchr(format, 'g') ? text : NULL; p && *p; p++)
		if (*p == '.')
			*p = ',';
	return n;
}

static int points_met;

static double comma_strtod(const char *text, char **end)
{
	points_met += strchr(text, '.') || strchr(text, ',');
	return strtod(text, end);
}

static float comma_strtof(const char *text, char **end)
{
	points_met += strchr(text, '.') || strchr(text, ',');
	return strtof(text, end);
}

#undef snprintf
#define snprintf comma_snprintf
#undef strtod
#define strtod comma_strtod
#undef strtof
#define strtof comma_strtof
#include "src/ground/signal/value.c"
#undef snprintf
#undef strtod
#undef strtof

#include "unity.h"

void setUp(void)
{
	points_met = 0;
}

void tearDown(void)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, points_met, "the C library must see no decimal point");
}

static void test_a_decimal_comma_of_the_locale_is_not_printed(void)
{
	char text[VALUE_TEXT_MAX];

	TEST_ASSERT_EQUAL_INT(7, value_to_text(OWS_DOUBLE, value_of_double(23.5625), text));
	TEST_ASSERT_EQUAL_STRING("23.5625", text);
	TEST_ASSERT_EQUAL_INT(8, value_to_text(OWS_DOUBLE, value_of_double(-1.5e-10), text));
	TEST_ASSERT_EQUAL_STRING("-1.5e-10", text);
	TEST_ASSERT_EQUAL_INT(3, value_to_text(OWS_FLOAT, value_of_double((double)0.1f), text));
	TEST_ASSERT_EQUAL_STRING("0.1", text);
}

static void test_a_decimal_point_is_read_and_a_comma_is_refused(void)
{
	uint8_t quality;
	int64_t value;

	TEST_ASSERT_EQUAL_INT(0, value_parse(OWS_DOUBLE, "21.25", &value));
	TEST_ASSERT_EQUAL_DOUBLE(21.25, value_number(OWS_DOUBLE, value));
	TEST_ASSERT_EQUAL_INT(0, value_parse(OWS_DOUBLE, "0.30000000000000004", &value));
	TEST_ASSERT_EQUAL_DOUBLE(0.1 + 0.2, value_number(OWS_DOUBLE, value));
	TEST_ASSERT_EQUAL_INT(0, value_from_text(OWS_FLOAT, " -0.5", 5, &value, &quality));
	TEST_ASSERT_EQUAL_DOUBLE(-0.5, value_number(OWS_FLOAT, value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_DOUBLE, "21,25", &value));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_decimal_comma_of_the_locale_is_not_printed);
	RUN_TEST(test_a_decimal_point_is_read_and_a_comma_is_refused);
	return UNITY_END();
}
