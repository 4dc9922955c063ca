/* SPDX-License-Identifier: MIT */
/* Other ids in a recording, wherever it has one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/trace.h"
#include "hal/wire/crc.h"

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
				 "0.0 0.0 0 run r 55%sBE 2 > 0 5005\n"
				 "0.0 0.0 0 verify all %s > 1\n"
				 "0.0 0.0 bus read \"/28.%.12s/address\" > 0 \"%s\"\n"
				 "0.0 0.0 0 run - - 3 > 0 112233\n";

	id_of(0, rom, old);
	sprintf(text, form, old + 2, old, old, old + 2, old);
	become(rom, new);
	sprintf(expected, form, new + 2, new, new, new + 2, new);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(expected, text);
	TEST_ASSERT_EQUAL_STRING_LEN("28", new, 2);
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
	sprintf(text, "0.0 0.0 bus read \"/28.%.12s/r_address\" > 0 \"%s\"\n", old + 2, back);
	sprintf(line, "0.0 0.0 bus read \"/28.%.12s/r_address\" > 0 \"%s\"\n", new + 2, expected);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_STRING(line, text);
}

static void put_crc16(const uint8_t *from, uint8_t *to)
{
	uint16_t crc = (uint16_t)~onewire_crc16(0, from, (size_t)(to - from));

	to[0] = (uint8_t)crc;
	to[1] = (uint8_t)(crc >> 8);
}

/*
 * Two pages that have the id, with a CRC16 behind each: of command, address and data, and of data.
 * In the first stands what would be a CRC16 of the id alone, and is none.
 */
static void test_data_with_an_id_get_right_checksums(void)
{
	uint8_t rom[8], page[3 + 10 + 2 + 8 + 2] = {0xa5, 0x00, 0x00}, is[sizeof(page)];
	char old[17], new[17], select[40], digits[2 * sizeof(page) + 1];

	for (int i = 0; i < 2; i++) {
		id_of(0, rom, old);
		memcpy(page + 3, rom, 8);
		put_crc16(page + 3, page + 11);
		put_crc16(page, page + 13);
		memcpy(page + 15, rom, 8);
		put_crc16(page + 15, page + 23);
		for (size_t k = 0; k < sizeof(page); k++)
			sprintf(digits + 2 * k, "%02X", page[k]);
		snprintf(select, sizeof(select), i ? "CC" : "55%s", old);
		sprintf(text, "# /28.%.12s\n0.0 0.0 0 run r %sA50000 22 > 0 %s\n", old + 2, select,
		        digits + 6);
		become(rom, new);
		trace_anonymous(text, mask);
		TEST_ASSERT_EQUAL_size_t(22, trace_parse(strstr(text, "> 0 ") + 4, is + 3, 22));
		TEST_ASSERT_EQUAL_MEMORY(rom, is + 3, 8);
		TEST_ASSERT_EQUAL_MEMORY(page + 11, is + 11, 2);
		memcpy(is, page, 3);
		TEST_ASSERT_TRUE(onewire_crc16_matches(onewire_crc16(0, is, 13), is + 13));
		TEST_ASSERT_TRUE(onewire_crc16_matches(onewire_crc16(0, is + 15, 8), is + 23));
	}
}

/* A recording of owsctl has none of these; that text has no room for digits. */
static void test_a_text_where_digits_belong_is_left_alone(void)
{
	static const char *const lines[] = {
		"0 0 0 path F0 > 0 \"abcdefgh\"",      "0 0 0 run r 33 8 > 0 \"abcdefgh",
		"0 0 0 run r 55\"abcdefgh > 0",        "0 0 0 search all 00 > 0 \"abcdefghi\"",
		"0 0 0 run r CCA5 9 > 0 \"abcdefgh\"", "0 0 0 run  > 0 00",
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

/* A line for each of the 64 triplets, as two ids on a wire give them. */
static void add_triplets(const uint8_t taken[8], const uint8_t other[8])
{
	bool beside = true;

	strcat(text, "0.0 0.0 0 run r F0 0 > 0\n");
	for (int i = 0; i < 64; i++) {
		int a = taken[i / 8] >> i % 8 & 1, b = other[i / 8] >> i % 8 & 1;
		int read = beside && a != b ? 0 : a ? 1 : 2;

		beside &= a == b;
		sprintf(text + strlen(text), "0.0 0.0 0 triplet > %d\n", read | a << 2);
	}
}

/* The ids part in the lowest bit of the fourth byte, where the mask has 1, and must not have. */
static void test_a_search_finds_the_new_ids_in_the_same_order(void)
{
	static char made[sizeof(text)];
	uint8_t first[8], second[8];
	char digits[17];

	id_of(6, first, digits);
	id_of(3, second, digits);
	text[0] = '\0';
	add_triplets(first, second);
	add_triplets(second, first);
	strcpy(made, text);
	trace_anonymous(made, mask);
	become(first, digits);
	first[4] ^= 1;
	become(second, digits);
	second[4] ^= 1;
	first[7] = rom_crc8(first, 7);
	second[7] = rom_crc8(second, 7);
	text[0] = '\0';
	add_triplets(first, second);
	add_triplets(second, first);
	TEST_ASSERT_EQUAL_STRING(text, made);
}

static void test_without_a_mask_nothing_changes(void)
{
	const char *const was =
		"0.0 0.0 0 run r 33 8 > 0 28551DDF030000C8\n0.0 0.0\nx > y\n > \n#\n";

	strcpy(text, was);
	trace_anonymous(text, nothing);
	TEST_ASSERT_EQUAL_STRING(was, text);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_id_is_the_same_one_everywhere);
	RUN_TEST(test_an_id_backwards_keeps_its_checksum);
	RUN_TEST(test_data_with_an_id_get_right_checksums);
	RUN_TEST(test_a_text_where_digits_belong_is_left_alone);
	RUN_TEST(test_an_id_goes_where_there_is_no_line_too);
	RUN_TEST(test_a_search_finds_the_new_ids_in_the_same_order);
	RUN_TEST(test_without_a_mask_nothing_changes);
	return UNITY_END();
}
