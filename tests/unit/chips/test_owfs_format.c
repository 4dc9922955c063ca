/* SPDX-License-Identifier: MIT */
/* The texts that a genuine owserver 3.2p4 printed for these values. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "hal/chips/format.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/wire/crc.h"

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

static const struct property bits = {
	.name = "PIO", .type = PROPERTY_BITS, .array = {8, INDEX_NUMBERS, true}};
static const struct property letters = {
	.name = "volt", .type = PROPERTY_FLOAT, .array = {4, INDEX_LETTERS, true}};

static const struct property many = {
	.name = "log", .type = PROPERTY_FLOAT, .array = {2048, INDEX_NUMBERS, false}};
static const struct property words = {.name = "id", .type = PROPERTY_BINARY, SPARSE(LETTERS)};

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
	extension(&bits, "PIO.A", EXTENSION_LETTERS, false);
	extension(&bits, "PIO", EXTENSION_NONE, false);
	extension(&letters, "volt.D", EXTENSION_LETTERS + 3, true);
	extension(&letters, "volt.E", EXTENSION_LETTERS + 4, false);
	extension(&letters, "volt.1", 1, false);
	extension(&letters, "volt.BYTE", EXTENSION_BYTE, false);
	extension(&letters, "volt.xyz", EXTENSION_WORD, false);
	extension(&many, "log.2047", 2047, true);
	extension(&many, "log.2048", 2048, false);
	extension(&many, "log.20470", EXTENSION_WORD, false);
	extension(&words, "id.secret", EXTENSION_WORD, true);
	extension(&words, "id", EXTENSION_NONE, false);
}

struct written {
	uint8_t type;
	const char *text;
	double number; /* NAN: refused */
};

static void judge(const struct property *property, int err, const struct txn *txn, const char *text,
                  double number)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(isnan(number) ? -EINVAL : 0, err, text);
	if (err) {
		TEST_ASSERT_EQUAL_HEX32_MESSAGE(0x5a, txn->bits, text);
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(-77, txn->number[0], text);
	} else if (property->type == PROPERTY_BITS) {
		TEST_ASSERT_EQUAL_HEX32_MESSAGE((uint32_t)number, txn->bits, text);
	} else {
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(number, txn->number[0], text);
	}
}

static void takes(const struct property *property, int extension, const char *text, size_t len,
                  double number)
{
	struct txn txn = {.bits = 0x5a, .number = {-77}};
	char *end;
	double same = strtod(text, &end);

	judge(property, parse_value(property, extension, text, len, &txn), &txn, text, number);
	/* as a number it is no other value */
	if (end == text || end[strspn(end, " \t\r\n")] || strlen(text) + 1 < len ||
	    strchr(text, 'x') || !format_is_number(property, extension))
		return;
	txn = (struct txn){.bits = 0x5a, .number = {-77}};
	judge(property, take_number(property, extension, same, &txn), &txn, text, number);
}

#define NO NAN

/* clang-format off */
static const struct written written[] = {
	{PROPERTY_UNSIGNED, "0", 0}, {PROPERTY_UNSIGNED, "-0", 0}, {PROPERTY_UNSIGNED, "+7", 7},
	{PROPERTY_UNSIGNED, "3.0", 3}, {PROPERTY_UNSIGNED, "1e+09", 1e9},
	{PROPERTY_UNSIGNED, "4294967295", 4294967295.0}, {PROPERTY_UNSIGNED, "4294967296", NO},
	{PROPERTY_UNSIGNED, "99999999999999999999999", NO}, {PROPERTY_UNSIGNED, "-1", NO},
	{PROPERTY_UNSIGNED, "3.7", NO}, {PROPERTY_UNSIGNED, "4294967295.5", NO},
	{PROPERTY_INTEGER, "-2147483648", -2147483648.0}, {PROPERTY_INTEGER, "2147483647", 2147483647},
	{PROPERTY_INTEGER, "-2147483649", NO}, {PROPERTY_INTEGER, "2147483648", NO},
	{PROPERTY_INTEGER, "-3", -3}, {PROPERTY_INTEGER, "-3.5", NO},
	{PROPERTY_YESNO, "0", 0}, {PROPERTY_YESNO, "1", 1}, {PROPERTY_YESNO, "yes", 1},
	{PROPERTY_YESNO, "Yes", 1}, {PROPERTY_YESNO, "y", 1}, {PROPERTY_YESNO, "ON", 1},
	{PROPERTY_YESNO, "no", 0}, {PROPERTY_YESNO, "n", 0}, {PROPERTY_YESNO, "off", 0},
	{PROPERTY_YESNO, "2", NO}, {PROPERTY_YESNO, "7", NO}, {PROPERTY_YESNO, "-1", NO},
	{PROPERTY_YESNO, "0.5", NO}, {PROPERTY_YESNO, "maybe", NO}, {PROPERTY_YESNO, "yess", NO},
	{PROPERTY_YESNO, "no way", NO}, {PROPERTY_YESNO, "yes,", NO},
	{PROPERTY_TEMPERATURE, "-12.5", -12.5}, {PROPERTY_TEMPERATURE, "1E2", 100},
	{PROPERTY_FLOAT, ".5", 0.5}, {PROPERTY_PRESSURE, "1013", 1013}, {PROPERTY_FLOAT, "1.2.3", NO},
	{PROPERTY_FLOAT, "1e999", NO}, {PROPERTY_FLOAT, "21,5", NO},
	{PROPERTY_DATE, "junk", NO}, {PROPERTY_DATE, "2026-11-22 12:00:00 or so", NO},
	{PROPERTY_DATE, "2026-11-22", NO}, {PROPERTY_DATE, "1900-01-01 00:00:00", NO},
	{PROPERTY_DATE, "2200-01-01 00:00:00", NO},
};
/* clang-format on */

static void test_a_text_that_does_not_fit_its_property_is_refused(void)
{
	for (size_t i = 0; i < sizeof(written) / sizeof(written[0]); i++) {
		struct property property = {.name = "x", .type = written[i].type};
		char text[64];

		takes(&property, EXTENSION_NONE, written[i].text, strlen(written[i].text),
		      written[i].number);
		snprintf(text, sizeof(text), " \t%s \r\n", written[i].text);
		takes(&property, EXTENSION_NONE, text, strlen(text), written[i].number);
		takes(&property, EXTENSION_NONE, text, strlen(text) + 1, written[i].number);
	}
}

static void test_no_type_takes_what_is_no_value(void)
{
	static const uint8_t types[] = {
		PROPERTY_UNSIGNED, PROPERTY_INTEGER,     PROPERTY_YESNO,    PROPERTY_BITS,
		PROPERTY_FLOAT,    PROPERTY_TEMPERATURE, PROPERTY_PRESSURE, PROPERTY_DATE,
	};
	static const char *const texts[] = {
		"",    " ",   "\n",  "abc", "12abc", "1abc", "0 0", "1,1", "0x10",
		"0x1", "nan", "inf", "1e",  "--1",   "1-",   "+",   ".",   "1 yes",
	};

	for (size_t t = 0; t < sizeof(types); t++) {
		struct property property = {.name = "x", .type = types[t]};

		/* of a date, what is blank is the present time */
		for (size_t i = types[t] == PROPERTY_DATE ? 3 : 0;
		     i < sizeof(texts) / sizeof(texts[0]); i++)
			takes(&property, EXTENSION_NONE, texts[i], strlen(texts[i]), NO);
		takes(&property, EXTENSION_NONE, "1\0abc", 5, NO);
	}
}

static void test_a_blank_date_is_the_present_time(void)
{
	static const struct property date = {.name = "date", .type = PROPERTY_DATE};
	static const char *const texts[] = {"", " ", "\n"};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct txn txn = {.number = {-77}};
		double before = (double)time(NULL);

		TEST_ASSERT_EQUAL_INT(
			0, parse_value(&date, EXTENSION_NONE, texts[i], strlen(texts[i]), &txn));
		TEST_ASSERT_TRUE(txn.number[0] >= before);
		TEST_ASSERT_TRUE(txn.number[0] <= (double)time(NULL));
	}
}

static void test_a_byte_has_as_many_bits_as_its_property(void)
{
	static const struct {
		const char *text;
		double number;
	} bytes[] = {{"0", 0},    {"255", 255}, {" 44\n", 44}, {"-1", NO},
	             {"256", NO}, {"300", NO},  {"3.7", NO},   {"12abc", NO},
	             {"1,1", NO}, {"0x10", NO}, {"yes", NO},   {"", NO}};
	struct property two = bits;

	for (size_t i = 0; i < sizeof(bytes) / sizeof(bytes[0]); i++)
		takes(&bits, EXTENSION_BYTE, bytes[i].text, strlen(bytes[i].text), bytes[i].number);
	two.array.count = 2;
	takes(&two, EXTENSION_BYTE, "3", 1, 3);
	takes(&two, EXTENSION_BYTE, "4", 1, NO);
}

static void test_a_list_has_as_many_elements_as_its_property(void)
{
	static const struct {
		const char *text;
		double number;
	} lists[] = {{"1,0,1,0,0,0,0,1", 0x85},
	             {" 1, 0,yes,off,0,0,0,1\n", 0x85},
	             {"1,0,1", NO},
	             {"1,0,1,0,0,0,0,1,0", NO},
	             {"1,0,1,0,0,0,0,", NO},
	             {"1,0,1,0,0,,0,1", NO},
	             {"1", NO},
	             {"", NO}};

	for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++)
		takes(&bits, EXTENSION_ALL, lists[i].text, strlen(lists[i].text), lists[i].number);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_value(&bits, EXTENSION_ALL, "1,0,1,0,0,0,0,2", 15,
	                                           &(struct txn){0}));
}

static void test_a_number_of_digits_has_each_of_them_in_its_range(void)
{
	struct property alarm = {.name = "x", .type = PROPERTY_UNSIGNED, .digits = 331};
	struct property below = {.name = "x", .type = PROPERTY_UNSIGNED, .negative = true};

	takes(&alarm, EXTENSION_NONE, "331", 3, 331);
	takes(&alarm, EXTENSION_NONE, "0", 1, 0);
	takes(&alarm, EXTENSION_NONE, "332", 3, NO);
	takes(&alarm, EXTENSION_NONE, "341", 3, NO);
	takes(&alarm, EXTENSION_NONE, "1111", 4, NO);
	takes(&below, EXTENSION_NONE, "-5", 2, -5);
}

static void test_one_element_leaves_the_others(void)
{
	struct txn txn = {.bits = 0xf0};

	TEST_ASSERT_EQUAL_INT(0, parse_value(&bits, 1, "1", 1, &txn));
	TEST_ASSERT_EQUAL_HEX32(0xf2, txn.bits);
	TEST_ASSERT_EQUAL_INT(0, parse_value(&bits, 7, "0", 1, &txn));
	TEST_ASSERT_EQUAL_HEX32(0x72, txn.bits);
}

/* The check value of CRC-16/ARC, and the id of application note 27. */
static void test_crc16_is_that_of_the_application_note(void)
{
	TEST_ASSERT_EQUAL_HEX16(0xbb3d, onewire_crc16(0, (const uint8_t *)"123456789", 9));
	TEST_ASSERT_TRUE(onewire_crc16_matches(0xbb3d, (const uint8_t[]){0xc2, 0x44}));
	TEST_ASSERT_FALSE(onewire_rom_valid((const uint8_t[8]){0}));
	TEST_ASSERT_TRUE(onewire_rom_valid((const uint8_t[]){2, 0x1c, 0xb8, 1, 0, 0, 0, 0xa2}));
}

/* A request may have less room than the text of a property needs. */
static void test_a_text_without_room_is_refused_and_nothing_is_written(void)
{
	uint8_t room[] = "...";
	struct txn txn = {.data = room, .room = 1};

	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, thermometer_read_die(&txn));
	TEST_ASSERT_EQUAL_STRING("...", room);
	txn.room = 2;
	TEST_ASSERT_EQUAL_INT(0, thermometer_read_die(&txn));
	TEST_ASSERT_EQUAL_size_t(2, txn.len);
	TEST_ASSERT_EQUAL_STRING("C2.", room);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_numbers_are_those_of_owserver);
	RUN_TEST(test_arrays_are_joined_by_commas_and_bytes_are_numbers);
	RUN_TEST(test_extensions_are_numbers_letters_all_and_byte_in_any_case);
	RUN_TEST(test_a_text_that_does_not_fit_its_property_is_refused);
	RUN_TEST(test_no_type_takes_what_is_no_value);
	RUN_TEST(test_a_blank_date_is_the_present_time);
	RUN_TEST(test_a_byte_has_as_many_bits_as_its_property);
	RUN_TEST(test_a_list_has_as_many_elements_as_its_property);
	RUN_TEST(test_a_number_of_digits_has_each_of_them_in_its_range);
	RUN_TEST(test_one_element_leaves_the_others);
	RUN_TEST(test_a_text_without_room_is_refused_and_nothing_is_written);
	RUN_TEST(test_crc16_is_that_of_the_application_note);
	return UNITY_END();
}
