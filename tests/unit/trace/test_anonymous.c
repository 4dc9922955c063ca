/* SPDX-License-Identifier: MIT */
/* Other ids in a recording, wherever it has one. */
#include <stdio.h>
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

/* A page that has the id, with the CRC16 of command, address and data behind it. */
static void test_data_with_an_id_get_a_right_checksum(void)
{
	uint8_t rom[8], page[3 + 8 + 2] = {0xa5, 0x00, 0x00}, is[20];
	char old[17], new[17];
	uint16_t crc;

	id_of(0, rom, old);
	memcpy(page + 3, rom, 8);
	crc = (uint16_t)~onewire_crc16(0, page, 11);
	sprintf(text, "0.0 0.0 0 run r 55%sA50000 10 > 0 %s%02X%02X\n", old, old, crc & 255,
	        crc >> 8);
	become(rom, new);
	trace_anonymous(text, mask);
	TEST_ASSERT_EQUAL_size_t(10, trace_parse(strstr(text, "> 0 ") + 4, is + 3, 10));
	TEST_ASSERT_EQUAL_MEMORY(rom, is + 3, 8);
	memcpy(is, page, 3);
	TEST_ASSERT_TRUE(onewire_crc16_matches(onewire_crc16(0, is, 11), is + 11));
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
	RUN_TEST(test_data_with_an_id_get_a_right_checksum);
	RUN_TEST(test_a_search_finds_the_new_ids_in_the_same_order);
	RUN_TEST(test_without_a_mask_nothing_changes);
	return UNITY_END();
}
