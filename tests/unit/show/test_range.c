/* SPDX-License-Identifier: MIT */
/* Tests of the words for the values that a signal can have. */
#include <math.h>

#include "unity.h"

#include "src/faces/show/digits.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void is(const char *expected, enum ows_type type, double min, double max)
{
	char words[RANGE_WORDS];

	TEST_ASSERT_EQUAL_STRING(expected, range_words(type, min, max, words));
}

static void test_without_limits_it_is_that_of_the_type(void)
{
	is("0 or 1", OWS_BOOL, NAN, NAN);
	is("0 to 255", OWS_BYTE, NAN, NAN);
	is("-32768 to 32767", OWS_SHORT, NAN, NAN);
	is("0 to 4294967295", OWS_DWORD, NAN, NAN);
	is("-9223372036854775808 to 9223372036854775807", OWS_LARGE, NAN, NAN);
	is("up to 3.4e38", OWS_FLOAT, NAN, NAN);
	is("up to 1.8e308", OWS_DOUBLE, NAN, NAN);
	is("a text of up to 1024 bytes", OWS_STRING, NAN, NAN);
}

static void test_min_and_max_take_the_place_of_what_the_type_has(void)
{
	is("10 to 200", OWS_BYTE, 10, 200);
	is("0 to 200", OWS_BYTE, NAN, 200);
	is("-5.5 to 30.25", OWS_DOUBLE, -5.5, 30.25);
	is("-5.5 or more", OWS_DOUBLE, -5.5, NAN);
	is("up to 30", OWS_FLOAT, NAN, 30);
}

static void test_a_limit_beyond_the_type_limits_nothing(void)
{
	is("0 to 255", OWS_BYTE, -1, 1000);
	is("0 or 1", OWS_BOOL, 0, 1);
	is("-2147483648 to 5", OWS_LONG, -INFINITY, 5);
	is("up to 1.8e308", OWS_DOUBLE, -INFINITY, INFINITY);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_limits_it_is_that_of_the_type);
	RUN_TEST(test_min_and_max_take_the_place_of_what_the_type_has);
	RUN_TEST(test_a_limit_beyond_the_type_limits_nothing);
	return UNITY_END();
}
