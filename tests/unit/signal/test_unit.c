/* SPDX-License-Identifier: MIT */
/* Units: spellings, quantities, conversions. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/unit.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_a_value_is_converted_and_back(void)
{
	static const struct {
		const char *from, *to;
		double value, converted;
	} rows[] = {
		{"°C", "°F", 21, 69.8},
		{"°C", "F", -40, -40},
		{"°C", "K", 0, 273.15},
		{"°F", "°C", 212, 100},
		{"°F", "K", 32, 273.15},
		{"°C", "Cel", 21.5, 21.5},
		{"K", "°F", 0.5, 0.9}, /* a difference */
		{"K", "°C", 0.5, 0.5},
		{"mbar", "hPa", 1013.25, 1013.25},
		{"mbar", "kPa", 1013.25, 101.325},
		{"mbar", "psi", 1013.25, 14.6959},
		{"inHg", "mbar", 29.9213, 1013.25},
		{"V", "mV", 0.25, 250},
		{"A", "mA", 0.005, 5},
		{"\u00b5A", "uA", 3, 3},
		{"s", "h", 5400, 1.5},
		{"rpm", "Hz", 950, 15.8333},
		{"m/s", "km/h", 10, 36},
		{"%", "%", 45, 45},
		{"ppm", "ppm", 400, 400},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		double factor = 0, offset = 0;

		TEST_ASSERT_TRUE_MESSAGE(unit_convert(rows[i].from, rows[i].to, &factor, &offset),
		                         rows[i].to);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4 * fmax(1, fabs(rows[i].converted)),
		                                  rows[i].converted,
		                                  rows[i].value * factor + offset, rows[i].to);
	}
}

static void test_what_is_of_another_quantity_or_not_known_is_refused(void)
{
	static const char *const pairs[][2] = {{"°C", "V"},   {"°C", "foo"}, {"foo", "°C"},
	                                       {"mbar", "C"}, {"ppm", "Vh"}, {"°C", ""},
	                                       {"", "°C"},    {"V", "A"},    {"°C", " "}};

	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		double factor = 7, offset = 8;

		TEST_ASSERT_FALSE_MESSAGE(unit_convert(pairs[i][0], pairs[i][1], &factor, &offset),
		                          pairs[i][1]);
		TEST_ASSERT_EQUAL_DOUBLE(7, factor);
		TEST_ASSERT_EQUAL_DOUBLE(8, offset);
	}
}

static void test_a_spelling_has_one_symbol(void)
{
	TEST_ASSERT_EQUAL_STRING("m³", unit_symbol("m3"));
	TEST_ASSERT_EQUAL_STRING("m³/h", unit_symbol("m3/h"));
	TEST_ASSERT_EQUAL_STRING("°C", unit_symbol("C"));
	TEST_ASSERT_EQUAL_STRING("°F", unit_symbol("[degF]"));
	TEST_ASSERT_EQUAL_STRING("K", unit_symbol("K"));
	TEST_ASSERT_EQUAL_STRING("lx", unit_symbol("lux"));
	TEST_ASSERT_NULL(unit_symbol("pulses"));
	TEST_ASSERT_NULL(unit_symbol(""));
}

static void test_units_have_the_class_that_home_assistant_knows(void)
{
	TEST_ASSERT_EQUAL_STRING("temperature", unit_class("°C"));
	TEST_ASSERT_EQUAL_STRING("temperature", unit_class("°F"));
	TEST_ASSERT_EQUAL_STRING("pressure", unit_class("inHg"));
	TEST_ASSERT_EQUAL_STRING("voltage", unit_class("mV"));
	TEST_ASSERT_NULL(unit_class("K"));
	TEST_ASSERT_NULL(unit_class("%"));
	TEST_ASSERT_NULL(unit_class(""));
}

static void test_the_units_of_a_quantity_are_listed(void)
{
	char text[200];

	unit_list("°C", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("°C, °F, K", text);
	unit_list("K", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("K, °C, °F", text);
	unit_list("ppm", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("ppm", text);
	unit_list("foo", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("", text);
	unit_list("mbar", text, 8);
	TEST_ASSERT_EQUAL_STRING("mbar, h", text);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_is_converted_and_back);
	RUN_TEST(test_what_is_of_another_quantity_or_not_known_is_refused);
	RUN_TEST(test_a_spelling_has_one_symbol);
	RUN_TEST(test_units_have_the_class_that_home_assistant_knows);
	RUN_TEST(test_the_units_of_a_quantity_are_listed);
	return UNITY_END();
}
