/* SPDX-License-Identifier: MIT */
/* The digits of a number that owsctl shows to a person: those of the chip. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "hal/chips/facts.h"
#include "src/daemon/engine/table.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/reading.h"
#include "src/ground/signal/value.h"

static struct reading reading;

void setUp(void)
{
}
void tearDown(void)
{
}

/* As reading_get() leaves it. */
static void be(enum ows_type type, double number)
{
	reading.value = (struct ows_value){.type = (uint8_t)type,
	                                   .quality = OWS_Q_GOOD,
	                                   .number = number,
	                                   .integer = (int64_t)number};
	reading.err = 0;
	value_to_text(type, value_is_float(type) ? value_of_double(number) : (int64_t)number,
	              reading.text);
	reading.len = strlen(reading.text);
}

/* As the image has them of a signal that is not scaled. */
static int decimals_of(const char *path)
{
	struct config_item item = {.path = path, .type = OWS_DOUBLE, .decimals = -1};
	struct image_meta meta;

	signal_table_meta(&item, &meta);
	return (int)meta.decimals;
}

static void test_a_number_has_the_digits_of_its_chip(void)
{
	static const struct {
		const char *path;
		double number;
		const char *text;
	} rows[] = {
		{"/26.551DDF030000/humidity", 48.370479432335586, "48.4"},
		{"/26.551DDF030000/humidity", 48.999, "49"},
		{"/26.551DDF030000/VDD", 5.0199999999999996, "5.02"},
		{"/26.551DDF030000/temperature", 21.03125, "21"},
		{"/28.551DDF030000/temperature", 21.1875, "21.2"},
		{"/28.551DDF030000/temperature", 21.5, "21.5"},
		{"/28.551DDF030000/temperature", -0.0625, "-0.1"},
		{"/28.551DDF030000/temperature", -0.03, "0"},
		{"/28.551DDF030000/temperature9", 20, "20"},
		{"/28.551DDF030000/temperature", 100, "100"},
		{"/26.551DDF030000/humidity", -0.001, "0"},
		{"/cellar/humidity", 48.370479432335586, "48.4"},
		{"/30.551DDF030000/volt", 3.6990399999999997, "3.699"},
		{"/26.551DDF030000/vis", 0.0249, "0.0249"},
		{"/1D.551DDF030000/counters.A", 12000, "12000"},
		{"/26.551DDF030000/humidity", -0.06, "-0.1"},
		{"/EF.551DDF030000/odd", 48.370479432335586, "48.370479432335586"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		be(OWS_DOUBLE, rows[i].number);
		reading_round(&reading, decimals_of(rows[i].path));
		TEST_ASSERT_EQUAL_STRING(rows[i].text, reading.text);
		TEST_ASSERT_EQUAL_size_t(strlen(reading.text), reading.len);
	}
}

static void test_integers_strings_and_driver_signals_stay_as_they_are(void)
{
	be(OWS_LONG, 21);
	reading_round(&reading, decimals_of("/28.551DDF030000/temperature"));
	TEST_ASSERT_EQUAL_STRING("21", reading.text);
	be(OWS_DOUBLE, 0.123456789);
	reading_round(&reading, -1);
	TEST_ASSERT_EQUAL_STRING("0.123456789", reading.text);
	be(OWS_STRING, 0);
	strcpy(reading.text, "1.23456789");
	reading_round(&reading, decimals_of("/26.551DDF030000/VDD"));
	TEST_ASSERT_EQUAL_STRING("1.23456789", reading.text);
	be(OWS_DOUBLE, (double)INFINITY);
	reading_round(&reading, decimals_of("/26.551DDF030000/VDD"));
	TEST_ASSERT_EQUAL_STRING("inf", reading.text);
	be(OWS_DOUBLE, 1e300);
	reading_round(&reading, decimals_of("/26.551DDF030000/VDD"));
	TEST_ASSERT_DOUBLE_WITHIN(1e285, 1e300, strtod(reading.text, NULL));
}

/* As an image may say that nobody of us has made. */
static void test_decimals_without_end_take_no_time(void)
{
	static const int decimals[] = {100, 290489133, INT_MAX};
	clock_t begin = clock();

	for (size_t i = 0; i < sizeof(decimals) / sizeof(decimals[0]); i++) {
		be(OWS_DOUBLE, 0.1);
		reading_round(&reading, decimals[i]);
		TEST_ASSERT_EQUAL_STRING("0.1", reading.text);
	}
	TEST_ASSERT_LESS_THAN_INT64(CLOCKS_PER_SEC, clock() - begin);
}

/* All that a person wants, and no more than the chip resolves; what is no measurement has all. */
static void test_each_unit_has_its_decimals(void)
{
	struct quantity quantity = {.least = -55, .most = 125, .unit = "\u00b0C"};

	TEST_ASSERT_EQUAL_INT(1, unit_decimals("\u00b0C"));
	TEST_ASSERT_EQUAL_INT(3, unit_decimals("V"));
	TEST_ASSERT_EQUAL_INT(-1, unit_decimals("furlong"));
	TEST_ASSERT_EQUAL_INT(-1, unit_decimals(""));
	for (int decimals = -1; decimals < 6; decimals++) {
		quantity.decimals = decimals;
		TEST_ASSERT_EQUAL_INT(decimals < 1 ? decimals : 1, quantity_decimals(&quantity));
	}
	quantity = (struct quantity){.least = -0.25, .most = 0.25, .unit = "V", .decimals = 7};
	TEST_ASSERT_EQUAL_INT(5, quantity_decimals(&quantity));
	quantity = (struct quantity){.least = 0, .most = 100, .unit = "furlong", .decimals = 7};
	TEST_ASSERT_EQUAL_INT(7, quantity_decimals(&quantity));
}

static void test_a_script_loses_no_digit_that_a_chip_resolves(void)
{
	static const struct {
		double number;
		int decimals;
		const char *text;
	} rows[] = {
		{21.0625, 1, "21.0625"},
		{-0.0625, 1, "-0.0625"},
		{3.6990399999999997, 3, "3.69904"},
		{0.000244140625, 3, "0.000244141"},
		{1.25e-8, 3, "0.0000000125"},
		{0.1 + 0.2, 1, "0.3"},
		{1.2e-15, 1, "0"},
		{0, 1, "0"},
		{123456.7890627, 1, "123456.789063"},
		{1.23456789, 8, "1.23456789"},
		{1.23456789e-9, -1, "1.23456789e-09"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		be(OWS_DOUBLE, rows[i].number);
		reading_round(&reading, digits_of_script(rows[i].number, rows[i].decimals));
		TEST_ASSERT_EQUAL_STRING(rows[i].text, reading.text);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_number_has_the_digits_of_its_chip);
	RUN_TEST(test_integers_strings_and_driver_signals_stay_as_they_are);
	RUN_TEST(test_decimals_without_end_take_no_time);
	RUN_TEST(test_each_unit_has_its_decimals);
	RUN_TEST(test_a_script_loses_no_digit_that_a_chip_resolves);
	return UNITY_END();
}
