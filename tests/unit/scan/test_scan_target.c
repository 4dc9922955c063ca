/* SPDX-License-Identifier: MIT */
/* Paths and texts of the verbs that open a target. */
#include <stdlib.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "src/scan/device.h"
#include "src/scan/kind.h"
#include "src/scan/target.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void check_unpadded(const char *expected, const char *text)
{
	char copy[128];
	size_t len = strlen(text);

	strcpy(copy, text);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(strlen(expected), target_unpad(copy, len), text);
	TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(expected, copy, strlen(expected), text);
}

static void test_padding_before_numbers_is_taken_off(void)
{
	check_unpadded("21.5", "        21.5");
	check_unpadded("-5.0625", "     -5.0625");
	check_unpadded("39", "          39");
	check_unpadded("1.5E-07", "     1.5E-07");
	check_unpadded("1.25,-2,3E+10", "        1.25,          -2,       3E+10");
	check_unpadded("1,0,1", "1,0,1");
}

static void test_text_that_is_no_padded_number_stays(void)
{
	check_unpadded("", "");
	check_unpadded(" ", " ");
	check_unpadded("            ", "            ");
	check_unpadded("  21.5", "  21.5");
	check_unpadded("     DS18B20", "     DS18B20");
	check_unpadded("        21.5,", "        21.5,");
	check_unpadded("        21.5,        x1.5", "        21.5,        x1.5");
	check_unpadded("Mon Jan  1", "Mon Jan  1");
}

static void test_numbers_are_those_that_json_has(void)
{
	static const char *const yes[] = {"0", "-1", "21.5", "1E+10", "1e5", "-0.25", "100"},
				 *const no[] = {"",   "-",    ".5",  "5.", "01",
	                                        "1E", "0x1F", "nan", "1 ", "+1"};

	for (size_t i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(target_is_number(yes[i], strlen(yes[i])), yes[i]);
	for (size_t i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(target_is_number(no[i], strlen(no[i])), no[i]);
}

static void check_path(const char *expected, bool expected_fresh, const char *given)
{
	char path[256];
	bool fresh;

	TEST_ASSERT_TRUE(target_path(given, path, &fresh));
	TEST_ASSERT_EQUAL_STRING(expected, path);
	TEST_ASSERT_EQUAL(expected_fresh, fresh);
}

static void test_uncached_is_taken_from_the_path(void)
{
	char path[256], longest[256];
	bool fresh;

	check_path("/28.1/temperature", false, "28.1/temperature");
	check_path("/28.1", true, "/uncached/28.1");
	check_path("/28.1", true, "uncached/28.1");
	check_path("/", true, "/uncached");
	check_path("/", false, "/");
	check_path("/uncachedx", false, "/uncachedx");
	memset(longest, 'x', sizeof(longest));
	longest[0] = '/';
	longest[255] = '\0';
	TEST_ASSERT_TRUE(target_path(longest, path, &fresh));
	longest[0] = 'x';
	TEST_ASSERT_FALSE(target_path(longest, path, &fresh));
}

/* "PIO.BYTE" is PIO with an extension, "temperature" itself. */
static const struct property *find(const struct family *family, const char *name)
{
	return family_property(family, NULL, name, strcspn(name, "."));
}

static void test_what_a_scan_reads_is_there_in_our_own_families(void)
{
	unsigned properties = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);
		const struct scan_kind *kind = scan_kind_of(family->code);

		for (unsigned i = 0; kind && i < SCAN_PROPERTIES && kind->property[i].name; i++) {
			const struct property *property = find(family, kind->property[i].name);

			TEST_ASSERT_NOT_NULL_MESSAGE(property, kind->property[i].name);
			if (kind->property[i].output)
				TEST_ASSERT_NOT_NULL(property_writer(family, property));
			properties++;
		}
	}
	TEST_ASSERT_GREATER_THAN_UINT(20, properties);
}

static void test_an_identity_is_asked_for_where_our_families_have_one(void)
{
	for (int code = 1; code < 256; code++) {
		const struct family *family = family_of((uint8_t)code);

		TEST_ASSERT_EQUAL_INT(family_property(family, NULL, "identity", 8) != NULL,
		                      scan_has_identity((uint8_t)code));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_padding_before_numbers_is_taken_off);
	RUN_TEST(test_text_that_is_no_padded_number_stays);
	RUN_TEST(test_numbers_are_those_that_json_has);
	RUN_TEST(test_uncached_is_taken_from_the_path);
	RUN_TEST(test_what_a_scan_reads_is_there_in_our_own_families);
	RUN_TEST(test_an_identity_is_asked_for_where_our_families_have_one);
	return UNITY_END();
}
