/* SPDX-License-Identifier: MIT */
/* Other ids in a recording, wherever it has one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/lines.h"

static const uint8_t mask[TRACE_MASK] = {0x5a, 0xff, 0x13, 0x81};
static const uint8_t nothing[TRACE_MASK];
static char text[8000];

void setUp(void)
{
}

void tearDown(void)
{
}

/* An id with its CRC8 and the one that it becomes, as digits. */
static void id_of(unsigned last, uint8_t rom[8], char digits[17])
{
	memcpy(rom, (const uint8_t[8]){0x28, 0x55, 0x1d, 0xdf, (uint8_t)last, 0, 3}, 8);
	rom[7] = rom_crc8(rom, 7);
	for (int i = 0; i < 8; i++)
		sprintf(digits + 2 * i, "%02X", rom[i]);
}

static void become(uint8_t rom[8], char digits[17])
{
	for (int i = 0; i < TRACE_MASK; i++)
		rom[i + 1] ^= mask[i];
	rom[7] = rom_crc8(rom, 7);
	for (int i = 0; i < 8; i++)
		sprintf(digits + 2 * i, "%02X", rom[i]);
}

static void test_an_id_is_the_same_one_everywhere(void)
{
	char old[17], new[17], expected[2000];
	uint8_t rom[8];
	const char *const form = "# scan /28.%.12s\n"
				 "0.0 0.0 0: run r 55 28.%s BE 2 > 0 5005\n"
				 "0.0 0.0 0: verify all 28.%s > 1\n"
				 "0.0 0.0 bus: read \"/28.%.12s/address\" > 0 \"28%s\"\n"
				 "0.0 0.0 net: \"/28.%.12s.%s 28%.12s.%s\"\n"
				 "0.0 0.0 0: run - - 3 > 0 112233\n";

	id_of(0, rom, old);
	sprintf(text, form, old + 2, old + 2, old + 2, old + 2, old + 2, old + 2, old + 14, old + 2,
	        old + 14);
	become(rom, new);
	sprintf(expected, form, new + 2, new + 2, new + 2, new + 2, new + 2, new + 2, new + 14,
	        new + 2, new + 14);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(expected, text);
	TEST_ASSERT_EQUAL_STRING_LEN("28", new, 2);
}

/* It shows most of the true one. Its checksum is as wrong as before, and it decides no order. */
static void test_a_disturbed_id_is_changed_too(void)
{
	char old[17], new[17], expected[2000];
	uint8_t rom[8];
	const char *const form = "0.0 0.0 0: path r F0 > 0 28.%s28.%s\n"
				 "0.0 0.0 0: path r F0 > 0 28.%s28.%s\n";

	id_of(0, rom, old);
	memcpy(new, old, sizeof(new));
	new[2] ^= 1;
	sprintf(text, form, old + 2, old + 2, new + 2, new + 2);
	become(rom, old);
	memcpy(new, old, sizeof(new));
	rom[1] ^= 0x10;
	sprintf(new + 2, "%02X", rom[1]);
	new[4] = old[4];
	sprintf(expected, form, old + 2, old + 2, new + 2, new + 2);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_an_id_backwards_keeps_its_checksum(void)
{
	char old[17], new[17], back[17] = "", expected[17] = "", line[300];
	uint8_t rom[8];

	id_of(0, rom, old);
	for (int i = 7; i >= 0; i--)
		sprintf(back + strlen(back), "%02X", rom[i]);
	become(rom, new);
	for (int i = 7; i >= 0; i--)
		sprintf(expected + strlen(expected), "%02X", rom[i]);
	sprintf(text, "0.0 0.0 bus: read \"/28.%.12s/r_address\" > 0 \"%s\"\n", old + 2, back);
	sprintf(line, "0.0 0.0 bus: read \"/28.%.12s/r_address\" > 0 \"%s\"\n", new + 2, expected);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(line, text);
}

static void test_data_have_the_other_id_too(void)
{
	char old[17], new[17], expected[200];
	uint8_t rom[8];
	const char *const form = "# /28.%.12s\n0.0 0.0 0: run r CCA50000 9 > 0 A1%sB2\n";

	id_of(0, rom, old);
	sprintf(text, form, old + 2, old);
	become(rom, new);
	sprintf(expected, form, new + 2, new);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(expected, text);
}

/* A recording of owsctl has none of these; that text has no room for digits. */
static void test_a_text_where_digits_belong_is_left_alone(void)
{
	static const char *const lines[] = {
		"0 0 0: path F0 > 0 \"abcdefgh\"",
		"0 0 0: run r 33 8 > 0 \"abcdefgh",
		"0 0 0: run r 55\"abcdefgh > 0",
		"0 0 0: run r 55 28.A > 0 \"",
		"0 0 0: search all 00 > 0 \"abcdefghi\"",
		"0 0 0: run r CCA5 9 > 0 \"abcdefgh\"",
		"0 0 0: run  > 0 00",
		"0 0 0: run > 0 00",
	};

	for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
		char *copy = strdup(lines[i]);

		trace_anonymous(copy, mask);
		TEST_ASSERT_EQUAL_STRING(lines[i], copy);
		free(copy);
	}
}

/* As a remark that has a line end. */
static void test_an_id_goes_where_there_is_no_line_too(void)
{
	char old[17];
	uint8_t rom[8];

	id_of(0, rom, old);
	sprintf(text, "owsd trace 1\n# a\n0 0 /28.%.12s > b\nx /28.%.12s\n%s", old + 2, old + 2,
	        old);
	trace_anonymous(text, mask);
	TEST_ASSERT_NULL_MESSAGE(strstr(text, "551DDF"), text);
	TEST_ASSERT_EQUAL_INT(0, strncmp(text, "owsd trace 1\n# a\n0 0 /28.", 25));
}

/* The ids part in the lowest bit of the fourth byte, where the mask has 1, and must not have. */
static void test_ids_part_as_before(void)
{
	static const char form[] =
		"0 0 0: path r F0 > 0 28.%s28.%s\n0 0 0: path r F0 > 0 28.%s28.%s\n";
	char expected[200], digits[2][17];
	uint8_t first[8], second[8];

	id_of(6, first, digits[0]);
	id_of(3, second, digits[1]);
	sprintf(text, form, digits[0] + 2, digits[1] + 2, digits[1] + 2, digits[0] + 2);
	trace_anonymous(text, mask);
	first[4] ^= 1;
	become(first, digits[0]);
	second[4] ^= 1;
	become(second, digits[1]);
	sprintf(expected, form, digits[0] + 2, digits[1] + 2, digits[1] + 2, digits[0] + 2);
	TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_without_a_mask_nothing_changes(void)
{
	const char *const was =
		"0.0 0.0 0: run r 33 8 > 0 28.551DDF030000C8\n0.0 0.0\nx > y\n > \n#\n";

	strcpy(text, was);
	trace_anonymous(text, nothing);
	TEST_ASSERT_EQUAL_STRING(was, text);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_id_is_the_same_one_everywhere);
	RUN_TEST(test_a_disturbed_id_is_changed_too);
	RUN_TEST(test_an_id_backwards_keeps_its_checksum);
	RUN_TEST(test_data_have_the_other_id_too);
	RUN_TEST(test_a_text_where_digits_belong_is_left_alone);
	RUN_TEST(test_an_id_goes_where_there_is_no_line_too);
	RUN_TEST(test_ids_part_as_before);
	RUN_TEST(test_without_a_mask_nothing_changes);
	return UNITY_END();
}
