/* SPDX-License-Identifier: MIT */
/* Tests of the tables of owsctl: columns, widths, narrow terminals. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/text.h"
#include "src/tool/owsctl/table.h"

/* clang-format off */
static const struct table_column columns[] = {
	{"NAME"}, {"VALUE", .right = true, .most = 10}, {"TARGET", .drop = 1}, {"PATH", .drop = 2},
};
/* clang-format on */
static struct table table;
static char line[512];

void setUp(void)
{
	table_init(&table, columns, 4);
}

void tearDown(void)
{
	table_free(&table);
}

static void add(const char *name, const char *value, const char *target, const char *path)
{
	const char *cells[] = {name, value, target, path};

	table_add(&table, cells);
}

static const char *shown(int row)
{
	size_t len = table_line(&table, row, line, sizeof(line));

	TEST_ASSERT_EQUAL_size_t(strlen(line), len);
	return line;
}

static void test_columns_are_as_wide_as_their_cells(void)
{
	add("r", "21.5", "w1", "/28.A/temperature");
	add("K\xc3\xa4lteraum", "-4", "w1", "/28.B/temperature");
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("NAME       VALUE  TARGET  PATH", shown(-1));
	TEST_ASSERT_EQUAL_STRING("r           21.5  w1      /28.A/temperature", shown(0));
	TEST_ASSERT_EQUAL_STRING("K\xc3\xa4lteraum   -4    w1      /28.B/temperature", shown(1));
}

static void test_no_line_ends_in_blanks(void)
{
	add("a", "1", "", "");
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("a         1", shown(0));
}

static void test_a_table_without_rows_has_titles(void)
{
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("NAME  VALUE  TARGET  PATH", shown(-1));
}

static void test_a_narrow_terminal_leaves_columns_out_in_their_order(void)
{
	add("room1", "21.5", "localhost:4304", "/28.A/temperature");
	table_fit(&table, 40);
	TEST_ASSERT_EQUAL_STRING("room1   21.5  localhost:4304", shown(0));
	table_fit(&table, 20);
	TEST_ASSERT_EQUAL_STRING("room1   21.5", shown(0));
}

static void test_a_very_narrow_terminal_cuts_the_widest(void)
{
	add("a-long-name", "21.5", "", "");
	table_fit(&table, 14);
	TEST_ASSERT_EQUAL_STRING("a-long~   21.5", shown(0));
}

/* The columns of the live table, as far as they matter here. */
/* clang-format off */
static const struct table_column live[] = {
	{"NAME"}, {"VALUE", .right = true}, {"QUALITY", .shrink = 13}, {"AGE", .right = true, .drop = 2},
	{"PATH", .drop = 1, .shrink = 16}, {"TARGET", .drop = 3, .spare = true},
};
/* clang-format on */

static void add_live(const char *name, const char *value, const char *quality)
{
	table_add(&table,
	          (const char *const[]){name, value, quality, "1.2s",
	                                "/28.551DDF030000/temperature12", "localhost:4304"});
}

static void test_what_is_spare_goes_before_another_column_is_cut(void)
{
	table_free(&table);
	table_init(&table, live, 6);
	add_live("bedroom", "18.5", "device absent, simulated");
	table_fit(&table, 120);
	TEST_ASSERT_EQUAL_STRING("bedroom   18.5  device absent, simulated  1.2s  "
	                         "/28.551DDF030000/temperature12  localhost:4304",
	                         shown(0));
	table_fit(&table, 80);
	TEST_ASSERT_EQUAL_STRING("bedroom   18.5  device absent, simulated  1.2s  "
	                         "/28.551DDF030000/temperature12",
	                         shown(0));
	table_fit(&table, 70);
	TEST_ASSERT_EQUAL_STRING("bedroom   18.5  device absent, simulat~  1.2s  "
	                         "/28.551DDF030000/tempe~",
	                         shown(0));
}

static void test_the_device_of_a_path_stays_as_long_as_there_is_room_for_it(void)
{
	static const unsigned own = 7 + 2 + 5 + 2 + 13 + 2 + 16;

	table_free(&table);
	table_init(&table, live, 6);
	add_live("bedroom", "18.5", "device absent, simulated");
	for (unsigned width = own; width < 120; width++) {
		table_fit(&table, width);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(shown(0), "/28.551DDF03000"), line);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, "device absen"), line);
	}
	table_fit(&table, own - 1);
	TEST_ASSERT_NULL(strstr(shown(0), "/28"));
}

static void test_decimal_points_stand_below_each_other(void)
{
	add("a", "21.5", "", "x");
	add("b", "-4.0625", "", "x");
	add("c", "100", "", "x");
	add("d", "-", "", "x");
	add("e", "1e-07", "", "x");
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("NAME     VALUE  TARGET  PATH", shown(-1));
	TEST_ASSERT_EQUAL_STRING("a      21.5             x", shown(0));
	TEST_ASSERT_EQUAL_STRING("b      -4.0625          x", shown(1));
	TEST_ASSERT_EQUAL_STRING("c     100               x", shown(2));
	TEST_ASSERT_EQUAL_STRING("d            -          x", shown(3));
	TEST_ASSERT_EQUAL_STRING("e        1e-07          x", shown(4));
}

static void test_a_column_that_is_absent_takes_no_room(void)
{
	add("a", "1", "w1", "/x");
	table.absent[2] = true;
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("NAME  VALUE  PATH", shown(-1));
	TEST_ASSERT_EQUAL_STRING("a         1  /x", shown(0));
}

static void test_every_line_fits_every_width(void)
{
	add("a-long-name", "1234567.25", "localhost:4304", "/28.A/temperature");
	add("\xe6\xb8\xa9\xe5\xba\xa6", "1", "w1", "/28.B/temperature");
	for (unsigned width = 10; width < 80; width++) {
		table_fit(&table, width);
		for (int row = -1; row < 2; row++) {
			table_line(&table, row, line, sizeof(line));
			TEST_ASSERT_TRUE(text_columns(line) <= width);
		}
	}
}

static void test_a_long_cell_is_cut_at_the_limit_of_its_column(void)
{
	add("a", "12345678901", "", "");
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("a     123456789~", shown(0));
}

static void test_cells_cannot_control_the_terminal(void)
{
	add("a\033[2J", "1\n", "", "");
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("a?[2J     1?", shown(0));
}

static void test_a_small_buffer_is_not_exceeded(void)
{
	char small[64];

	add("room1", "21.5", "localhost:4304", "/28.A/temperature");
	table_fit(&table, 0);
	for (size_t size = 1; size < sizeof(small); size++) {
		memset(small, 0x55, sizeof(small));
		TEST_ASSERT_TRUE(table_line(&table, 0, small, size) < size);
		TEST_ASSERT_EQUAL_HEX8(0x55, small[size]);
	}
}

static void test_columns_do_not_shrink_below_the_least_width(void)
{
	add("a", "1", "w1", "/x");
	table.least[0] = 8;
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("a             1  w1      /x", shown(0));
}

static void test_many_rows_are_kept(void)
{
	char name[16];

	for (int i = 0; i < 1000; i++) {
		snprintf(name, sizeof(name), "s%d", i);
		add(name, "1", "", "");
	}
	table_fit(&table, 0);
	TEST_ASSERT_EQUAL_STRING("s999      1", shown(999));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_columns_are_as_wide_as_their_cells);
	RUN_TEST(test_no_line_ends_in_blanks);
	RUN_TEST(test_a_table_without_rows_has_titles);
	RUN_TEST(test_a_narrow_terminal_leaves_columns_out_in_their_order);
	RUN_TEST(test_a_very_narrow_terminal_cuts_the_widest);
	RUN_TEST(test_what_is_spare_goes_before_another_column_is_cut);
	RUN_TEST(test_the_device_of_a_path_stays_as_long_as_there_is_room_for_it);
	RUN_TEST(test_decimal_points_stand_below_each_other);
	RUN_TEST(test_a_column_that_is_absent_takes_no_room);
	RUN_TEST(test_every_line_fits_every_width);
	RUN_TEST(test_a_long_cell_is_cut_at_the_limit_of_its_column);
	RUN_TEST(test_cells_cannot_control_the_terminal);
	RUN_TEST(test_a_small_buffer_is_not_exceeded);
	RUN_TEST(test_columns_do_not_shrink_below_the_least_width);
	RUN_TEST(test_many_rows_are_kept);
	return UNITY_END();
}
