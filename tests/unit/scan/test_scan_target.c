/* SPDX-License-Identifier: MIT */
/* Paths and texts of the verbs that open a target. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "src/faces/show/json.h"
#include "src/ground/signal/error.h"
#include "src/tool/scan/device.h"
#include "src/tool/scan/left_out.h"
#include "src/tool/scan/scan.h"
#include "src/tool/scan/target.h"

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
		TEST_ASSERT_TRUE_MESSAGE(json_is_number(yes[i], strlen(yes[i])), yes[i]);
	for (size_t i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(json_is_number(no[i], strlen(no[i])), no[i]);
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

static void test_a_target_that_was_lost_says_why(void)
{
	struct target target = {.down = true, .loss = {.text = "the adapter is gone"}};

	TEST_ASSERT_EQUAL_STRING("the adapter is gone", target_error(&target, -ECONNRESET));
	TEST_ASSERT_EQUAL_STRING("the adapter is gone", target_error(&target, -ENOTCONN));
	TEST_ASSERT_EQUAL_STRING(error_text(-ENOENT), target_error(&target, -ENOENT));
	target.down = false;
	TEST_ASSERT_EQUAL_STRING(error_text(-ECONNRESET), target_error(&target, -ECONNRESET));
}

/* "PIO.BYTE" is PIO with an extension, "temperature" itself. */
static const struct property *find(const struct family *family, const char *name)
{
	return family_property(family, NULL, name, strcspn(name, "."));
}

/* A chip of the family; it has all that any of them has. */
static struct scan_device chip_of(uint8_t family)
{
	return (struct scan_device){.family = family, .has = UINT64_MAX};
}

static void test_what_a_scan_reads_is_there_in_our_own_families(void)
{
	struct scan_property property;
	unsigned rows = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);
		struct scan_device device = chip_of(family->code);
		unsigned count = 0;

		for (const struct family_scan *s = family->scan; s && s->name; s++, rows++)
			TEST_ASSERT_NOT_NULL_MESSAGE(find(family, s->name), s->name);
		for (; scan_property(&device, count, &property); count++) {
			TEST_ASSERT_NOT_NULL_MESSAGE(find(family, property.name), property.name);
			TEST_ASSERT_NOT_EQUAL_MESSAGE('\0', property.word[0], property.name);
			if (property.output)
				TEST_ASSERT_NOT_NULL(
					property_writer(family, find(family, property.name)));
		}
		TEST_ASSERT_EQUAL_MESSAGE(family->scan != NULL, count > 0, family->type);
	}
	TEST_ASSERT_GREATER_THAN_UINT(80, rows);
}

/* A chip has what is in its directory, and no more than there is room for. */
static void test_a_chip_of_a_family_with_kinds_has_what_its_list_has(void)
{
	struct scan_property property;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);

		for (unsigned k = 0; family->scan && family->scan[k].name; k++) {
			struct scan_device device = {.family = family->code};
			size_t len = strcspn(family->scan[k].name, "/");
			unsigned count = 0;

			for (unsigned i = 0; family->scan[i].name; i++)
				if (strcspn(family->scan[i].name, "/") == len &&
				    !memcmp(family->scan[i].name, family->scan[k].name, len))
					device.has |= UINT64_C(1) << i;
			while (scan_property(&device, count, &property))
				count++;
			TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(0, count, family->scan[k].name);
			TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(SCAN_PROPERTIES, count,
			                                       family->scan[k].name);
			TEST_ASSERT_LESS_THAN_UINT_MESSAGE(64, k, family->scan[k].name);
		}
	}
	TEST_ASSERT_FALSE(scan_property(&(struct scan_device){.family = 0x7e}, 0, &property));
}

/* What a family measures is not left out of the configurations that a scan makes. */
static void test_each_family_that_measures_has_something_to_scan(void)
{
	unsigned measuring = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);
		bool measures = false;

		for (unsigned i = 0; i < family->count; i++) {
			const struct property *row = &family->properties[i];

			measures |= row->measures.unit[0] && row->measures.decimals >= 0 &&
			            !row->hidden && !(row->access & ACCESS_WRITE) &&
			            row->life == LIFE_VOLATILE;
		}
		measuring += measures;
		if (measures)
			TEST_ASSERT_NOT_NULL_MESSAGE(family->scan, family->type);
	}
	TEST_ASSERT_GREATER_THAN_UINT(25, measuring);
}

static void test_each_element_of_an_array_has_a_name(void)
{
	struct scan_device device = chip_of(0xef);
	struct scan_property property;
	unsigned i = 0;

	while (scan_property(&device, i, &property) &&
	       strcmp(property.name, "multitemp/temperature.5") != 0)
		i++;
	TEST_ASSERT_EQUAL_STRING("multitemp/temperature.5", property.name);
	TEST_ASSERT_EQUAL_STRING("temperature_5", property.word);
	TEST_ASSERT_FALSE(scan_property(&device, i + 1, &property));
}

static void check_left_out(struct scan_device device, const char *expected)
{
	char names[512];

	scan_left_out(&device, names, sizeof(names));
	TEST_ASSERT_EQUAL_STRING(expected, names);
}

/* Other forms of what has a signal are not named: temperature9, latesttemp, HIH4000/humidity. */
static void test_what_measures_and_has_no_signal_is_named(void)
{
	struct scan_device chip = chip_of(0x26);

	check_left_out(chip, "B1-R1-A/pressure, S3-R1-A/current, S3-R1-A/illuminance, vis");
	check_left_out(chip_of(0x28), "");
	check_left_out(chip_of(0x29), "");
	check_left_out(chip_of(0x42), "PIO, latch, sensed");
	/* a TMP1826: it has temperature alone */
	for (unsigned i = 1; i < SCAN_PROPERTIES; i++)
		chip.value[i].err = -ENOENT;
	check_left_out(chip, "");
	/* the sixth row is of an EDS0066, and what is left out is so, too */
	check_left_out((struct scan_device){.family = 0x7e, .has = 1 << 6},
	               "EDS0066/inHg, EDS0066/pressure");
}

static void test_names_that_have_no_room_are_cut(void)
{
	struct scan_device chip = chip_of(0x42);
	char names[8];

	scan_left_out(&chip, names, sizeof(names));
	TEST_ASSERT_EQUAL_STRING("PIO, la", names);
}

static void check_signal(uint8_t code, const char *name, enum ows_type type, bool output,
                         unsigned per_factor)
{
	struct scan_device device = chip_of(code);
	struct scan_property property;
	unsigned i = 0;

	while (scan_property(&device, i, &property) && strcmp(property.name, name) != 0)
		i++;
	TEST_ASSERT_EQUAL_STRING(name, property.name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(type, property.type, name);
	TEST_ASSERT_EQUAL_MESSAGE(output, property.output, name);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(per_factor, property.per_factor, name);
}

static void test_the_type_of_a_signal_is_that_of_the_property(void)
{
	check_signal(0x28, "temperature12", OWS_DOUBLE, false, 10);
	check_signal(0x26, "VDD", OWS_DOUBLE, false, 10);
	check_signal(0x01, "present", OWS_BOOL, false, 0);
	check_signal(0x05, "PIO", OWS_BOOL, true, 0);
	check_signal(0x3a, "sensed.BYTE", OWS_BYTE, false, 0);
	check_signal(0x3a, "PIO.BYTE", OWS_BYTE, true, 0);
	check_signal(0x1d, "counter.B", OWS_DWORD, false, 0);
	check_signal(0x30, "amphours", OWS_DOUBLE, false, 10);
	check_signal(0x7e, "EDS0068/pressure", OWS_DOUBLE, false, 10);
	check_signal(0x7e, "EDS0068/light", OWS_DWORD, false, 10);
	check_signal(0x7e, "EDS0090/output/set.BYTE", OWS_BYTE, true, 0);
	check_signal(0xa0, "RPM", OWS_LONG, false, 10);
}

static void test_an_identity_is_asked_for_where_the_code_does_not_tell(void)
{
	TEST_ASSERT_EQUAL_STRING("identity", scan_identity(0x28));
	TEST_ASSERT_EQUAL_STRING("device_type", scan_identity(0x7e));
	TEST_ASSERT_NULL(scan_identity(0x10));
	TEST_ASSERT_NULL(scan_identity(0xfa));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_padding_before_numbers_is_taken_off);
	RUN_TEST(test_text_that_is_no_padded_number_stays);
	RUN_TEST(test_numbers_are_those_that_json_has);
	RUN_TEST(test_a_target_that_was_lost_says_why);
	RUN_TEST(test_uncached_is_taken_from_the_path);
	RUN_TEST(test_what_a_scan_reads_is_there_in_our_own_families);
	RUN_TEST(test_a_chip_of_a_family_with_kinds_has_what_its_list_has);
	RUN_TEST(test_each_family_that_measures_has_something_to_scan);
	RUN_TEST(test_each_element_of_an_array_has_a_name);
	RUN_TEST(test_what_measures_and_has_no_signal_is_named);
	RUN_TEST(test_names_that_have_no_room_are_cut);
	RUN_TEST(test_the_type_of_a_signal_is_that_of_the_property);
	RUN_TEST(test_an_identity_is_asked_for_where_the_code_does_not_tell);
	return UNITY_END();
}
