/* SPDX-License-Identifier: MIT */
/* Tests of the plot in braille patterns. */
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/plot.h"

static struct ows_history_point points[2 * PLOT_WIDTH_MAX];
static char text[PLOT_TEXT];
static double low, high;

void setUp(void)
{
	memset(points, 0, sizeof(points));
	for (int i = 0; i < 2 * PLOT_WIDTH_MAX; i++)
		points[i].min = points[i].max = points[i].last = NAN;
}

void tearDown(void)
{
}

static void put(int i, double min, double max)
{
	points[i].min = min;
	points[i].max = points[i].last = max;
	points[i].good_ns = points[i].known_ns = 1;
}

static void test_a_ramp_goes_from_the_lower_left_to_the_upper_right(void)
{
	for (int i = 0; i < 4; i++)
		put(i, 10 + i, 10 + i);
	TEST_ASSERT_TRUE(plot_draw(points, 2, 1, &low, &high, text));
	TEST_ASSERT_EQUAL_DOUBLE(10, low);
	TEST_ASSERT_EQUAL_DOUBLE(13, high);
	TEST_ASSERT_EQUAL_STRING("⡠⠊\n──\n", text);
}

static void test_a_column_reaches_from_its_minimum_to_its_maximum(void)
{
	put(0, -1, 1);
	put(1, 1, 1);
	TEST_ASSERT_TRUE(plot_draw(points, 1, 2, &low, &high, text));
	TEST_ASSERT_EQUAL_STRING("⡏\n⡇\n─\n", text);
}

static void test_a_constant_stands_in_the_middle(void)
{
	put(0, 5, 5);
	put(1, 5, 5);
	TEST_ASSERT_TRUE(plot_draw(points, 1, 1, &low, &high, text));
	TEST_ASSERT_EQUAL_STRING("⠤\n─\n", text);
}

static void test_so_do_two_values_with_nothing_between_them(void)
{
	put(0, 0, 0);
	put(1, 4.9e-324, 4.9e-324);
	TEST_ASSERT_TRUE(plot_draw(points, 1, 1, &low, &high, text));
	TEST_ASSERT_EQUAL_STRING("⠤\n─\n", text);
}

static void test_a_gap_is_blank_and_what_is_not_good_is_marked(void)
{
	put(0, 1, 1);
	put(6, 2, 2);
	points[4].known_ns = 1;
	TEST_ASSERT_TRUE(plot_draw(points, 4, 1, &low, &high, text));
	TEST_ASSERT_EQUAL_STRING("⡀⠀⠀⠁\n─ ×─\n", text);
}

static void test_without_a_good_value_there_is_no_picture(void)
{
	points[0].known_ns = 1;
	TEST_ASSERT_FALSE(plot_draw(points, 4, 1, &low, &high, text));
	TEST_ASSERT_EQUAL_STRING("", text);
}

static void test_extreme_values_and_sizes_stay_within_the_picture(void)
{
	for (int i = 0; i < 2 * PLOT_WIDTH_MAX; i++)
		put(i, i % 2 ? -1.7e308 : 1.7e308, 1.7e308);
	TEST_ASSERT_TRUE(
		plot_draw(points, PLOT_WIDTH_MAX + 100, PLOT_HEIGHT_MAX + 9, &low, &high, text));
	TEST_ASSERT_EQUAL_size_t((PLOT_HEIGHT_MAX + 1) * (PLOT_WIDTH_MAX * 3 + 1), strlen(text));
	TEST_ASSERT_EQUAL_DOUBLE(-1.7e308, low);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ramp_goes_from_the_lower_left_to_the_upper_right);
	RUN_TEST(test_a_column_reaches_from_its_minimum_to_its_maximum);
	RUN_TEST(test_a_constant_stands_in_the_middle);
	RUN_TEST(test_so_do_two_values_with_nothing_between_them);
	RUN_TEST(test_a_gap_is_blank_and_what_is_not_good_is_marked);
	RUN_TEST(test_without_a_good_value_there_is_no_picture);
	RUN_TEST(test_extreme_values_and_sizes_stay_within_the_picture);
	return UNITY_END();
}
