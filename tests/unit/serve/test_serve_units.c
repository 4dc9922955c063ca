/* SPDX-License-Identifier: MIT */
/* Tests of values converted between the scales of buses and clients. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

#include "src/daemon/serve/code.h"
#include "src/daemon/serve/units.h"

#define FAHRENHEIT 0x10000u
#define KELVIN 0x20000u
#define RANKINE 0x30000u
#define ATM 0x40000u
#define TRIM 0x40u

static char text[256];

void setUp(void)
{
}

void tearDown(void)
{
}

static const char *show(char type, uint32_t flags, const char *from)
{
	int n;

	strcpy(text, from);
	n = units_show(type, flags, text, strlen(from), sizeof(text));
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, n);
	text[n] = '\0';
	return text;
}

/* What the genuine owserver answered for 6.8 degrees and 3 mbar. */
static void test_values_are_shown_in_the_scale_asked_for(void)
{
	TEST_ASSERT_EQUAL_STRING("         6.8", show('t', 0, "         6.8"));
	TEST_ASSERT_EQUAL_STRING("       44.24", show('t', FAHRENHEIT, "         6.8"));
	TEST_ASSERT_EQUAL_STRING("      279.95", show('t', KELVIN, "         6.8"));
	TEST_ASSERT_EQUAL_STRING("      503.91", show('t', RANKINE, "         6.8"));
	TEST_ASSERT_EQUAL_STRING("  0.00296077", show('p', ATM, "           3"));
	TEST_ASSERT_EQUAL_STRING("         6.8", show('f', FAHRENHEIT | ATM, "         6.8"));
}

static void test_a_difference_has_no_zero_point(void)
{
	TEST_ASSERT_EQUAL_STRING("         1.8", show('g', FAHRENHEIT, "           1"));
	TEST_ASSERT_EQUAL_STRING("           1", show('g', KELVIN, "           1"));
}

static void test_lists_are_converted_element_by_element(void)
{
	TEST_ASSERT_EQUAL_STRING("          32,         212",
	                         show('t', FAHRENHEIT, "           0,         100"));
	TEST_ASSERT_EQUAL_STRING("        33.8,        33.8,        33.8",
	                         show('t', FAHRENHEIT, "1,1,1"));
	TEST_ASSERT_EQUAL_STRING("47,48", show('u', TRIM, "          47,          48"));
	TEST_ASSERT_EQUAL_STRING("32,212",
	                         show('t', FAHRENHEIT | TRIM, "           0,         100"));
}

/* log/temperature of a DS1921 */
static void test_the_list_of_a_logger_is_converted(void)
{
	enum { COUNT = 2048 };
	static char list[2 * 13 * COUNT];
	size_t len = 0;
	int n;

	for (int i = 0; i < COUNT; i++)
		len += (size_t)sprintf(list + len, "%s          20", i ? "," : "");
	n = units_show('t', FAHRENHEIT, list, len, sizeof(list));
	TEST_ASSERT_EQUAL_INT(13 * COUNT - 1, n);
	for (int i = 0; i < COUNT; i++)
		TEST_ASSERT_EQUAL_STRING_LEN("          68", list + i * 13, 12);
	n = units_show('t', FAHRENHEIT | TRIM, list, len, sizeof(list));
	TEST_ASSERT_EQUAL_INT(6 * COUNT - 1, n); /* 154.4 */
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, units_show('t', FAHRENHEIT, list, len, len + 100));
}

static void test_padding_goes_where_there_are_numbers(void)
{
	TEST_ASSERT_EQUAL_STRING("  a b", show('a', TRIM, "  a b"));
	TEST_ASSERT_EQUAL_STRING("6.8", show(0, TRIM, "         6.8"));
	TEST_ASSERT_EQUAL_STRING("   some text", show(0, TRIM, "   some text"));
	TEST_ASSERT_EQUAL_STRING("0,1,0", show('y', TRIM, "0,1,0"));
}

static void test_what_is_no_number_is_not_converted(void)
{
	strcpy(text, "junk");
	TEST_ASSERT_EQUAL_INT(-EIO, units_show('t', FAHRENHEIT, text, 4, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("", show('t', FAHRENHEIT, ""));
}

static void test_what_is_written_comes_back_in_degrees_celsius(void)
{
	char out[64];
	int n = units_take('t', FAHRENHEIT, "212", 3, out, sizeof(out));

	TEST_ASSERT_EQUAL_STRING_LEN("100", out, n);
	n = units_take('t', KELVIN, " 273.15,293.15", 14, out, sizeof(out));
	TEST_ASSERT_EQUAL_STRING_LEN("0,20", out, n);
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', KELVIN, "warm", 4, out, sizeof(out)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', KELVIN, "300abc", 6, out, sizeof(out)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', FAHRENHEIT, "0x50", 4, out, sizeof(out)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', FAHRENHEIT, "inf", 3, out, sizeof(out)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', FAHRENHEIT, "1e999", 5, out, sizeof(out)));
	n = units_take('t', FAHRENHEIT, " 212 \n", 7, out, sizeof(out));
	TEST_ASSERT_EQUAL_STRING_LEN("100", out, n);
	TEST_ASSERT_EQUAL_INT(-EINVAL, units_take('t', KELVIN, "", 0, out, sizeof(out)));
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, units_take('t', KELVIN, "1,2,3", 5, out, 12));
}

static void test_every_scale_is_its_own_inverse(void)
{
	for (uint32_t flags = 0; flags < 0x200000; flags += 0x10000) {
		const char *types = "tgp";

		for (int i = 0; types[i]; i++) {
			char there[64];
			int n = units_take(types[i], flags, "21.5", 4, there, sizeof(there));

			TEST_ASSERT_GREATER_THAN_INT(0, n);
			there[n] = '\0';
			TEST_ASSERT_EQUAL_STRING("        21.5",
			                         units_convert(types[i], flags)
			                                 ? show(types[i], flags, there)
			                                 : "        21.5");
		}
	}
}

static void test_codes_are_those_of_the_genuine_owserver(void)
{
	TEST_ASSERT_EQUAL_INT(-1, code_of(-ENODEV));
	TEST_ASSERT_EQUAL_INT(-1, code_of(-ENOENT));
	TEST_ASSERT_EQUAL_INT(-21, code_of(-EISDIR));
	TEST_ASSERT_EQUAL_INT(-20, code_of(-ENOTDIR));
	TEST_ASSERT_EQUAL_INT(-95, code_of(-EACCES));
	TEST_ASSERT_EQUAL_INT(-22, code_of(-EINVAL));
	TEST_ASSERT_EQUAL_INT(-30, code_of(-EROFS));
	TEST_ASSERT_EQUAL_INT(-5, code_of(-ERANGE)); /* a power-fault reading */
	TEST_ASSERT_EQUAL_INT(-5, code_of(-EDOM));   /* a reading that is none */
	TEST_ASSERT_EQUAL_INT(-34, code_of(-EOVERFLOW));
	TEST_ASSERT_EQUAL_INT(-5, code_of(-ENOTCONN));
}

static void test_there_is_a_text_for_each_code(void)
{
	static char all[16384];
	int n = code_texts(all, sizeof(all)), commas = 0;

	TEST_ASSERT_GREATER_THAN_INT(0, n);
	for (int i = 0; i < n; i++)
		commas += all[i] == ',';
	TEST_ASSERT_EQUAL_INT(CODE_COUNT - 1, commas);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, code_texts(all, 100));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_values_are_shown_in_the_scale_asked_for);
	RUN_TEST(test_a_difference_has_no_zero_point);
	RUN_TEST(test_lists_are_converted_element_by_element);
	RUN_TEST(test_the_list_of_a_logger_is_converted);
	RUN_TEST(test_padding_goes_where_there_are_numbers);
	RUN_TEST(test_what_is_no_number_is_not_converted);
	RUN_TEST(test_what_is_written_comes_back_in_degrees_celsius);
	RUN_TEST(test_every_scale_is_its_own_inverse);
	RUN_TEST(test_codes_are_those_of_the_genuine_owserver);
	RUN_TEST(test_there_is_a_text_for_each_code);
	return UNITY_END();
}
