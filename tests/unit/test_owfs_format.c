/* SPDX-License-Identifier: MIT */
/* The texts that a genuine owserver 3.2p4 printed for these values. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/native/crc.h"
#include "hal/native/format.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void prints(uint8_t type, double number, const char *text)
{
	char out[64];
	int n = format_number(type, number, out, sizeof(out));

	TEST_ASSERT_EQUAL_INT_MESSAGE((int)strlen(text), n, text);
	TEST_ASSERT_EQUAL_MEMORY(text, out, strlen(text));
}

static void test_numbers_are_those_of_owserver(void)
{
	prints(PROPERTY_TEMPERATURE, 0, "           0");
	prints(PROPERTY_TEMPERATURE, -0.0625, "     -0.0625");
	prints(PROPERTY_TEMPERATURE, 21.0625, "     21.0625");
	prints(PROPERTY_TEMPERATURE, 21.06251, "     21.0625");
	prints(PROPERTY_TEMPERATURE, -55, "         -55");
	prints(PROPERTY_FLOAT, 1234567, " 1.23457E+06");
	prints(PROPERTY_FLOAT, 12345678.9, " 1.23457E+07");
	prints(PROPERTY_FLOAT, 0.0000123, "    1.23E-05");
	prints(PROPERTY_FLOAT, 1e10, "       1E+10");
	prints(PROPERTY_FLOAT, NAN, "         NAN");
	prints(PROPERTY_FLOAT, INFINITY, "         INF");
	prints(PROPERTY_UNSIGNED, 4294967295.0, "  4294967295");
	prints(PROPERTY_YESNO, 7, "1");
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, format_number(PROPERTY_FLOAT, 1, (char[11]){0}, 11));
}

static const struct property bits = {.name = "PIO", .type = PROPERTY_BITS,
                                     .array = {8, INDEX_NUMBERS, true}};
static const struct property letters = {.name = "volt", .type = PROPERTY_FLOAT,
                                        .array = {4, INDEX_LETTERS, true}};

static void test_arrays_are_joined_by_commas_and_bytes_are_numbers(void)
{
	struct txn txn = {.bits = 0xaa, .number = {72.5633, 7.66785, 17.643, 31.4219}};
	char out[128];

	TEST_ASSERT_EQUAL_INT(15, format_value(&bits, EXTENSION_ALL, &txn, out, sizeof(out)));
	TEST_ASSERT_EQUAL_MEMORY("0,1,0,1,0,1,0,1", out, 15);
	TEST_ASSERT_EQUAL_INT(12, format_value(&bits, EXTENSION_BYTE, &txn, out, sizeof(out)));
	TEST_ASSERT_EQUAL_MEMORY("         170", out, 12);
	TEST_ASSERT_EQUAL_INT(51, format_value(&letters, EXTENSION_ALL, &txn, out, sizeof(out)));
	TEST_ASSERT_EQUAL_MEMORY("     72.5633,     7.66785,      17.643,     31.4219", out, 51);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, format_value(&letters, EXTENSION_ALL, &txn, out, 50));
}

static void extension(const struct property *property, const char *text, int expected, bool fits)
{
	size_t name_len;
	int found = extension_split(text, strlen(text), &name_len);

	TEST_ASSERT_EQUAL_INT_MESSAGE(expected, found, text);
	TEST_ASSERT_EQUAL_INT_MESSAGE(fits, extension_fits(property, found), text);
}

static void test_extensions_are_numbers_letters_all_and_byte_in_any_case(void)
{
	extension(&bits, "PIO.BYTE", EXTENSION_BYTE, true);
	extension(&bits, "PIO.byte", EXTENSION_BYTE, true);
	extension(&bits, "PIO.all", EXTENSION_ALL, true);
	extension(&bits, "PIO.07", 7, true);
	extension(&bits, "PIO.8", 8, false);
	extension(&bits, "PIO.A", 256, false);
	extension(&bits, "PIO", EXTENSION_NONE, false);
	extension(&letters, "volt.D", 259, true);
	extension(&letters, "volt.E", 260, false);
	extension(&letters, "volt.1", 1, false);
	extension(&letters, "volt.BYTE", EXTENSION_BYTE, false);
}

static void parses(uint8_t type, const char *text, int err, double number)
{
	struct property property = {.name = "x", .type = type};
	struct txn txn = {0};

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		err, parse_value(&property, EXTENSION_NONE, text, strlen(text), &txn), text);
	if (!err)
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(number, txn.number[0], text);
}

static void test_values_are_read_as_lax_as_owserver_reads_them(void)
{
	parses(PROPERTY_TEMPERATURE, "12abc", 0, 12);
	parses(PROPERTY_TEMPERATURE, "abc", -EINVAL, 0);
	parses(PROPERTY_TEMPERATURE, "", -EINVAL, 0);
	parses(PROPERTY_TEMPERATURE, "nan", -EINVAL, 0);
	parses(PROPERTY_UNSIGNED, "-1", 0, 4294967295.0);
	parses(PROPERTY_UNSIGNED, "99999999999999999999999", -EINVAL, 0);
	parses(PROPERTY_YESNO, "yes", 0, 1);
	parses(PROPERTY_YESNO, "off", 0, 0);
	parses(PROPERTY_YESNO, "7", 0, 1);
	parses(PROPERTY_YESNO, " ", -EINVAL, 0);
	parses(PROPERTY_YESNO, "maybe", -EINVAL, 0);
	parses(PROPERTY_DATE, "junk", -EINVAL, 0);
}

static void test_one_element_leaves_the_others(void)
{
	struct txn txn = {.bits = 0xf0};

	TEST_ASSERT_EQUAL_INT(0, parse_value(&bits, 1, "1", 1, &txn));
	TEST_ASSERT_EQUAL_HEX32(0xf2, txn.bits);
	TEST_ASSERT_EQUAL_INT(0, parse_value(&bits, 7, "0", 1, &txn));
	TEST_ASSERT_EQUAL_HEX32(0x72, txn.bits);
	TEST_ASSERT_EQUAL_INT(0, parse_value(&bits, EXTENSION_BYTE, "256", 3, &txn));
	TEST_ASSERT_EQUAL_HEX32(0, txn.bits);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_value(&bits, EXTENSION_ALL, "1,0,1", 5, &txn));
}

/* The check value of CRC-16/ARC, and the id of application note 27. */
static void test_crc16_is_that_of_the_application_note(void)
{
	TEST_ASSERT_EQUAL_HEX16(0xbb3d, onewire_crc16(0, (const uint8_t *)"123456789", 9));
	TEST_ASSERT_TRUE(onewire_crc16_matches(0xbb3d, (const uint8_t[]){0xc2, 0x44}));
	TEST_ASSERT_FALSE(onewire_rom_valid((const uint8_t[8]){0}));
	TEST_ASSERT_TRUE(onewire_rom_valid((const uint8_t[]){2, 0x1c, 0xb8, 1, 0, 0, 0, 0xa2}));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_numbers_are_those_of_owserver);
	RUN_TEST(test_arrays_are_joined_by_commas_and_bytes_are_numbers);
	RUN_TEST(test_extensions_are_numbers_letters_all_and_byte_in_any_case);
	RUN_TEST(test_values_are_read_as_lax_as_owserver_reads_them);
	RUN_TEST(test_one_element_leaves_the_others);
	RUN_TEST(test_crc16_is_that_of_the_application_note);
	return UNITY_END();
}
