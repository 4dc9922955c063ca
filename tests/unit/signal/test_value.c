/* SPDX-License-Identifier: MIT */
/* Tests of values of signals, and of their texts. */
#include <errno.h>
#include <float.h>
#include <math.h>
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

static double double_of(int64_t bits)
{
	double number;

	memcpy(&number, &bits, sizeof(number));
	return number;
}

static void expect_text(enum ows_type type, const char *text, int64_t value, uint8_t quality)
{
	uint8_t got_quality = 0;
	int64_t got = -77;

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, value_from_text(type, text, strlen(text), &got, &got_quality), text);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(value, got, text);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(quality, got_quality, text);
}

static void expect_no_text(enum ows_type type, const char *text)
{
	uint8_t quality;
	int64_t value;

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		-EILSEQ, value_from_text(type, text, strlen(text), &value, &quality), text);
}

static const struct {
	enum ows_type type;
	int64_t least, most;
	const char *below, *above;
} limits[] = {
	{OWS_BYTE, 0, 255, "-1", "256"},
	{OWS_SHORT, -32768, 32767, "-32769", "32768"},
	{OWS_LONG, INT32_MIN, INT32_MAX, "-2147483649", "2147483648"},
	{OWS_WORD, 0, 65535, "-1", "65536"},
	{OWS_DWORD, 0, UINT32_MAX, "-1", "4294967296"},
	{OWS_LARGE, INT64_MIN, INT64_MAX, "-9223372036854775809", "9223372036854775808"},
};
#define LIMITS (sizeof(limits) / sizeof(limits[0]))

static void test_types_have_the_names_of_the_configuration(void)
{
	static const char *const names[] = {"bool",  "byte",  "short",  "long",  "word",
	                                    "dword", "float", "double", "large", "string"};
	static const int codes[] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12};

	for (size_t i = 0; i < sizeof(codes) / sizeof(codes[0]); i++) {
		TEST_ASSERT_TRUE(value_type_ok(codes[i]));
		TEST_ASSERT_EQUAL_STRING(names[i], value_type_name((enum ows_type)codes[i]));
		TEST_ASSERT_EQUAL_INT(codes[i], value_type_parse(names[i]));
	}
	for (int code = -3; code < 20; code++)
		if (code < 1 || code == 9 || code == 11 || code > 12) {
			TEST_ASSERT_FALSE(value_type_ok(code));
			TEST_ASSERT_EQUAL_STRING("?", value_type_name((enum ows_type)code));
		}
	TEST_ASSERT_EQUAL_INT(-1, value_type_parse("int"));
	TEST_ASSERT_EQUAL_INT(-1, value_type_parse(""));
	TEST_ASSERT_EQUAL_INT(-1, value_type_parse("Double"));
}

static void test_integers_are_read_exactly_up_to_both_limits(void)
{
	char text[VALUE_TEXT_MAX];

	for (size_t i = 0; i < LIMITS; i++) {
		snprintf(text, sizeof(text), "%lld", (long long)limits[i].least);
		expect_text(limits[i].type, text, limits[i].least, OWS_Q_GOOD);
		snprintf(text, sizeof(text), "%lld", (long long)limits[i].most);
		expect_text(limits[i].type, text, limits[i].most, OWS_Q_GOOD);
	}
}

static void test_a_number_outside_the_type_is_held_at_the_nearest_limit(void)
{
	for (size_t i = 0; i < LIMITS; i++) {
		expect_text(limits[i].type, limits[i].below, limits[i].least, OWS_Q_LOW);
		expect_text(limits[i].type, limits[i].above, limits[i].most, OWS_Q_HIGH);
		expect_text(limits[i].type, "-1e99999999999", limits[i].least, OWS_Q_LOW);
		expect_text(limits[i].type, "1e30", limits[i].most, OWS_Q_HIGH);
	}
}

static void test_a_fraction_is_no_integer(void)
{
	static const char *const bad[] = {
		"21.5",
		"0.5",
		"-0.5",
		"0.49999999999999999999999",
		"-0.05",
		"9.99",
		"255.4",
		"255.5",
		"300.5",
		"-999.9",
		"1e-999",
		"1.25e1",
		"9007199254740993.5",
		"9223372036854775807.5",
		"-9223372036854775808.4",
	};

	for (int type = 0; type < 16; type++)
		for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
			if (value_type_ok(type) && type != OWS_STRING &&
			    !value_is_float((enum ows_type)type))
				expect_no_text((enum ows_type)type, bad[i]);
	expect_text(OWS_BYTE, "21.000", 21, OWS_Q_GOOD);
	expect_text(OWS_LARGE, "-9223372036854775808.0", INT64_MIN, OWS_Q_GOOD);
}

static void test_blanks_plus_points_and_exponents_are_read(void)
{
	expect_text(OWS_LONG, "        1234 ", 1234, OWS_Q_GOOD);
	expect_text(OWS_LONG, "\t+12\r\n", 12, OWS_Q_GOOD);
	expect_text(OWS_LONG, "12.", 12, OWS_Q_GOOD);
	expect_text(OWS_LONG, ".7e1", 7, OWS_Q_GOOD);
	expect_text(OWS_LONG, "1.25e2", 125, OWS_Q_GOOD);
	expect_text(OWS_LONG, "12500E-2", 125, OWS_Q_GOOD);
	expect_text(OWS_LONG, "000000000000000000000000042", 42, OWS_Q_GOOD);
	expect_text(OWS_LONG, "0e99999999999999999999", 0, OWS_Q_GOOD);
	expect_text(OWS_DOUBLE, "     23.5625", value_of_double(23.5625), OWS_Q_GOOD);
	expect_text(OWS_DOUBLE, "-0.001", value_of_double(-0.001), OWS_Q_GOOD);
	expect_text(OWS_FLOAT, "0.1", value_of_double((double)0.1f), OWS_Q_GOOD);
}

static void test_text_that_is_no_number_is_refused_by_every_type(void)
{
	static const char *const bad[] = {
		"",    "   ", "abc", "1,5",  "0,0,1",    "1 2", "1x",  "x1",    "--1",
		"+-1", "1e",  "1e+", "e5",   ".",        "-",   "-.",  "1.2.3", "0x10",
		"nan", "NAN", "inf", "-INF", "infinity", "on",  "yes",
	};

	for (int type = 0; type < 16; type++)
		for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
			if (value_type_ok(type) && type != OWS_STRING)
				expect_no_text((enum ows_type)type, bad[i]);
}

static void test_a_nul_byte_or_endless_digits_are_no_number(void)
{
	char digits[5000];
	uint8_t quality;
	int64_t value;

	TEST_ASSERT_EQUAL_INT(-EILSEQ, value_from_text(OWS_LONG, "12\0", 3, &value, &quality));
	memset(digits, '1', sizeof(digits));
	TEST_ASSERT_EQUAL_INT(
		-EILSEQ, value_from_text(OWS_DOUBLE, digits, sizeof(digits), &value, &quality));
	TEST_ASSERT_EQUAL_INT(0, value_from_text(OWS_DOUBLE, digits, 300, &value, &quality));
	TEST_ASSERT_DOUBLE_WITHIN(1e285, 1.1111111111111111e299, double_of(value));
}

static void test_a_string_has_no_value(void)
{
	char text[VALUE_TEXT_MAX] = "x";
	uint8_t quality;
	int64_t value;

	TEST_ASSERT_EQUAL_INT(-EINVAL, value_from_text(OWS_STRING, "1", 1, &value, &quality));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_from_number(OWS_STRING, 1, &value, &quality));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_STRING, "1", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_set_double(OWS_STRING, 1, &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_set_integer(OWS_STRING, 1, &value));
	TEST_ASSERT_FALSE(value_holds(OWS_STRING, 0));
	TEST_ASSERT_EQUAL_INT(0, value_to_text(OWS_STRING, 1, text));
	TEST_ASSERT_EQUAL_STRING("", text);
}

static void test_bool_is_one_for_all_above_zero(void)
{
	expect_text(OWS_BOOL, "0", 0, OWS_Q_GOOD);
	expect_text(OWS_BOOL, "-0.000e7", 0, OWS_Q_GOOD);
	expect_text(OWS_BOOL, "1", 1, OWS_Q_GOOD);
	expect_text(OWS_BOOL, "255", 1, OWS_Q_GOOD);
	expect_text(OWS_BOOL, "1e30", 1, OWS_Q_GOOD);
	expect_text(OWS_BOOL, "-3", 0, OWS_Q_LOW);
}

static void test_floats_beyond_their_range_are_held_at_the_limit(void)
{
	expect_text(OWS_DOUBLE, "1e309", value_of_double(DBL_MAX), OWS_Q_HIGH);
	expect_text(OWS_DOUBLE, "-1e309", value_of_double(-DBL_MAX), OWS_Q_LOW);
	expect_text(OWS_FLOAT, "1e39", value_of_double((double)FLT_MAX), OWS_Q_HIGH);
	expect_text(OWS_FLOAT, "-1e39", value_of_double(-(double)FLT_MAX), OWS_Q_LOW);
	expect_text(OWS_DOUBLE, "1e-400", value_of_double(0), OWS_Q_GOOD);
}

static void test_a_known_number_is_converted_as_its_text_would_be(void)
{
	static const double numbers[] = {0,     0.5,   -0.5, 1.5,     254.5,       255.4,
	                                 255.5, 256,   -1,   32767.5, -32768.5,    -32769,
	                                 1e10,  -1e10, 1e19, -1e19,   4294967295., 4294967295.5};
	uint8_t quality_a, quality_b;
	int64_t a, b;
	char text[64];

	for (int type = 0; type < 16; type++) {
		if (!value_type_ok(type) || type == OWS_STRING)
			continue;
		for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
			snprintf(text, sizeof(text), "%.17g", numbers[i]);
			int err = value_from_text((enum ows_type)type, text, strlen(text), &b,
			                          &quality_b);

			TEST_ASSERT_EQUAL_INT_MESSAGE(
				err,
				value_from_number((enum ows_type)type, numbers[i], &a, &quality_a),
				text);
			if (err)
				continue;
			TEST_ASSERT_EQUAL_INT64_MESSAGE(b, a, text);
			TEST_ASSERT_EQUAL_HEX8_MESSAGE(quality_b, quality_a, text);
		}
		TEST_ASSERT_EQUAL_INT(-EILSEQ, value_from_number((enum ows_type)type, (double)NAN,
		                                                 &a, &quality_a));
		TEST_ASSERT_EQUAL_INT(
			-EILSEQ, value_from_number((enum ows_type)type, -HUGE_VAL, &a, &quality_a));
	}
	TEST_ASSERT_EQUAL_INT(0, value_from_number(OWS_LARGE, 0x1p63, &a, &quality_a));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, a);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_a);
	TEST_ASSERT_EQUAL_INT(0, value_from_number(OWS_LARGE, -0x1p63, &a, &quality_a));
	TEST_ASSERT_EQUAL_INT64(INT64_MIN, a);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality_a);
	TEST_ASSERT_EQUAL_INT(0, value_from_number(OWS_FLOAT, 1e300, &a, &quality_a));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, quality_a);
}

static void test_what_a_type_cannot_hold_is_never_set(void)
{
	int64_t value = 77;

	for (size_t i = 0; i < LIMITS; i++) {
		enum ows_type type = limits[i].type;

		TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_double(type, 1e19, &value));
		TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_double(type, -1e19, &value));
		TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_double(type, 0.5, &value));
		TEST_ASSERT_EQUAL_INT(-EINVAL, value_set_double(type, (double)NAN, &value));
		TEST_ASSERT_EQUAL_INT(-EINVAL, value_set_double(type, HUGE_VAL, &value));
		TEST_ASSERT_EQUAL_INT(-ERANGE, value_parse(type, limits[i].below, &value));
		TEST_ASSERT_EQUAL_INT(-ERANGE, value_parse(type, limits[i].above, &value));
		if (type == OWS_LARGE)
			continue;
		TEST_ASSERT_EQUAL_INT(-ERANGE,
		                      value_set_integer(type, limits[i].least - 1, &value));
		TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_integer(type, limits[i].most + 1, &value));
		TEST_ASSERT_FALSE(value_holds(type, limits[i].least - 1));
		TEST_ASSERT_FALSE(value_holds(type, limits[i].most + 1));
	}
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_double(OWS_BOOL, 2, &value));
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_integer(OWS_BOOL, -1, &value));
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_set_double(OWS_FLOAT, 1e39, &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_set_double(OWS_DOUBLE, -(double)NAN, &value));
	TEST_ASSERT_EQUAL_INT64_MESSAGE(77, value, "a refused set leaves the value alone");
}

static void test_what_a_type_holds_is_set_exactly(void)
{
	int64_t value;

	for (size_t i = 0; i < LIMITS; i++) {
		TEST_ASSERT_EQUAL_INT(0,
		                      value_set_integer(limits[i].type, limits[i].least, &value));
		TEST_ASSERT_EQUAL_INT64(limits[i].least, value);
		TEST_ASSERT_TRUE(value_holds(limits[i].type, value));
		TEST_ASSERT_EQUAL_INT(0, value_set_integer(limits[i].type, limits[i].most, &value));
		TEST_ASSERT_EQUAL_INT64(limits[i].most, value);
		TEST_ASSERT_TRUE(value_holds(limits[i].type, value));
		TEST_ASSERT_EQUAL_INT(0, value_set_double(limits[i].type, 100, &value));
		TEST_ASSERT_EQUAL_INT64(100, value);
	}
	TEST_ASSERT_EQUAL_INT(0, value_set_double(OWS_FLOAT, 0.1, &value));
	TEST_ASSERT_EQUAL_INT64(value_of_double((double)0.1f), value);
	TEST_ASSERT_EQUAL_INT(0, value_set_integer(OWS_DOUBLE, -3, &value));
	TEST_ASSERT_EQUAL_DOUBLE(-3, value_number(OWS_DOUBLE, value));
	TEST_ASSERT_EQUAL_DOUBLE(-3, value_number(OWS_LONG, -3));
}

static void test_rubbish_from_shared_memory_is_recognised(void)
{
	TEST_ASSERT_FALSE(value_holds(OWS_DOUBLE, value_of_double((double)NAN)));
	TEST_ASSERT_FALSE(value_holds(OWS_DOUBLE, value_of_double(HUGE_VAL)));
	TEST_ASSERT_FALSE(value_holds(OWS_DOUBLE, -1));
	TEST_ASSERT_FALSE(value_holds(OWS_FLOAT, value_of_double(1e39)));
	TEST_ASSERT_FALSE(value_holds(OWS_BOOL, 2));
	TEST_ASSERT_FALSE(value_holds((enum ows_type)9, 0));
	TEST_ASSERT_TRUE(value_holds(OWS_DOUBLE, value_of_double(1e39)));
	TEST_ASSERT_TRUE(value_holds(OWS_FLOAT, value_of_double((double)FLT_MAX)));
}

static void test_bool_is_parsed_from_words_in_any_case(void)
{
	static const struct {
		const char *text;
		int value;
	} words[] = {{"on", 1},    {"OFF", 0},  {"yes", 1}, {"No", 0},  {"true", 1},
	             {"FALSE", 0}, {" on ", 1}, {"1", 1},   {"0.0", 0}, {"1.0", 1}};
	int64_t value;

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, value_parse(OWS_BOOL, words[i].text, &value),
		                              words[i].text);
		TEST_ASSERT_EQUAL_INT64(words[i].value, value);
	}
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_BOOL, "o", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_BOOL, "onn", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_BOOL, "", &value));
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_parse(OWS_BOOL, "2", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_LONG, "on", &value));
}

static void test_a_start_value_is_exact_or_refused(void)
{
	int64_t value;

	TEST_ASSERT_EQUAL_INT(0, value_parse(OWS_DOUBLE, "-4.7", &value));
	TEST_ASSERT_EQUAL_DOUBLE(-4.7, value_number(OWS_DOUBLE, value));
	TEST_ASSERT_EQUAL_INT(0, value_parse(OWS_LARGE, "-9223372036854775808", &value));
	TEST_ASSERT_EQUAL_INT64(INT64_MIN, value);
	TEST_ASSERT_EQUAL_INT(0, value_parse(OWS_LONG, "1.2e1", &value));
	TEST_ASSERT_EQUAL_INT64(12, value);
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_LONG, "1.5", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_LONG, "1e-3", &value));
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_parse(OWS_DOUBLE, "1e309", &value));
	TEST_ASSERT_EQUAL_INT(-ERANGE, value_parse(OWS_FLOAT, "-1e39", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_DOUBLE, "4,7", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_DOUBLE, "nan", &value));
	TEST_ASSERT_EQUAL_INT(-EINVAL, value_parse(OWS_DOUBLE, "inf", &value));
}

static void expect_printed(enum ows_type type, double number, const char *expected)
{
	char text[VALUE_TEXT_MAX];
	int n = value_to_text(type, value_of_double(number), text);

	TEST_ASSERT_EQUAL_STRING(expected, text);
	TEST_ASSERT_EQUAL_INT((int)strlen(expected), n);
}

static void test_the_text_of_a_float_is_the_shortest_that_reads_back(void)
{
	expect_printed(OWS_DOUBLE, 23.5625, "23.5625");
	expect_printed(OWS_DOUBLE, 0.1, "0.1");
	expect_printed(OWS_DOUBLE, 0.1 + 0.2, "0.30000000000000004");
	expect_printed(OWS_DOUBLE, 1.0 / 3, "0.3333333333333333");
	expect_printed(OWS_DOUBLE, 100, "100");
	expect_printed(OWS_DOUBLE, -0.0, "-0");
	expect_printed(OWS_DOUBLE, DBL_MAX, "1.7976931348623157e+308");
	expect_printed(OWS_DOUBLE, 5e-324, "5e-324");
	expect_printed(OWS_FLOAT, (double)0.1f, "0.1");
	expect_printed(OWS_FLOAT, (double)FLT_MAX, "3.4028235e+38");
	expect_printed(OWS_FLOAT, (double)16777216.f, "16777216");
	expect_printed(OWS_FLOAT, (double)1e-45f, "1e-45");
}

static void test_integers_and_bool_are_printed_as_decimals(void)
{
	char text[VALUE_TEXT_MAX];

	for (size_t i = 0; i < LIMITS; i++) {
		int64_t value;

		value_to_text(limits[i].type, limits[i].least, text);
		TEST_ASSERT_EQUAL_INT(0, value_parse(limits[i].type, text, &value));
		TEST_ASSERT_EQUAL_INT64(limits[i].least, value);
	}
	TEST_ASSERT_EQUAL_INT(1, value_to_text(OWS_BOOL, 1, text));
	TEST_ASSERT_EQUAL_STRING("1", text);
	TEST_ASSERT_EQUAL_INT(20, value_to_text(OWS_LARGE, INT64_MIN, text));
	TEST_ASSERT_EQUAL_STRING("-9223372036854775808", text);
}

static void round_trip(enum ows_type type, double number, const char *note)
{
	char text[VALUE_TEXT_MAX];
	uint8_t quality;
	int64_t value;
	int n = value_to_text(type, value_of_double(number), text);

	TEST_ASSERT_TRUE_MESSAGE(n > 0 && n < VALUE_TEXT_MAX, note);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, value_from_text(type, text, (size_t)n, &value, &quality),
	                              note);
	TEST_ASSERT_EQUAL_HEX64_MESSAGE(value_of_double(number), value, text);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, quality, text);
}

static void test_random_floats_read_back_to_the_same_bits(void)
{
	uint64_t state = seed;
	char note[40];

	snprintf(note, sizeof(note), "seed %llx", (unsigned long long)seed);
	for (int i = 0; i < 20000; i++) {
		uint64_t bits = next_random(&state);
		double number = double_of((int64_t)bits);
		uint32_t low = (uint32_t)bits;
		float single;

		if (isfinite(number))
			round_trip(OWS_DOUBLE, number, note);
		memcpy(&single, &low, sizeof(single));
		if (isfinite(single))
			round_trip(OWS_FLOAT, (double)single, note);
		round_trip(OWS_DOUBLE, (double)(int64_t)bits / 4096, note);
	}
}

static void test_fewer_digits_than_printed_would_not_read_back(void)
{
	uint64_t state = seed;

	for (int i = 0; i < 3000; i++) {
		double number = double_of((int64_t)next_random(&state));
		char text[VALUE_TEXT_MAX], shorter[400];
		int digits = 0;

		if (!isfinite(number) || number == 0)
			continue;
		value_to_text(OWS_DOUBLE, value_of_double(number), text);
		for (const char *p = text; *p && *p != 'e'; p++)
			digits += *p >= (digits ? '0' : '1') && *p <= '9';
		if (digits < 16)
			continue;
		snprintf(shorter, sizeof(shorter), "%.*g", digits - 1, number);
		TEST_ASSERT_TRUE_MESSAGE(strtod(shorter, NULL) != number, text);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_types_have_the_names_of_the_configuration);
	RUN_TEST(test_integers_are_read_exactly_up_to_both_limits);
	RUN_TEST(test_a_number_outside_the_type_is_held_at_the_nearest_limit);
	RUN_TEST(test_a_fraction_is_no_integer);
	RUN_TEST(test_blanks_plus_points_and_exponents_are_read);
	RUN_TEST(test_text_that_is_no_number_is_refused_by_every_type);
	RUN_TEST(test_a_nul_byte_or_endless_digits_are_no_number);
	RUN_TEST(test_a_string_has_no_value);
	RUN_TEST(test_bool_is_one_for_all_above_zero);
	RUN_TEST(test_floats_beyond_their_range_are_held_at_the_limit);
	RUN_TEST(test_a_known_number_is_converted_as_its_text_would_be);
	RUN_TEST(test_what_a_type_cannot_hold_is_never_set);
	RUN_TEST(test_what_a_type_holds_is_set_exactly);
	RUN_TEST(test_rubbish_from_shared_memory_is_recognised);
	RUN_TEST(test_bool_is_parsed_from_words_in_any_case);
	RUN_TEST(test_a_start_value_is_exact_or_refused);
	RUN_TEST(test_the_text_of_a_float_is_the_shortest_that_reads_back);
	RUN_TEST(test_integers_and_bool_are_printed_as_decimals);
	RUN_TEST(test_random_floats_read_back_to_the_same_bits);
	RUN_TEST(test_fewer_digits_than_printed_would_not_read_back);
	return UNITY_END();
}
