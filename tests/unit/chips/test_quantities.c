/* SPDX-License-Identifier: MIT */
/*
 * Each property of each family that measures something has a quantity: a unit, unless it is a plain
 * number, and, where it is a reading, a range.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/facts.h"
#include "hal/chips/find.h"

void setUp(void)
{
}
void tearDown(void)
{
}

/* Words in the names of whole numbers that are measured or counted; the others have decimals. */
static const char *const words[] = {
	"ampere",    "altitude", "count", "cps",    "current", "cycle", "humidity",
	"intensity", "illumina", "level", "light",  "lux",     "moist", "ppm",
	"pressure",  "pulse",    "raw",   "resist", "RPM",     "samp",  "seconds",
	"sensor",    "speed",    "temp",  "thresh", "vib",     "volt",
};

/* Numbers of which nobody can say a unit: why. */
static const struct {
	uint8_t family;
	const char *name, *reason;
} others[] = {
	{0x22, "tempres", "bits"},
	{0x26, "tempres", "bits"},
	{0x28, "tempres", "bits"},
	{0x30, "WS603/calibration/wind_speed", "a factor"},
	{0x30, "WS603/light/intensity", "no data sheet says its scale"},
	{0x30, "WS603/light/threshold", "no data sheet says its scale"},
	{0x30, "WS603/volt", "no data sheet says its scale"},
	{0x35, "alarm_set", "no data sheet says its scale"},
	{0x3b, "tempres", "bits"},
	{0x42, "tempres", "bits"},
	{0x7e, "EDS0071/raw", "of the converter"},
	{0x7e, "EDS0072/raw", "of the converter"},
	{0xa6, "tempres", "bits"},
	{0xfc, "910/alcps", "registers of a program: it decides"},
	{0xfc, "910/cps", "registers of a program: it decides"},
	{0xfc, "910/maxcps", "registers of a program: it decides"},
	{0xfc, "911/timers/countdown", "a timer"},
	{0xfc, "911/timers/countdown_number", "which of the timers"},
};

/* Quantities that are plain numbers although they have decimals, or whose unit nobody knows. */
static const char *const plain[] = {"humidex", "UVI", "vib_", "gain"};

/* Readings without an end: of a sensor of any make, or computed. */
static const char *const endless[] = {"B1-R1-A/pressure", "S3-R1-A/illuminance", "heat_index",
                                      "humidex",          "wind_speed",          "T8A/volt",
                                      "altitude"};

static bool has_word(const char *name, const char *const *list, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (strstr(name, list[i]))
			return true;
	return false;
}
#define HAS(name, list) has_word(name, list, sizeof(list) / sizeof((list)[0]))

static bool is_number(enum property_type type)
{
	switch (type) {
	case PROPERTY_FLOAT:
	case PROPERTY_INTEGER:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
	case PROPERTY_TEMPGAP:
	case PROPERTY_UNSIGNED:
		return true;
	case PROPERTY_ALIAS:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
	case PROPERTY_BITS:
	case PROPERTY_DATE:
	case PROPERTY_DIRECTORY:
	case PROPERTY_YESNO:
		break;
	}
	return false;
}

/* All with decimals, and whole numbers by the last part of their names. */
static bool measures(const struct property *property)
{
	const char *slash = strrchr(property->name, '/');

	if (!is_number(property->type))
		return false;
	return (property->type != PROPERTY_UNSIGNED && property->type != PROPERTY_INTEGER) ||
	       HAS(slash ? slash + 1 : property->name, words);
}

static bool is_excepted(const struct family *family, const struct property *property)
{
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		if (others[i].family == family->code && !strcmp(others[i].name, property->name))
			return true;
	return false;
}

struct found {
	const struct family *family;
	const struct property *property;
	char path[80];
};

/* The next property that measures; false: that was the last. */
static bool next_measured(unsigned *n, unsigned *i, struct found *found)
{
	static const char *const element[] = {
		[INDEX_NONE] = "", [INDEX_NUMBERS] = ".0", [INDEX_LETTERS] = ".A"};

	for (; (found->family = family_nth(*n)); ++*n, *i = 0)
		while (!found->family->is_virtual && *i < found->family->count) {
			found->property = &found->family->properties[(*i)++];
			if (!measures(found->property))
				continue;
			snprintf(found->path, sizeof(found->path), "/%02X.112233445566/%s%s",
			         found->family->code, found->property->name,
			         element[found->property->array.index]);
			return true;
		}
	return false;
}

static void test_each_property_that_measures_has_a_unit(void)
{
	struct quantity quantity;
	unsigned n = 0, i = 0, missing = 0, count = 0;

	for (struct found found; next_measured(&n, &i, &found); count++) {
		const struct property *property = found.property;
		bool known = quantity_of(found.path, &quantity);

		if (known == is_excepted(found.family, property)) {
			printf("%s: %s\n", found.path, known ? "no exception" : "no quantity");
			missing++;
		} else if (known && !*quantity.unit && property->type != PROPERTY_UNSIGNED &&
		           property->type != PROPERTY_INTEGER && !HAS(property->name, plain)) {
			printf("%s: no unit\n", found.path);
			missing++;
		}
	}
	TEST_ASSERT_GREATER_THAN(300, count);
	TEST_ASSERT_EQUAL_UINT(0, missing);
}

/* A setting is what somebody wrote. */
static bool is_reading(const struct property *property)
{
	return !(property->access & ACCESS_WRITE) &&
	       (property->life == LIFE_VOLATILE || property->life == LIFE_SECOND);
}

static void test_each_reading_has_the_range_and_resolution_of_its_chip(void)
{
	struct quantity quantity;
	unsigned n = 0, i = 0, missing = 0, count = 0;

	for (struct found found; next_measured(&n, &i, &found);) {
		const struct property *property = found.property;

		if (!is_reading(property) || !quantity_of(found.path, &quantity))
			continue;
		count++;
		if (HAS(property->name, endless) ||
		    (quantity.decimals >= 0 && quantity.least > -HUGE_VAL &&
		     quantity.most < HUGE_VAL))
			continue;
		printf("%s: %g to %g, %d decimals\n", found.path, quantity.least, quantity.most,
		       quantity.decimals);
		missing++;
	}
	TEST_ASSERT_GREATER_THAN(150, count);
	TEST_ASSERT_EQUAL_UINT(0, missing);
}

/* What sensors report that are not there, and what a wire makes: of no thermometer it is true. */
static void test_no_thermometer_can_be_at_127_below_zero(void)
{
	static const char *const hot_and_cold[] = {"thermocouple", "type", "EDS0071", "EDS0072"};
	struct quantity quantity;
	unsigned n = 0, i = 0, missing = 0, count = 0;

	for (struct found found; next_measured(&n, &i, &found);) {
		const char *name = found.property->name;

		if (found.property->type != PROPERTY_TEMPERATURE || !is_reading(found.property))
			continue;
		count++;
		TEST_ASSERT_TRUE_MESSAGE(quantity_of(found.path, &quantity), found.path);
		if (!quantity_excludes(&quantity, -999.9) ||
		    (!quantity_excludes(&quantity, -127) && !HAS(name, hot_and_cold)) ||
		    quantity_excludes(&quantity, 20)) {
			printf("%s: %g to %g\n", found.path, quantity.least, quantity.most);
			missing++;
		}
	}
	TEST_ASSERT_GREATER_THAN(60, count);
	TEST_ASSERT_EQUAL_UINT(0, missing);
}

/* -40 degrees and 1 % make a dew point of -76; and a light sensor has an offset in the dark. */
static void test_what_is_computed_of_true_readings_is_not_refused(void)
{
	static const struct {
		const char *path;
		double number;
		bool excluded;
	} rows[] = {
		{"/7E.112233445566/EDS0065/dew_point", -76.4, false},
		{"/7E.112233445566/EDS0068/dew_point", -76.4, false},
		{"/7E.112233445566/EDS0068/heat_index", -93, false},
		{"/7E.112233445566/EDS0068/humidex", -64, false},
		{"/7E.112233445566/EDS0068/dew_point", -127, true},
		{"/7E.112233445566/EDS0068/heat_index", -127, true},
		{"/26.112233445566/S3-R1-A/current", -1.3, false},
		{"/26.112233445566/S3-R1-A/current", 641, false},
		{"/26.112233445566/S3-R1-A/current", -700, true},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct quantity quantity;

		TEST_ASSERT_TRUE_MESSAGE(quantity_of(rows[i].path, &quantity), rows[i].path);
		TEST_ASSERT_EQUAL_MESSAGE(rows[i].excluded,
		                          quantity_excludes(&quantity, rows[i].number),
		                          rows[i].path);
	}
}

/* Of an alias only the name of the property is known. */
static void test_a_name_has_the_same_unit_in_all_families(void)
{
	unsigned n = 0, i = 0, differ = 0;

	for (struct found found; next_measured(&n, &i, &found);) {
		struct quantity own, any;
		char path[80];

		snprintf(path, sizeof(path), "/boiler%s", strchr(found.path + 1, '/'));
		if (quantity_of(found.path, &own) &&
		    (!quantity_of(path, &any) || strcmp(own.unit, any.unit) != 0)) {
			printf("%s: \"%s\"\n", found.path, own.unit);
			differ++;
		}
	}
	TEST_ASSERT_EQUAL_UINT(0, differ);
}

static void test_the_type_gives_the_unit_of_a_setting(void)
{
	static const struct {
		const char *path, *unit;
	} rows[] = {
		{"/28.112233445566/temphigh", "\u00b0C"},
		{"/26.112233445566/tempoffset", "K"},
		{"/26.112233445566/B1-R1-A/offset", "mbar"},
		{"/26.112233445566/B1-R1-A/gain", ""},
		{"/7E.112233445566/EDS0070/threshold/vib_hi", ""},
		{"/7E.112233445566/EDS0082/threshold/volts_hi.1", "V"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct quantity quantity;

		TEST_ASSERT_TRUE_MESSAGE(quantity_of(rows[i].path, &quantity), rows[i].path);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(rows[i].unit, quantity.unit, rows[i].path);
		TEST_ASSERT_FALSE_MESSAGE(quantity_excludes(&quantity, 1e6), rows[i].path);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_property_that_measures_has_a_unit);
	RUN_TEST(test_each_reading_has_the_range_and_resolution_of_its_chip);
	RUN_TEST(test_no_thermometer_can_be_at_127_below_zero);
	RUN_TEST(test_what_is_computed_of_true_readings_is_not_refused);
	RUN_TEST(test_a_name_has_the_same_unit_in_all_families);
	RUN_TEST(test_the_type_gives_the_unit_of_a_setting);
	return UNITY_END();
}
