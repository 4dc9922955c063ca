/* SPDX-License-Identifier: MIT */
/* Properties in paths, held against the families. */
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "src/config/check/property.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_every_property_of_every_family_is_known(void)
{
	unsigned count = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);
		const struct property *property = NULL;

		while ((property = family_next(family, NULL, property))) {
			bool is_array = property->array.index != INDEX_NONE;
			bool letters = property->array.index == INDEX_LETTERS;
			char path[128], first[8];

			extension_print(property, letters ? EXTENSION_LETTERS : 0, first);
			for (int form = 0; form < 3; form++) {
				bool all = form == 2 && property->array.count;

				snprintf(path, sizeof(path), "%s/%02X.000000000001/%s%s",
				         form == 1 ? "/uncached" : "", family->code, property->name,
				         all ? ".ALL" : first);
				TEST_ASSERT_TRUE_MESSAGE(property_look(path).exists, path);
			}
			/* an array without an element, an element of what has none */
			snprintf(path, sizeof(path), "/%02X.000000000001/%s%s", family->code,
			         property->name, is_array ? "" : ".0");
			if (property->type != PROPERTY_DIRECTORY) {
				struct path_property found = property_look(path);

				TEST_ASSERT_FALSE_MESSAGE(found.exists, path);
				TEST_ASSERT_EQUAL_MEMORY_MESSAGE(property->name, found.nearest,
				                                 strlen(property->name), path);
			}
			count++;
		}
	}
	TEST_ASSERT_TRUE(count > 200);
}

static void test_of_what_nobody_can_know_nothing_is_said(void)
{
	static const char *const paths[] = {
		"",
		"/",
		"/28.000000000001",
		"/28.000000000001/",
		"/kitchen/temprature",
		"/6F.000000000001/temprature",
		"/simultaneous/temprature",
		"gpiochip0/17",
		"/28.0000/x",
	};

	for (unsigned i = 0; i < sizeof(paths) / sizeof(paths[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(property_look(paths[i]).exists, paths[i]);
}

static void test_a_typing_error_is_answered_with_what_was_meant(void)
{
	static const struct {
		const char *path, *nearest;
	} rows[] = {
		{"/28.000000000001/temprature12", "temperature12"},
		{"/28.000000000001/Temperature", "temperature"},
		{"/29.000000000001/sensd.3", "sensed.3"},
		{"/29.000000000001/PIO_.BYTE", "PIO.BYTE"},
		{"/26.000000000001/humidty", "humidity"},
		{"/26.000000000001/HIH400/humidity", "HIH4000/humidity"},
		{"/29.000000000001/pro", "por"},
		{"/29.000000000001/latch", "latch.BYTE, or latch.0 to latch.7"},
		{"/29.000000000001/PIO.8", "PIO.BYTE, or PIO.0 to PIO.7"},
		{"/29.000000000001/PIO.BYT", "PIO.BYTE"},
		{"/20.000000000001/volt", "volt.A to volt.D"},
		{"/28.000000000001/temperature.3", "temperature"},
		{"/28.000000000001/quux", ""},
		{"/28.000000000001/quux.3", ""},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct path_property found = property_look(rows[i].path);

		TEST_ASSERT_FALSE_MESSAGE(found.exists, rows[i].path);
		TEST_ASSERT_EQUAL_STRING(rows[i].nearest, found.nearest);
	}
}

/* What is read shows something, what clears is written, and each latch that stays has a way out. */
static void test_the_families_say_of_alarms_what_can_be(void)
{
	unsigned count = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);
		const struct property *property = NULL;
		bool stays = false, clears = false;

		while ((property = family_next(family, NULL, property))) {
			count += property->alarm != 0;
			stays |= property->alarm & ALARM_STAYS;
			clears |= property->alarm & ALARM_CLEARS;
			if (property->alarm & (ALARM_LATCH | ALARM_POR))
				TEST_ASSERT_TRUE_MESSAGE(property->access & ACCESS_READ,
				                         property->name);
			if (property->alarm & (ALARM_CLEARS | ALARM_POR))
				TEST_ASSERT_TRUE_MESSAGE(property->access & ACCESS_WRITE,
				                         property->name);
			if (property->alarm & ALARM_STAYS)
				TEST_ASSERT_TRUE_MESSAGE(property->alarm & ALARM_LATCH,
				                         property->name);
		}
		TEST_ASSERT_TRUE_MESSAGE(clears || !stays, family->type);
	}
	TEST_ASSERT_GREATER_THAN_UINT(60, count);
}

static void test_what_an_alarm_may_name_is_proposed(void)
{
	char text[PROPERTY_NEAREST];

	TEST_ASSERT_TRUE(property_of_alarm("/29.000000000001/PIO.BYTE", ALARM_CLEARS, text));
	TEST_ASSERT_EQUAL_STRING("latch.BYTE, or latch.0 to latch.7", text);
	TEST_ASSERT_TRUE(property_of_alarm("/29.000000000001/PIO.BYTE", ALARM_POR, text));
	TEST_ASSERT_EQUAL_STRING("por", text);
	TEST_ASSERT_TRUE(property_of_alarm("/7E.000000000001/EDS0068/alarm/humidity_hi",
	                                   ALARM_CLEARS, text));
	TEST_ASSERT_EQUAL_STRING("EDS0068/alarm/clear", text);
	TEST_ASSERT_FALSE(property_of_alarm("/28.000000000001/temperature", ALARM_LATCH, text));
	TEST_ASSERT_FALSE(property_of_alarm("/board/latch.BYTE", ALARM_LATCH, text));
}

static void test_a_value_that_a_property_cannot_take_is_refused_with_the_reason(void)
{
	static const struct {
		const char *path, *value, *why; /* NULL: it takes it */
	} cases[] = {
		{"/29.000000000001/set_alarm", "133333333", NULL},
		{"/29.000000000001/set_alarm", "13333333", " has 9 digits"},
		{"/12.000000000001/set_alarm", "1111", " has 3 digits"},
		{"/12.000000000001/set_alarm", "999", " does not take this value"},
		{"/29.000000000001/latch.BYTE", "255", NULL},
		{"/29.000000000001/latch.BYTE", "256", " does not take this value"},
		{"/29.000000000001/latch.0", "off", NULL},
		{"/29.000000000001/latch.0", "O", " does not take this value"},
		{"/29.000000000001/latch.ALL", "0,0", " does not take this value"},
		{"/28.000000000001/temphigh", "30.5", NULL},
		{"/28.000000000001/temphigh", "hot", " does not take this value"},
		{"/29.000000000001/LCD_H/message", "hot", NULL},
		{"/board/latch.0", "O", NULL},
		{"/29.000000000001/nothing", "O", NULL},
	};
	char why[PROPERTY_NEAREST];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_EQUAL_MESSAGE(!cases[i].why,
		                          property_takes(cases[i].path, cases[i].value, why),
		                          cases[i].path);
		if (cases[i].why)
			TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].why, why, cases[i].path);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_property_of_every_family_is_known);
	RUN_TEST(test_of_what_nobody_can_know_nothing_is_said);
	RUN_TEST(test_a_typing_error_is_answered_with_what_was_meant);
	RUN_TEST(test_the_families_say_of_alarms_what_can_be);
	RUN_TEST(test_what_an_alarm_may_name_is_proposed);
	RUN_TEST(test_a_value_that_a_property_cannot_take_is_refused_with_the_reason);
	return UNITY_END();
}
