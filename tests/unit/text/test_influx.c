/* SPDX-License-Identifier: MIT */
/* Tests of InfluxDB's line protocol: series and fields. */
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/influx.h"

static char fields[INFLUX_FIELDS];

void setUp(void)
{
}

void tearDown(void)
{
}

static bool of_text(const char *text)
{
	return influx_fields(OWS_STRING, 0, 0, text, strlen(text), fields);
}

static void test_a_tag_that_no_line_can_have_is_left_out(void)
{
	char series[INFLUX_SERIES], name[INFLUX_SERIES];

	TEST_ASSERT_TRUE(influx_series("ows", "/28/t=", "a=b, c", "a", "°C", series));
	TEST_ASSERT_EQUAL_STRING("ows,identity=/28/t\\=,instance=a\\=b\\,\\ c,signal=a,unit=°C",
	                         series);
	TEST_ASSERT_TRUE(influx_series("ows", "", "OWS", "a", "m\\", series));
	TEST_ASSERT_EQUAL_STRING("ows,instance=OWS,signal=a", series);
	TEST_ASSERT_TRUE(influx_series("house", "", "x\ny", "a", "m s", series));
	TEST_ASSERT_EQUAL_STRING("house,signal=a,unit=m\\ s", series);
	TEST_ASSERT_FALSE(influx_series("ows", "", "OWS", "a\nb", "", series));
	TEST_ASSERT_FALSE(influx_series("ows", "", "OWS", "", "", series));
	memset(name, 'n', sizeof(name));
	name[INFLUX_SERIES - 13] = '\0'; /* one more than fits behind "ows,signal=" */
	TEST_ASSERT_FALSE(influx_series("ows", "", "", name, "x", series));
	name[INFLUX_SERIES - 12 - 7] = '\0';
	TEST_ASSERT_TRUE(influx_series("ows", "", "", name, "x", series));
	TEST_ASSERT_EQUAL_size_t(INFLUX_SERIES - 1, strlen(series));
}

static void test_each_number_is_a_float_and_a_large_one_also_exact(void)
{
	TEST_ASSERT_TRUE(influx_fields(OWS_DOUBLE, -21.125, 0, "", 0, fields));
	TEST_ASSERT_EQUAL_STRING("value=-21.125", fields);
	TEST_ASSERT_TRUE(influx_fields(OWS_BOOL, 1, 1, "", 0, fields));
	TEST_ASSERT_EQUAL_STRING("value=1", fields);
	TEST_ASSERT_TRUE(
		influx_fields(OWS_LARGE, 9007199254740992.0, 9007199254740993, "", 0, fields));
	TEST_ASSERT_EQUAL_STRING("value=9007199254740993,integer=9007199254740993i", fields);
	TEST_ASSERT_FALSE(influx_fields(OWS_DOUBLE, NAN, 0, "", 0, fields));
	TEST_ASSERT_FALSE(influx_fields(OWS_FLOAT, -INFINITY, 0, "", 0, fields));
}

static void test_a_text_is_escaped_and_has_an_end(void)
{
	char longest[VALUE_STRING_MAX + 2];

	TEST_ASSERT_TRUE(of_text("a \"b\", \\c=d"));
	TEST_ASSERT_EQUAL_STRING("text=\"a \\\"b\\\", \\\\c=d\"", fields);
	TEST_ASSERT_TRUE(of_text(""));
	TEST_ASSERT_EQUAL_STRING("text=\"\"", fields);
	TEST_ASSERT_FALSE(of_text("a\nb"));
	TEST_ASSERT_FALSE(of_text("a\x7f"));
	memset(longest, '"', sizeof(longest));
	longest[VALUE_STRING_MAX + 1] = '\0';
	TEST_ASSERT_FALSE(of_text(longest));
	longest[VALUE_STRING_MAX] = '\0';
	TEST_ASSERT_TRUE(of_text(longest));
	TEST_ASSERT_EQUAL_size_t(2 * VALUE_STRING_MAX + strlen("text=\"\""), strlen(fields));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_tag_that_no_line_can_have_is_left_out);
	RUN_TEST(test_each_number_is_a_float_and_a_large_one_also_exact);
	RUN_TEST(test_a_text_is_escaped_and_has_an_end);
	return UNITY_END();
}
