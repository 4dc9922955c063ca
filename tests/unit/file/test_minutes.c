/* SPDX-License-Identifier: MIT */
/* Tests of an hour's minutes as one text, and of which sums go to the file as that. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/history/file/schema.h"
#include "src/history/file/sql.h"
#include "src/history/file/sums.h"
#include "tests/unit/aid/past.h"

static struct minute minutes[MINUTES], back[MINUTES];
static char text[MINUTES_TEXT];

void setUp(void)
{
	memset(minutes, 0, sizeof(minutes));
}

void tearDown(void)
{
}

static void put(int at, double least, double most, double mean, double last)
{
	minutes[at] = (struct minute){.least = least,
	                              .most = most,
	                              .mean = mean,
	                              .last = last,
	                              .good_us = MINUTE_US,
	                              .known_us = MINUTE_US,
	                              .count = 1,
	                              .quality = OWS_Q_GOOD,
	                              .worst = OWS_Q_GOOD,
	                              .there = true};
}

/* Doubles are the same, but the mean, which is near. */
static void check(double near)
{
	TEST_ASSERT_TRUE(minutes_pack(minutes, text));
	TEST_ASSERT_EQUAL_INT(0, minutes_unpack(text, back));
	for (int i = 0; i < MINUTES; i++) {
		struct minute *a = &minutes[i], *b = &back[i];

		TEST_ASSERT_EQUAL_INT(a->there, b->there);
		if (!a->there)
			continue;
		TEST_ASSERT_TRUE(a->least == b->least || (isnan(a->least) && isnan(b->least)));
		TEST_ASSERT_TRUE(a->most == b->most || isnan(a->least));
		TEST_ASSERT_TRUE(a->last == b->last || isnan(a->least));
		if (!isnan(a->least))
			TEST_ASSERT_DOUBLE_WITHIN(near, a->mean, b->mean);
		TEST_ASSERT_EQUAL_INT64(a->good_us, b->good_us);
		TEST_ASSERT_EQUAL_INT64(a->known_us, b->known_us);
		TEST_ASSERT_EQUAL_UINT32(a->count, b->count);
		TEST_ASSERT_EQUAL_INT16(a->quality, b->quality);
		TEST_ASSERT_EQUAL_INT16(a->worst, b->worst);
	}
}

static void test_what_is_as_mostly_is_left_out(void)
{
	put(0, 21.5, 21.5, 21.5, 21.5);
	put(7, 21.5, 21.75, 21.55, 21.5);
	put(59, 21.5, 21.5, 21.5, 21.5);
	minutes[59].known_us = 59 * 1000000;
	check(1e-9);
	TEST_ASSERT_EQUAL_STRING("[21500000,250000,[0,1,0],[7,1,0,0,1,200],"
	                         "[59,1,0,0,0,0,60000000,59000000]]",
	                         text);
	put(59, NAN, NAN, NAN, NAN);
	minutes[59].quality = minutes[59].worst = OWS_Q_DEVICE;
	check(1e-9);
	TEST_ASSERT_NOT_NULL(strstr(text, "[59,1,null,null,null,null,60000000,60000000,"));
	minutes[59].quality = minutes[59].worst = -1;
	check(1e-9);
}

static void test_values_come_back_to_the_last_bit(void)
{
	static const double steps[] = {1, 0.5, 0.0625, 0.1, 0.01, 1e-6, 1000};

	for (int turn = 0; turn < 2000; turn++) {
		double step = steps[past_random(7)];

		memset(minutes, 0, sizeof(minutes));
		for (int i = 0; i < MINUTES; i++) {
			double n[3];

			for (int k = 0; k < 3; k++) {
				/* as a program reads it: the nearest to so many decimals */
				double whole = (double)past_random(100000) - 50000;

				n[k] = step < 1 ? whole / round(1 / step) : whole * step;
			}
			if (past_random(3))
				put(i, fmin(n[0], n[1]), fmax(n[0], n[1]), (n[0] + n[1]) / 2, n[2]);
			minutes[i].count = past_random(70000);
			minutes[i].worst = (int16_t)past_random(256);
			minutes[i].good_us = past_random(60000001);
		}
		check(step / 1000);
	}
	put(0, 4294967295, 4294967295, 4294967295, 4294967295);
	put(1, -1e9, 4294967295, 5, 0);
	check(1e9);
}

static void test_values_that_do_not_fit_are_refused(void)
{
	static const double odd[] = {1e10, -1e10, 0.12345678, 1e-9, 1.0 / 3, INFINITY};

	for (size_t i = 0; i < sizeof(odd) / sizeof(odd[0]); i++) {
		put(3, odd[i], odd[i], odd[i], odd[i]);
		TEST_ASSERT_FALSE(minutes_pack(minutes, text));
	}
}

static void test_a_text_that_is_none_is_refused(void)
{
	static const char *const bad[] = {"",
	                                  "[",
	                                  "[1]",
	                                  "[1,2",
	                                  "[1,2,",
	                                  "[1,2,[",
	                                  "[1,2,[3,4]]",
	                                  "[1,2,[3,4,5]",
	                                  "[1,2,[60,1,1]]",
	                                  "[1,2,[-1,1,1]]",
	                                  "[1,2,[3,1,1]]x",
	                                  "[1,2,[3,1,x]]",
	                                  "[a,2]",
	                                  "[1,2,[null,1,1]]",
	                                  "[1,2,[1,1,1,1,1,1,1,1,1,1,1]]"};

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_EQUAL_INT(-EBADMSG, minutes_unpack(bad[i], back));
	TEST_ASSERT_EQUAL_INT(0, minutes_unpack("[1,2]", back));
	/* the text may say any number, and what is taken of it is a time within the minute */
	TEST_ASSERT_EQUAL_INT(0, minutes_unpack("[9223372036854775807,9223372036854775807,[3,"
	                                        "-9223372036854775808,9223372036854775807,1,1,1,"
	                                        "-5,99999999999999999999,-7,777]]",
	                                        back));
	for (int i = 0; i < MINUTES; i++) {
		struct rollup_state state;
		struct rollup sum;

		minute_take(&back[i], MINUTE_US, &sum, &state);
		TEST_ASSERT_TRUE(sum.good_us >= 0 && sum.known_us <= MINUTE_US);
	}
}

/* A sum becomes a row of the file, and a row a sum. */
static void test_a_sum_is_the_same_after_it_was_a_row(void)
{
	struct rollup_state state = {.value = 5, .quality = OWS_Q_GOOD, .known = true}, end;
	struct rollup sum = {0}, after;
	struct minute row;

	rollup_value(&sum, &state);
	rollup_hold(&sum, &state, 20);
	row = minute_of(&sum, &state);
	minute_take(&row, MINUTE_US, &after, &end);
	TEST_ASSERT_EQUAL_MEMORY(&sum, &after, sizeof(sum));
	TEST_ASSERT_EQUAL_UINT8(state.quality, end.quality);
	row = minute_of(&(struct rollup){0}, &(struct rollup_state){0});
	minute_take(&row, MINUTE_US, &after, &end);
	TEST_ASSERT_FALSE(after.has_value || after.has_quality || end.known);
}

/* An hour of a signal is a row; of values that do not fit, and of a late signal, a row a minute. */
static void test_an_hour_is_a_row_or_one_for_each_minute(void)
{
	static const struct {
		uint32_t signal;
		double value;
		int64_t rows;
	} cases[] = {{1, 21.5, 1}, {2, 1.0 / 3, 2}, {SUMS_HELD, 21.5, 2}, {3, 21.5, 0}};
	struct rollup_state state = {.quality = OWS_Q_GOOD, .known = true};
	sqlite3_stmt *statements[S_COUNT] = {0};
	struct sums sums = {.statements = statements};
	sqlite3 *db;

	TEST_ASSERT_EQUAL_INT(0, schema_open(":memory:", &db));
	TEST_ASSERT_EQUAL_INT(0, statements_open(db, statements));
	sums_begin(&sums, 10);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		/* the file has the hour before */
		int64_t hour = cases[i].rows ? 10 : 9, rows = -1, hours = -1;
		struct rollup sum = {0};

		state.value = cases[i].value;
		rollup_value(&sum, &state);
		for (int minute = 0; minute < 2; minute++)
			TEST_ASSERT_EQUAL_INT(0, sums_give(&sums, false, hour * MINUTES + minute,
			                                   cases[i].signal, &sum, &state));
		TEST_ASSERT_EQUAL_INT(0,
		                      sums_give(&sums, true, hour, cases[i].signal, &sum, &state));
		TEST_ASSERT_EQUAL_INT(1, sql_ask(db, "select count(*) from minute", &rows));
		TEST_ASSERT_EQUAL_INT(1, sql_ask(db, "select count(*) from hour", &hours));
		TEST_ASSERT_EQUAL_INT64(cases[i].rows, rows);
		TEST_ASSERT_EQUAL_INT64(cases[i].rows > 0, hours);
		TEST_ASSERT_EQUAL_INT(0, sql_exec(db, "delete from minute; delete from hour"));
	}
	sums_free(&sums);
	statements_close(statements);
	sqlite3_close(db);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_as_mostly_is_left_out);
	RUN_TEST(test_values_come_back_to_the_last_bit);
	RUN_TEST(test_values_that_do_not_fit_are_refused);
	RUN_TEST(test_a_text_that_is_none_is_refused);
	RUN_TEST(test_a_sum_is_the_same_after_it_was_a_row);
	RUN_TEST(test_an_hour_is_a_row_or_one_for_each_minute);
	return UNITY_END();
}
