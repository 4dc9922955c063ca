/* SPDX-License-Identifier: MIT */
/* Tests of the addresses, and of what stands there. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"

#include "src/faces/modbus/layout.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static struct layout_row row(double number)
{
	return (struct layout_row){.good = true, .number = number, .decimals = 2};
}

/* All registers of a field, the first of them in the upper bits. */
static uint64_t bits(const struct layout_row *of, enum layout_field field, bool little)
{
	uint64_t all = 0;

	for (unsigned i = 0; i < layout_width(field); i++)
		all = all << 16 |
		      layout_register(of, &(struct layout_place){.field = field, .part = i},
		                      little);
	return all;
}

static void is_at(unsigned address, enum layout_field field, unsigned place, unsigned part)
{
	struct layout_place at;

	TEST_ASSERT_TRUE(layout_find(address, &at));
	TEST_ASSERT_EQUAL_INT(field, at.field);
	TEST_ASSERT_EQUAL_UINT(place, at.place);
	TEST_ASSERT_EQUAL_UINT(part, at.part);
}

static void test_a_record_has_its_fields_in_their_order(void)
{
	is_at(0, LAYOUT_HEADER, 0, 0);
	is_at(15, LAYOUT_HEADER, 0, 15);
	is_at(16, LAYOUT_DOUBLE, 1, 0);
	is_at(16 + 3, LAYOUT_DOUBLE, 1, 3);
	is_at(16 + 5, LAYOUT_FLOAT, 1, 1);
	is_at(16 + 6, LAYOUT_LONG, 1, 0);
	is_at(16 + 8, LAYOUT_SHORT, 1, 0);
	is_at(16 + 9, LAYOUT_QUALITY, 1, 0);
	is_at(16 + 11, LAYOUT_AGE, 1, 1);
	is_at(16 + 12, LAYOUT_ALARM, 1, 0);
	is_at(16 + 13, LAYOUT_COUNT, 1, 0);
	is_at(16 + 14, LAYOUT_DECIMALS, 1, 0);
	is_at(16 * 2047 + 15, LAYOUT_FLAGS, 2047, 0);
}

static void test_rows_of_a_kind_have_each_place_once_and_no_address_is_two_things(void)
{
	static const enum layout_field kinds[] = {LAYOUT_SHORT, LAYOUT_QUALITY, LAYOUT_FLOAT,
	                                          LAYOUT_LONG, LAYOUT_DOUBLE};
	unsigned expected = LAYOUT_PLACES * LAYOUT_RECORD, count = 0;
	struct layout_place at;

	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		unsigned width = layout_width(kinds[i]);

		expected += width * (LAYOUT_PLACES - 1);
		for (unsigned place = 1; place < LAYOUT_PLACES; place++) {
			is_at(layout_in_row(kinds[i], place), kinds[i], place, 0);
			is_at(layout_in_row(kinds[i], place) + width - 1, kinds[i], place,
			      width - 1);
		}
	}
	for (unsigned address = 0; address < 65536; address++)
		count += layout_find(address, &at);
	TEST_ASSERT_EQUAL_UINT(expected, count);
	TEST_ASSERT_FALSE(layout_find(40000, &at));
	TEST_ASSERT_FALSE(layout_find(65536, &at));
	TEST_ASSERT_EQUAL_UINT(0, layout_in_row(LAYOUT_AGE, 1));
}

static void test_a_number_has_the_bits_of_ieee_754_and_the_word_order_that_is_asked_for(void)
{
	struct layout_row of = row(21.5);

	TEST_ASSERT_EQUAL_HEX64(0x4035800000000000, bits(&of, LAYOUT_DOUBLE, false));
	TEST_ASSERT_EQUAL_HEX64(0x0000000080004035, bits(&of, LAYOUT_DOUBLE, true));
	TEST_ASSERT_EQUAL_HEX64(0x41ac0000, bits(&of, LAYOUT_FLOAT, false));
	TEST_ASSERT_EQUAL_HEX64(0x000041ac, bits(&of, LAYOUT_FLOAT, true));
	TEST_ASSERT_EQUAL_HEX64(2150, bits(&of, LAYOUT_LONG, false));
	TEST_ASSERT_EQUAL_HEX64(2150u << 16, bits(&of, LAYOUT_LONG, true));
	TEST_ASSERT_EQUAL_HEX64(2150, bits(&of, LAYOUT_SHORT, true));
}

static void test_whole_numbers_are_rounded_and_what_does_not_fit_is_bad(void)
{
	static const struct {
		double number;
		uint64_t as_long, as_short;
	} cases[] = {
		{-0.005, 0xffffffff, 0xffff},      {0.004, 0, 0},
		{-55.126, 0xffffea77, 0xea77},     {327.67, 32767, 0x7fff},
		{327.68, 32768, 0x8000},           {-327.67, 0xffff8001, 0x8001},
		{-327.68, 0xffff8000, 0x8000},     {21474836.47, 0x7fffffff, 0x8000},
		{21474836.48, 0x80000000, 0x8000}, {-1e300, 0x80000000, 0x8000},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct layout_row of = row(cases[i].number);

		TEST_ASSERT_EQUAL_HEX64(cases[i].as_long, bits(&of, LAYOUT_LONG, false));
		TEST_ASSERT_EQUAL_HEX64(cases[i].as_short, bits(&of, LAYOUT_SHORT, false));
	}
}

static void test_what_is_not_good_is_no_number_in_any_field(void)
{
	struct layout_row of = row(21.5), large = row(1e39);

	of.good = false;
	TEST_ASSERT_EQUAL_HEX64(0x7ff8000000000000, bits(&of, LAYOUT_DOUBLE, false));
	TEST_ASSERT_EQUAL_HEX64(0x7fc00000, bits(&of, LAYOUT_FLOAT, false));
	TEST_ASSERT_EQUAL_HEX64(0x80000000, bits(&of, LAYOUT_LONG, false));
	TEST_ASSERT_EQUAL_HEX64(0x8000, bits(&of, LAYOUT_SHORT, false));
	TEST_ASSERT_EQUAL_HEX64(0x7fc00000, bits(&large, LAYOUT_FLOAT, false));
	for (int i = LAYOUT_DOUBLE; i <= LAYOUT_FLAGS; i++)
		TEST_ASSERT_EQUAL(i <= LAYOUT_SHORT, layout_is_value((enum layout_field)i));
}

static void test_what_stands_beside_a_value_is_as_it_is(void)
{
	struct layout_row of = {.quality = 0x18,
	                        .age_ns = 70000 * INT64_C(1000000000) + 99999999,
	                        .alarm = 0x0301,
	                        .count = 65535,
	                        .flags = LAYOUT_FLAG_OUTPUT,
	                        .decimals = 3};
	uint16_t pair[2];

	TEST_ASSERT_EQUAL_HEX64(0x18, bits(&of, LAYOUT_QUALITY, false));
	TEST_ASSERT_EQUAL_UINT64(700000, bits(&of, LAYOUT_AGE, false));
	TEST_ASSERT_EQUAL_HEX64(0x0301, bits(&of, LAYOUT_ALARM, false));
	TEST_ASSERT_EQUAL_HEX64(65535, bits(&of, LAYOUT_COUNT, false));
	TEST_ASSERT_EQUAL_HEX64(LAYOUT_FLAG_OUTPUT, bits(&of, LAYOUT_FLAGS, false));
	TEST_ASSERT_EQUAL_HEX64(3, bits(&of, LAYOUT_DECIMALS, false));
	TEST_ASSERT_EQUAL_HEX64(0, bits(&of, LAYOUT_HEADER, false));
	of.age_ns = -1;
	TEST_ASSERT_EQUAL_HEX64(0xffffffff, bits(&of, LAYOUT_AGE, false));
	of.age_ns = INT64_MAX;
	TEST_ASSERT_EQUAL_HEX64(0xffffffff, bits(&of, LAYOUT_AGE, false));
	layout_put_32(pair, LAYOUT_MAGIC_NUMBER, false);
	TEST_ASSERT_EQUAL_HEX16(0x4f57, pair[0]);
	layout_put_32(pair, LAYOUT_MAGIC_NUMBER, true);
	TEST_ASSERT_EQUAL_HEX16(0x5344, pair[0]);
}

static void test_a_number_comes_back_from_its_registers_and_none_from_what_is_bad(void)
{
	static const double numbers[] = {0, 21.5, -3.25, 300, -300};

	for (int field = LAYOUT_DOUBLE; field <= LAYOUT_SHORT; field++)
		for (size_t i = 0; i < 2 * sizeof(numbers) / sizeof(numbers[0]); i++) {
			struct layout_row of = row(numbers[i / 2]);
			uint16_t words[LAYOUT_FIELD_MOST];
			bool little = i & 1;
			double number = 99;

			for (unsigned k = 0; k < 2; k++) {
				for (unsigned part = 0;
				     part < layout_width((enum layout_field)field); part++)
					words[part] = layout_register(
						&of,
						&(struct layout_place){
							.field = (enum layout_field)field,
							.part = part},
						little);
				TEST_ASSERT_EQUAL(of.good,
				                  layout_number(words, (enum layout_field)field, 2,
				                                little, &number));
				if (of.good)
					TEST_ASSERT_EQUAL_DOUBLE(numbers[i / 2], number);
				of.good = false;
			}
		}
}

static void test_a_number_with_decimals_is_the_one_that_it_looks_like(void)
{
	const uint16_t words[] = {57, 0};
	double number;

	for (unsigned decimals = 0; decimals < 7; decimals++) {
		char text[16];

		snprintf(text, sizeof(text), "57e-%u", decimals);
		TEST_ASSERT_TRUE(layout_number(words, LAYOUT_SHORT, decimals, false, &number));
		TEST_ASSERT_TRUE(number == strtod(text, NULL)); /* Max may be that */
		TEST_ASSERT_TRUE(layout_number(words, LAYOUT_LONG, decimals, true, &number));
		TEST_ASSERT_TRUE(number == strtod(text, NULL));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_number_with_decimals_is_the_one_that_it_looks_like);
	RUN_TEST(test_a_record_has_its_fields_in_their_order);
	RUN_TEST(test_rows_of_a_kind_have_each_place_once_and_no_address_is_two_things);
	RUN_TEST(test_a_number_has_the_bits_of_ieee_754_and_the_word_order_that_is_asked_for);
	RUN_TEST(test_whole_numbers_are_rounded_and_what_does_not_fit_is_bad);
	RUN_TEST(test_what_is_not_good_is_no_number_in_any_field);
	RUN_TEST(test_what_stands_beside_a_value_is_as_it_is);
	RUN_TEST(test_a_number_comes_back_from_its_registers_and_none_from_what_is_bad);
	return UNITY_END();
}
