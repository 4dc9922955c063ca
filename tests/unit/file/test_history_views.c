/* SPDX-License-Identifier: MIT */
/* The views of a history, as SQL sees them. */
#include "src/history/file/views.h"

#include <stdio.h>
#include <string.h>

#include "tests/unit/aid/past.h"
#include "unity.h"

static struct past past;

void setUp(void)
{
	past_make(&past);
}

void tearDown(void)
{
}

/* Each row of a table stands in its view once, on its day, whatever clocks were set. */
static void test_a_view_has_each_row_on_one_day(void)
{
	static const char *const questions[] = {
		"select count(*) from raw where id not in (select id from trend)",
		"select count(*) - count(distinct id) from trend where name = 'room'",
		"select count(*) from trend where day <> date(time)",
		"select count(*) from trend_minute where day <> date(time)"
		" and day <> date(time, '+1 minute')",
		"select count(*) from trend_hour where day <> date(time)"
		" and day <> date(time, '+1 hour')",
		"select count(*) - count(distinct time || name) from trend_minute",
		"select count(*) - count(distinct time || name) from trend_hour",
		"select count(*) - (select count(*) from hour) from trend_hour",
		"select count(*) from day later join day using (day) where later.start > day.start"
		" and later.start < day.until",
	};
	static const int64_t steps[] = {PAST_NOON, PAST_NOON + 7 * PAST_S, PAST_DAY};
	int64_t now = 5 * PAST_S;

	/* an hour before midnight; then the clock is set, and at last nobody knows it */
	for (size_t run = 0; run < sizeof(steps) / sizeof(steps[0]); run++) {
		int64_t begun = now;

		past_begin(&past, now, steps[run] + PAST_DAY / 24 * 11, steps[run] != PAST_DAY);
		for (; now < begun + PAST_DAY / 10; now += 25 * PAST_S)
			past_room(&past, now, (double)(now / PAST_S));
		past_end(&past, now);
		now += 61 * PAST_S;
	}
	for (size_t i = 0; i < sizeof(questions) / sizeof(questions[0]); i++)
		TEST_ASSERT_EQUAL_INT64_MESSAGE(0, past_ask(&past, questions[i]), questions[i]);
	TEST_ASSERT_TRUE(past_ask(&past, "select count(distinct day) from trend") >= 2);
	TEST_ASSERT_TRUE(past_ask(&past, "select count(*) from trend_hour") >= 6);
}

static void alarm_of(uint8_t kind, uint8_t what, int64_t time_ns)
{
	struct history_event event = {.kind = OWS_HISTORY_ALARM, .time_ns = time_ns};

	event.reason = kind;
	event.event = what;
	history_writer_event(past.writer, &event);
}

static void test_an_alarm_has_its_end_and_one_that_stands_has_none(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	alarm_of(OWS_ALARM_H, OWS_ALARM_RAISED, 7 * PAST_S);
	alarm_of(OWS_ALARM_HH, OWS_ALARM_RAISED, 8 * PAST_S);
	alarm_of(OWS_ALARM_HH, OWS_ALARM_ACKNOWLEDGED, 9 * PAST_S);
	alarm_of(OWS_ALARM_HH, OWS_ALARM_RETURNED, 11 * PAST_S);
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(*) from trend_alarm"));
	TEST_ASSERT_EQUAL_INT64(3, past_ask(&past, "select seconds from trend_alarm where alarm ="
	                                           " 'high high' and until = '2024-10-04T12:00:11"
	                                           ".000Z'"));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select until is null and name = 'room' from"
	                                           " trend_alarm where alarm = 'high'"));
}

/* A query that names a day finds its rows by their number; so one of years is quick. */
static void test_rows_of_a_day_are_found_by_their_number(void)
{
	static const char *const tables[] = {"raw", "minute", "hour"};
	static const char *const views[] = {"trend", "trend_minute", "trend_hour"};
	char path[400], text[300];
	sqlite3 *db;

	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 21.5);
	past_end(&past, 20 * PAST_S);
	snprintf(path, sizeof(path), "%s/history.sqlite", past.directory);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_open(path, &db));
	/* they are what they were when they are made anew */
	TEST_ASSERT_EQUAL_INT(0, views_drop(db));
	TEST_ASSERT_EQUAL_INT(0, views_make(db));
	for (size_t i = 0; i < sizeof(views) / sizeof(views[0]); i++) {
		sqlite3_stmt *plan;
		bool found = false;

		snprintf(text, sizeof(text),
		         "explain query plan select * from %s where name = 'room' and day ="
		         " '2024-10-04' and time > '2024'",
		         views[i]);
		TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_prepare_v2(db, text, -1, &plan, NULL));
		snprintf(text, sizeof(text), "%s USING INTEGER PRIMARY KEY (rowid>? AND rowid<?)",
		         tables[i]);
		while (sqlite3_step(plan) == SQLITE_ROW)
			found |= strstr((const char *)sqlite3_column_text(plan, 3), text) != NULL;
		sqlite3_finalize(plan);
		TEST_ASSERT_TRUE_MESSAGE(found, text);
	}
	sqlite3_close(db);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_view_has_each_row_on_one_day);
	RUN_TEST(test_an_alarm_has_its_end_and_one_that_stands_has_none);
	RUN_TEST(test_rows_of_a_day_are_found_by_their_number);
	return UNITY_END();
}
