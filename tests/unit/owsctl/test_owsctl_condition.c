/* SPDX-License-Identifier: MIT */
/* Tests of the conditions of `owsctl wait`. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/watch/condition.h"

static struct condition condition;
static struct reading reading;

void setUp(void)
{
	memset(&reading, 0, sizeof(reading));
}

void tearDown(void)
{
}

static bool holds_number(double number, const char *op, const char *text)
{
	reading.value.type = OWS_DOUBLE;
	reading.value.number = number;
	TEST_ASSERT_EQUAL(0, condition_make(OWS_DOUBLE, op, text, &condition));
	return condition_holds(&condition, &reading);
}

static bool holds_integer(int64_t number, const char *op, const char *text)
{
	reading.value.type = OWS_LARGE;
	reading.value.integer = number;
	reading.value.number = (double)number;
	TEST_ASSERT_EQUAL(0, condition_make(OWS_LARGE, op, text, &condition));
	return condition_holds(&condition, &reading);
}

static bool holds_text(const char *value, const char *op, const char *text)
{
	reading.value.type = OWS_STRING;
	reading.len = strlen(value);
	memcpy(reading.text, value, reading.len + 1);
	TEST_ASSERT_EQUAL(0, condition_make(OWS_STRING, op, text, &condition));
	return condition_holds(&condition, &reading);
}

static void test_each_comparison_compares(void)
{
	TEST_ASSERT_TRUE(holds_number(25.5, ">", "25"));
	TEST_ASSERT_FALSE(holds_number(25, ">", "25"));
	TEST_ASSERT_TRUE(holds_number(25, ">=", "25"));
	TEST_ASSERT_TRUE(holds_number(24.9, "<", "25"));
	TEST_ASSERT_TRUE(holds_number(25, "<=", "25"));
	TEST_ASSERT_TRUE(holds_number(25, "=", "25.0"));
	TEST_ASSERT_TRUE(holds_number(25, "==", "25"));
	TEST_ASSERT_TRUE(holds_number(-5, "!=", "5"));
	TEST_ASSERT_TRUE(holds_number(-5, "<", "-4.5"));
}

static void test_large_integers_are_compared_exactly(void)
{
	TEST_ASSERT_FALSE(holds_integer(INT64_C(9007199254740993), "=", "9007199254740992"));
	TEST_ASSERT_TRUE(holds_integer(INT64_C(9007199254740993), ">", "9007199254740992"));
	TEST_ASSERT_TRUE(holds_integer(INT64_MIN, "<", "-9223372036854775807"));
}

static void test_an_integer_compares_with_a_fraction(void)
{
	TEST_ASSERT_TRUE(holds_integer(3, ">", "2.5"));
	TEST_ASSERT_FALSE(holds_integer(2, ">", "2.5"));
}

static void test_a_bool_compares_with_words(void)
{
	reading.value.type = OWS_BOOL;
	reading.value.integer = 1;
	TEST_ASSERT_EQUAL(0, condition_make(OWS_BOOL, "=", "on", &condition));
	TEST_ASSERT_TRUE(condition_holds(&condition, &reading));
	TEST_ASSERT_EQUAL(0, condition_make(OWS_BOOL, "=", "false", &condition));
	TEST_ASSERT_FALSE(condition_holds(&condition, &reading));
}

static void test_strings_are_equal_or_not(void)
{
	TEST_ASSERT_TRUE(holds_text("open", "=", "open"));
	TEST_ASSERT_FALSE(holds_text("open", "=", "ope"));
	TEST_ASSERT_TRUE(holds_text("open", "!=", "opens"));
	TEST_ASSERT_EQUAL(-EOPNOTSUPP, condition_make(OWS_STRING, "<", "a", &condition));
}

static void test_what_is_no_number_is_refused(void)
{
	static const char *const none[] = {"", "warm", "25x", "nan", "inf", "1e999"};

	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++)
		TEST_ASSERT_EQUAL(-EINVAL, condition_make(OWS_DOUBLE, ">", none[i], &condition));
}

static void test_what_is_no_comparison_is_refused(void)
{
	TEST_ASSERT_EQUAL(-1, condition_op("=>"));
	TEST_ASSERT_EQUAL(-1, condition_op(""));
	TEST_ASSERT_EQUAL(-1, condition_op("-t"));
	TEST_ASSERT_EQUAL(-EINVAL, condition_make(OWS_DOUBLE, "~", "1", &condition));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_comparison_compares);
	RUN_TEST(test_large_integers_are_compared_exactly);
	RUN_TEST(test_an_integer_compares_with_a_fraction);
	RUN_TEST(test_a_bool_compares_with_words);
	RUN_TEST(test_strings_are_equal_or_not);
	RUN_TEST(test_what_is_no_number_is_refused);
	RUN_TEST(test_what_is_no_comparison_is_refused);
	return UNITY_END();
}
