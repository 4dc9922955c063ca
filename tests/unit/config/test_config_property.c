/* SPDX-License-Identifier: MIT */
/* Properties in paths, held against the families. */
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "src/config/property.h"

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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_property_of_every_family_is_known);
	RUN_TEST(test_of_what_nobody_can_know_nothing_is_said);
	RUN_TEST(test_a_typing_error_is_answered_with_what_was_meant);
	return UNITY_END();
}
