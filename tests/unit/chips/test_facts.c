/* SPDX-License-Identifier: MIT */
/* What the tables of the families say of a path: names, ranges, units and decimals. */
#include <math.h>
#include <stdio.h>

#include "unity.h"

#include "hal/chips/facts.h"
#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/wire/txn.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static struct quantity of(const char *path)
{
	struct quantity quantity;

	TEST_ASSERT_TRUE_MESSAGE(quantity_of(path, &quantity), path);
	return quantity;
}

static void test_thermometers_that_can_starve_are_known_in_every_spelling(void)
{
	static const char *const yes[] = {
		"/28.551DDF030000/temperature12",
		"/28551ddf030000/temperature",
		"/10.E466DA610B63/temperature",
		"/22.000000000000/fasttemp",
		"/3b.112233445566/latesttemp",
		"/42.112233445566/temperature9",
		"/bus.1/28.551DDF030000/temperature10",
		"/boiler/temperature",
		"/1F.112233445566/main/28.551DDF030000/temperature",
	};
	static const char *const no[] = {
		"/26.0CBEEA010000/temperature", "/26.0CBEEA010000/humidity",
		"/3B.112233445566/thermocouple", "/28.551DDF030000/templow"};
	static const char *const nothing[] = {
		"/28.551DDF030000/power",
		"/simultaneous/temperature",
		"/29.B89115000000/sensed.BYTE",
		"/",
		"",
		"/28.551DDF030000",
		"/boiler",
		"/28.551DDF030000/temperature13",
		"/28.551DDF030000/VDD",
		"/20.551DDF030000/vol",
		"/1F.112233445566/temperature",
	};

	for (unsigned i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(of(yes[i]).starves, yes[i]);
	for (unsigned i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(of(no[i]).starves, no[i]);
	for (unsigned i = 0; i < sizeof(nothing) / sizeof(nothing[0]); i++) {
		struct quantity quantity;

		TEST_ASSERT_FALSE_MESSAGE(quantity_of(nothing[i], &quantity), nothing[i]);
	}
}

/* What a chip may rightly say, and what none of its kind ever does. */
static void test_the_range_is_the_chips_own(void)
{
	static const struct {
		const char *path;
		double least, most, below, above;
	} rows[] = {
		{"/28.551DDF030000/temperature", -57, 127.5, -999.9, 200},
		{"/10.551DDF030000/temperature", -57, 127, -127.9, 1370},
		{"/22.551DDF030000/temperature11", -58, 128, -60, 130},
		{"/3B.551DDF030000/temperature", -40, 125, -273, 999},
		{"/3B.551DDF030000/thermocouple", -270, 1820, -300, 2048},
		{"/42.551DDF030000/temperature", -55, 125, -100, 150},
		{"/26.551DDF030000/temperature", -55, 150, -100, 152},
		{"/26.551DDF030000/VDD", 2.4, 10.23, 0, 76.78},
		{"/26.551DDF030000/VAD", 0, 10.23, -1, 10.24},
		{"/26.551DDF030000/vis", -0.2499584, 0.2497143, -0.3, 34.7},
		{"/26.551DDF030000/humidity", -2.5, 104, -26, 135},
		{"/26.551DDF030000/HIH4000/humidity", 0, 100, -33, 173},
		{"/26.551DDF030000/B1-R1-A/pressure", 300, 1150, -1, INFINITY},
		{"/20.551DDF030000/volt.A", 0, 5.11992, -0.001, 12},
		{"/20.551DDF030000/volt2.D", 0, 2.55996, -0.001, 5},
		{"/20.551DDF030000/latestvolt.B", 0, 5.11992, -5, 95.1},
		{"/41.551DDF030000/temperature", -42, 142, -45, 150},
		{"/1D.551DDF030000/counter.A", 0, 4294967295.0, -1, 4294967296.0},
		{"/1D.551DDF030000/counters.B", 0, 4294967295.0, -1, 1e12},
		{"/boiler/temperature", -273, 1e6, -274, INFINITY},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct quantity quantity = of(rows[i].path);

		TEST_ASSERT_FALSE_MESSAGE(quantity_excludes(&quantity, rows[i].least),
		                          rows[i].path);
		TEST_ASSERT_FALSE_MESSAGE(quantity_excludes(&quantity, rows[i].most), rows[i].path);
		TEST_ASSERT_TRUE_MESSAGE(quantity_excludes(&quantity, rows[i].below), rows[i].path);
		if (isfinite(rows[i].above))
			TEST_ASSERT_TRUE_MESSAGE(quantity_excludes(&quantity, rows[i].above),
			                         rows[i].path);
	}
}

static void test_a_reading_is_excluded_by_any_of_its_numbers(void)
{
	const struct property one = {.type = PROPERTY_FLOAT, .measures = {-10, 110, "%", 2, false}};
	const struct property list = {.type = PROPERTY_FLOAT,
	                              .array = {4, INDEX_LETTERS, true},
	                              .measures = {0, 5, "V", 2, false}};
	const struct property nothing = {.type = PROPERTY_FLOAT};
	struct txn txn = {.number = {1, 2, 278.4, 4}};

	TEST_ASSERT_FALSE(reading_excluded(&one, EXTENSION_NONE, &txn));
	TEST_ASSERT_FALSE(reading_excluded(&list, EXTENSION_LETTERS + 1, &txn));
	TEST_ASSERT_FALSE(reading_excluded(&nothing, EXTENSION_NONE, &txn));
	TEST_ASSERT_TRUE(reading_excluded(&list, EXTENSION_LETTERS + 2, &txn));
	TEST_ASSERT_EQUAL_DOUBLE(278.4, txn.number[0]);
	TEST_ASSERT_TRUE(reading_excluded(&one, EXTENSION_NONE, &txn));
	txn.number[0] = 1;
	TEST_ASSERT_TRUE(reading_excluded(&list, EXTENSION_ALL, &txn));
	TEST_ASSERT_EQUAL_DOUBLE(278.4, txn.number[0]);
	txn.number[0] = txn.number[2] = 5;
	TEST_ASSERT_FALSE(reading_excluded(&list, EXTENSION_ALL, &txn));
}

static void test_an_alias_excludes_only_what_nothing_can_measure(void)
{
	struct quantity quantity = of("/cellar/humidity");

	TEST_ASSERT_FALSE(quantity_excludes(&quantity, -1e9));
	TEST_ASSERT_FALSE(quantity_excludes(&quantity, 1e9));
	quantity = of("/oven/temperature");
	TEST_ASSERT_FALSE(quantity_excludes(&quantity, 1200));
	TEST_ASSERT_TRUE(quantity_excludes(&quantity, -999.9));
}

static void test_the_decimals_hold_one_step_of_the_chip(void)
{
	static const struct {
		const char *path;
		double step;
	} rows[] = {
		{"/28.551DDF030000/temperature", 0.0625},
		{"/28.551DDF030000/temperature9", 0.5},
		{"/28.551DDF030000/temperature10", 0.25},
		{"/28.551DDF030000/temperature11", 0.125},
		{"/28.551DDF030000/temperature12", 0.0625},
		{"/10.551DDF030000/temperature", 0.0625},
		{"/26.551DDF030000/temperature", 0.03125},
		{"/26.551DDF030000/VDD", 0.01},
		{"/3B.551DDF030000/thermocouple", 0.25},
		{"/28.551DDF030000/fasttemp", 0.5},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct quantity quantity = of(rows[i].path);
		double least = pow(10, -quantity.decimals);

		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-9, round(rows[i].step / least) * least,
		                                  rows[i].step, rows[i].path);
		least *= 10;
		TEST_ASSERT_TRUE_MESSAGE(fabs(round(rows[i].step / least) * least - rows[i].step) >
		                                 1e-9,
		                         rows[i].path);
	}
	TEST_ASSERT_EQUAL_INT(2, of("/26.551DDF030000/humidity").decimals);
	TEST_ASSERT_EQUAL_INT(2, of("/cellar/humidity").decimals);
}

static void test_a_device_is_called_as_its_property_or_its_family_says(void)
{
	static const struct {
		const char *path, *model;
	} rows[] = {
		{"/28.112233445566/temperature12", "DS18B20"},
		{"/bus.0/28.112233445566/temperature", "DS18B20"},
		{"/7E.112233445566/device_id", "EDS"},
		{"/7E.112233445566/EDS0068/temperature", "EDS0068"},
		{"/7E.112233445566/EDS0082/volts.3", "EDS0082"},
		{"/7E.112233445566/EDS0068", "EDS0068"},
		{"/7E.112233445566/EDS9999/temperature", "EDS"},
		{"/EF.112233445566/moisture/sensor.0", "HB_MOISTURE_METER"},
		{"/EF.112233445566/version", "HobbyBoards_EF"},
		{"/3B.112233445566/thermocouple", "MAX31850"},
		{"/FC.112233445566/910/count", "BAE"},
		{"/26.112233445566/temperature", "DS2438"},
		{"/19.112233445566/1.value", "DS28E17"},
		{"/28.112233445566", "DS18B20"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
		TEST_ASSERT_EQUAL_STRING_MESSAGE(rows[i].model, model_of(rows[i].path),
		                                 rows[i].path);
	TEST_ASSERT_NULL(model_of("/FA.112233445566/present"));
	TEST_ASSERT_NULL(model_of("/boiler/temperature"));
	TEST_ASSERT_NULL(model_of("/"));
	for (unsigned n = 0; family_nth(n); n++) {
		char path[40];

		snprintf(path, sizeof(path), "/%02X.112233445566/present", family_nth(n)->code);
		TEST_ASSERT_NOT_NULL_MESSAGE(model_of(path), path);
	}
}

static void test_what_is_known_without_the_device_does_not_show_it(void)
{
	static const char *const yes[] = {"/28.551DDF030000/temperature12",
	                                  "/28.551DDF030000/power",
	                                  "/29.B89115000000/sensed.BYTE",
	                                  "/29.B89115000000/PIO.3",
	                                  "/1F.112233445566/main/29.B89115000000/latch.ALL",
	                                  "/boiler/temperature",
	                                  "/29.B89115000000/no_such_thing"};
	static const char *const no[] = {"/28.551DDF030000/address",
	                                 "/28.551DDF030000/type",
	                                 "/29.B89115000000/r_id",
	                                 "/29.B89115000000/alias",
	                                 "/29.B89115000000/present",
	                                 "/bus.1/29B89115000000/present",
	                                 "/boiler/family",
	                                 "/boiler/present",
	                                 "/simultaneous/temperature",
	                                 "/29.B89115000000"};

	for (size_t i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(facts_shows_device(yes[i]), yes[i]);
	for (size_t i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(facts_shows_device(no[i]), no[i]);
}

static void test_a_latch_tells_of_the_alarm_of_switches_and_of_no_thermometer(void)
{
	static const char *const yes[] = {"/29.B89115000000", "/12.B89115000000/sensed.A",
	                                  "/bus.1/20.B89115000000", "/boiler"};
	static const char *const no[] = {"/28.551DDF030000/temperature", "/05.551DDF030000",
	                                 "/1F.112233445566/main/10.551DDF030000"};

	for (size_t i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(facts_latches(yes[i]), yes[i]);
	for (size_t i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(facts_latches(no[i]), no[i]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_latch_tells_of_the_alarm_of_switches_and_of_no_thermometer);
	RUN_TEST(test_what_is_known_without_the_device_does_not_show_it);
	RUN_TEST(test_thermometers_that_can_starve_are_known_in_every_spelling);
	RUN_TEST(test_the_range_is_the_chips_own);
	RUN_TEST(test_a_reading_is_excluded_by_any_of_its_numbers);
	RUN_TEST(test_an_alias_excludes_only_what_nothing_can_measure);
	RUN_TEST(test_the_decimals_hold_one_step_of_the_chip);
	RUN_TEST(test_a_device_is_called_as_its_property_or_its_family_says);
	return UNITY_END();
}
