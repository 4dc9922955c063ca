/* SPDX-License-Identifier: MIT */
/* Tests of OWFS paths and device ids. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"

static const uint8_t sensor[ROM_LEN] = {0x28, 0x55, 0x1d, 0xdf, 0x03, 0x00, 0x00, 0};

void setUp(void)
{
}

void tearDown(void)
{
}

static void slice_equals(const char *expected, struct path_slice slice, const char *note)
{
	TEST_ASSERT_EQUAL_size_t_MESSAGE(strlen(expected), slice.len, note);
	if (slice.len)
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(expected, slice.text, slice.len, note);
}

static struct path split(const char *text)
{
	struct path path;

	TEST_ASSERT_NULL_MESSAGE(path_split(text, strlen(text), &path), text);
	return path;
}

static void test_the_checksum_is_that_of_the_data_sheet(void)
{
	/* the example of Maxim's application note 27 */
	static const uint8_t rom[ROM_LEN] = {0x02, 0x1c, 0xb8, 0x01, 0x00, 0x00, 0x00, 0xa2};

	TEST_ASSERT_EQUAL_HEX8(0xa2, rom_crc8(rom, 7));
	TEST_ASSERT_EQUAL_HEX8(0, rom_crc8(rom, 8));
	TEST_ASSERT_EQUAL_HEX8(0, rom_crc8(rom, 0));
}

static void test_all_six_formats_in_any_case_are_one_id(void)
{
	static const enum rom_format formats[] = {ROM_F_I,  ROM_FI,   ROM_F_I_C,
	                                          ROM_F_IC, ROM_FI_C, ROM_FIC};
	uint8_t full[ROM_LEN], rom[ROM_LEN];
	char text[ROM_TEXT_MAX];

	memcpy(full, sensor, ROM_LEN);
	full[7] = rom_crc8(full, 7);
	for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++) {
		int n = rom_print(full, formats[i], text);

		TEST_ASSERT_EQUAL_INT((int)strlen(text), n);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, rom_parse(text, (size_t)n, rom), text);
		TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(full, rom, ROM_LEN, text);
		for (int j = 0; j < n; j++)
			if (text[j] >= 'A' && text[j] <= 'F' && (j & 1))
				text[j] = (char)(text[j] + 'a' - 'A');
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, rom_parse(text, (size_t)n, rom), text);
		TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(full, rom, ROM_LEN, text);
	}
	TEST_ASSERT_EQUAL_INT(15, rom_print(full, ROM_F_I, text));
	TEST_ASSERT_EQUAL_STRING("28.551DDF030000", text);
	TEST_ASSERT_EQUAL_INT(18, rom_print(full, ROM_F_I_C, text));
	TEST_ASSERT_EQUAL_STRING_LEN("28.551DDF030000.", text, 16);
}

static void test_a_wrong_checksum_is_refused_in_every_format_that_has_one(void)
{
	static const enum rom_format formats[] = {ROM_F_I_C, ROM_F_IC, ROM_FI_C, ROM_FIC};
	uint8_t full[ROM_LEN], rom[ROM_LEN];
	char text[ROM_TEXT_MAX];

	memcpy(full, sensor, ROM_LEN);
	full[7] = rom_crc8(full, 7);
	for (int bit = 0; bit < 64; bit++) {
		uint8_t bad[ROM_LEN];

		memcpy(bad, full, ROM_LEN);
		bad[bit / 8] ^= (uint8_t)(1 << bit % 8);
		for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++) {
			int n = rom_print(bad, formats[i], text);

			TEST_ASSERT_EQUAL_INT_MESSAGE(-EBADMSG, rom_parse(text, (size_t)n, rom),
			                              text);
		}
	}
	TEST_ASSERT_EQUAL_INT(-EBADMSG, rom_parse("00.000000000000", 15, rom));
}

static void test_other_text_is_no_id(void)
{
	static const char *const other[] = {
		"",
		"28",
		"kitchen",
		"28.551DDF03000",
		"28.551DDF0300000",
		"28-551DDF030000",
		"28.551DDF03000G",
		"2.8551DDF030000",
		"28.551DDF030000.",
		"28.551DDF030000.1",
		" 8.551DDF030000",
		"28.551DDF030000.1F0",
	};
	uint8_t rom[ROM_LEN] = {0x77};

	for (size_t i = 0; i < sizeof(other) / sizeof(other[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, rom_parse(other[i], strlen(other[i]), rom),
		                              other[i]);
	TEST_ASSERT_EQUAL_HEX8(0x77, rom[0]);
}

static void test_random_ids_survive_every_format(void)
{
	const unsigned seed = 20251121;
	uint8_t rom[ROM_LEN], back[ROM_LEN];
	char text[ROM_TEXT_MAX], note[32];

	srand(seed);
	snprintf(note, sizeof(note), "seed %u", seed);
	for (int i = 0; i < 2000; i++) {
		for (int j = 0; j < 7; j++)
			rom[j] = (uint8_t)(rand() >> 4);
		rom[0] |= 1;
		rom[7] = rom_crc8(rom, 7);
		for (int format = ROM_F_I; format <= ROM_FIC; format++) {
			int n = rom_print(rom, (enum rom_format)format, text);

			TEST_ASSERT_EQUAL_INT_MESSAGE(0, rom_parse(text, (size_t)n, back), note);
			TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(rom, back, ROM_LEN, note);
		}
	}
}

static void test_device_and_property_are_told_apart(void)
{
	static const struct {
		const char *text, *device, *last, *property;
		bool has_rom;
	} cases[] = {
		{"/28.551DDF030000/temperature12", "28.551DDF030000", "28.551DDF030000",
	         "temperature12", true},
		{"28.551ddf030000/temperature12", "28.551ddf030000", "28.551ddf030000",
	         "temperature12", true},
		{"/26.0CBEEA010000/HIH4000/humidity", "26.0CBEEA010000", "26.0CBEEA010000",
	         "HIH4000/humidity", true},
		{"/29.B89115000000/PIO.BYTE", "29.B89115000000", "29.B89115000000", "PIO.BYTE",
	         true},
		{"/kitchen/temperature", "kitchen", "kitchen", "temperature", false},
		{"/kitchen", "kitchen", "kitchen", "", false},
		{"/28.551DDF030000", "28.551DDF030000", "28.551DDF030000", "", true},
		{"/simultaneous/temperature", "", "", "simultaneous/temperature", false},
		{"/statistics/errors/CRC8_errors", "", "", "statistics/errors/CRC8_errors", false},
		{"/system/process/pid", "", "", "system/process/pid", false},
		{"/bus.0/interface/settings/name", "", "", "interface/settings/name", false},
		{"/", "", "", "", false},
		{"", "", "", "", false},
		{"/uncached", "", "", "", false},
		{"/alarm", "", "", "", false},
		{"/1F.0102030405 06/main", "1F.0102030405 06", "1F.0102030405 06", "main", false},
		{"/1F.010203040506/main/28.551DDF030000/temperature",
	         "1F.010203040506/main/28.551DDF030000", "28.551DDF030000", "temperature", true},
		{"/1F.010203040506/aux/1F.020202020202/main/28.551DDF030000/temperature",
	         "1F.010203040506/aux/1F.020202020202/main/28.551DDF030000", "28.551DDF030000",
	         "temperature", true},
		{"/1F.010203040506/main/boiler/temperature", "1F.010203040506/main/boiler",
	         "boiler", "temperature", false},
		{"/1F.010203040506/main/simultaneous/temperature", "1F.010203040506",
	         "1F.010203040506", "main/simultaneous/temperature", true},
		{"/1F.010203040506/main", "1F.010203040506", "1F.010203040506", "main", true},
		{"/1F.010203040506/branch.0", "1F.010203040506", "1F.010203040506", "branch.0",
	         true},
		{"/hub/main/28.551DDF030000/temperature", "hub/main/28.551DDF030000",
	         "28.551DDF030000", "temperature", true},
		{"/hub/main/boiler", "hub", "hub", "main/boiler", false},
		{"/28.551DDF030000/main/28.551DDF030001", "28.551DDF030000", "28.551DDF030000",
	         "main/28.551DDF030001", true},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct path path = split(cases[i].text);

		slice_equals(cases[i].device, path.device, cases[i].text);
		slice_equals(cases[i].last, path.last, cases[i].text);
		slice_equals(cases[i].property, path.property, cases[i].text);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].has_rom, path.has_rom, cases[i].text);
	}
}

static void test_flags_are_taken_in_any_order_and_only_before_the_device(void)
{
	struct path path = split("/uncached/alarm/bus.3/28.551DDF030000/temperature");

	TEST_ASSERT_TRUE(path.uncached);
	TEST_ASSERT_TRUE(path.alarm);
	TEST_ASSERT_EQUAL_INT(3, path.bus);
	slice_equals("28.551DDF030000", path.device, "all flags");
	path = split("/bus.12/uncached/kitchen/x");
	TEST_ASSERT_TRUE(path.uncached);
	TEST_ASSERT_FALSE(path.alarm);
	TEST_ASSERT_EQUAL_INT(12, path.bus);
	path = split("/text/uncached/json/bus.1/28.551DDF030000/text");
	TEST_ASSERT_TRUE(path.uncached);
	TEST_ASSERT_EQUAL_INT(1, path.bus);
	slice_equals("28.551DDF030000", path.device, "the forms of owhttpd");
	slice_equals("text", path.property, "a property");
	path = split("/29.B89115000000/alarm");
	TEST_ASSERT_FALSE(path.alarm);
	TEST_ASSERT_EQUAL_INT(-1, path.bus);
	slice_equals("alarm", path.property, "a property");
	path = split("/bus.x/temperature");
	TEST_ASSERT_EQUAL_INT(-1, path.bus);
	slice_equals("bus.x", path.device, "an alias");
	slice_equals("bus.12345", split("/bus.12345/x").device, "an alias");
}

static void test_a_malformed_path_is_refused_with_the_reason(void)
{
	static const struct {
		const char *text, *reason;
	} bad[] = {
		{"//x", "has an empty component"},
		{"/x/", "has an empty component"},
		{"x//y", "has an empty component"},
		{"/uncached//x", "has an empty component"},
		{"/x/../y", "has a component \".\" or \"..\""},
		{"..", "has a component \".\" or \"..\""},
		{"/./x", "has a component \".\" or \"..\""},
		{"/x\ty", "holds a control character"},
		{"/x\x7f", "holds a control character"},
		{"/28.551DDF030000.00/temperature", "has a device id with a wrong checksum"},
		{"/1F.010203040506/main/28.551DDF030000.00/t",
	         "has a device id with a wrong checksum"},
		{"/00.000000000000/x", "has a device id with a wrong checksum"},
	};
	char longer[PATH_LEN_MAX + 1];
	struct path path;

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_EQUAL_STRING_MESSAGE(
			bad[i].reason, path_split(bad[i].text, strlen(bad[i].text), &path),
			bad[i].text);
	memset(longer, 'x', sizeof(longer));
	TEST_ASSERT_EQUAL_STRING("is longer than 255 bytes",
	                         path_split(longer, sizeof(longer), &path));
	TEST_ASSERT_NULL(path_split(longer, PATH_LEN_MAX, &path));
	TEST_ASSERT_EQUAL_STRING("holds a control character", path_split("/a\0b", 4, &path));
}

static void test_only_len_bytes_are_looked_at(void)
{
	struct path path;
	char text[] = {'/', 'a', '/', 'b'};

	TEST_ASSERT_NULL(path_split(text, sizeof(text), &path));
	slice_equals("b", path.property, "not terminated");
	TEST_ASSERT_NULL(path_split(text, 2, &path));
	slice_equals("a", path.device, "cut");
	slice_equals("", path.property, "cut");
}

static void test_devices_are_compared_by_id_or_by_alias(void)
{
	static const struct {
		const char *a, *b;
		bool same;
	} pairs[] = {
		{"/28.551DDF030000/temperature", "/uncached/bus.0/28551ddf030000/power", true},
		{"/28.551DDF030000", "/1F.010203040506/main/28.551DDF030000/x", true},
		{"/28.551DDF030000/x", "/28.551DDF030001/x", false},
		{"/28.551DDF030000/x", "/kitchen/x", false},
		{"/kitchen/x", "/alarm/kitchen/y", true},
		{"/kitchen/x", "/Kitchen/x", false},
		{"/kitchen/x", "/kitchens/x", false},
		{"/simultaneous/x", "/simultaneous/x", false},
		{"/", "/", false},
	};

	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		struct path a = split(pairs[i].a), b = split(pairs[i].b);

		TEST_ASSERT_EQUAL_MESSAGE(pairs[i].same, path_same_device(&a, &b), pairs[i].a);
		TEST_ASSERT_EQUAL_MESSAGE(pairs[i].same, path_same_device(&b, &a), pairs[i].b);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_checksum_is_that_of_the_data_sheet);
	RUN_TEST(test_all_six_formats_in_any_case_are_one_id);
	RUN_TEST(test_a_wrong_checksum_is_refused_in_every_format_that_has_one);
	RUN_TEST(test_other_text_is_no_id);
	RUN_TEST(test_random_ids_survive_every_format);
	RUN_TEST(test_device_and_property_are_told_apart);
	RUN_TEST(test_flags_are_taken_in_any_order_and_only_before_the_device);
	RUN_TEST(test_a_malformed_path_is_refused_with_the_reason);
	RUN_TEST(test_only_len_bytes_are_looked_at);
	RUN_TEST(test_devices_are_compared_by_id_or_by_alias);
	return UNITY_END();
}
