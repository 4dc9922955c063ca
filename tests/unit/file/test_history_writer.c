/* SPDX-License-Identifier: MIT */
/* Tests of the writer of history, by what libows-history reads of its file. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/history/file/schema.h"
#include "tests/unit/aid/past.h"

static struct past past;
static struct ows_history_item *items;

void setUp(void)
{
	past_make(&past);
}

void tearDown(void)
{
	if (past.writer)
		history_writer_close(past.writer, 1000 * PAST_DAY);
	past.writer = NULL;
}

static int count_of(int signal)
{
	return past_items(&past, signal, &items);
}

static const char *file(const char *more)
{
	static char path[400];

	snprintf(path, sizeof(path), "%s/history.sqlite%s", past.directory, more);
	return path;
}

/* Commits since the last question. */
static int new_commits(void)
{
	static uint64_t before;
	struct history_state state;
	uint64_t was = before;

	history_writer_state(past.writer, &state);
	before = state.commits;
	return (int)(before - (was > before ? 0 : was));
}

/* Each second, with that many changes. */
static void seconds(int from, int until, int changes)
{
	for (int s = from; s < until; s++) {
		for (int i = 0; i < changes; i++)
			past_room(&past, s * PAST_S + i, s + i);
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, s * PAST_S));
	}
}

static void alarm_at(int s)
{
	history_writer_event(past.writer, &(struct history_event){.kind = OWS_HISTORY_ALARM,
	                                                          .signal = PAST_ROOM,
	                                                          .time_ns = s * PAST_S});
}

/* Rows of the same time are microseconds apart. */
static void expect(int i, int64_t boot_ns, double value)
{
	TEST_ASSERT_INT64_WITHIN(20000, boot_ns, items[i].boot_ns);
	TEST_ASSERT_TRUE(items[i].known);
	TEST_ASSERT_EQUAL_DOUBLE(value, items[i].number);
}

static void expect_gap(int i, int64_t boot_ns, enum ows_history_reason reason)
{
	TEST_ASSERT_FALSE(items[i].known);
	TEST_ASSERT_INT64_WITHIN(20000, boot_ns, items[i].boot_ns);
	TEST_ASSERT_EQUAL_STRING(ows_history_reason_text((uint8_t)reason),
	                         ows_history_reason_text(items[i].reason));
}

static void test_what_is_recorded_is_read_in_the_order_of_time(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 21.5);
	past_lamp(&past, 6 * PAST_S, 1); /* measured earlier, and recorded later */
	past_title(&past, 8 * PAST_S, "it's \"Küche\"");
	past_room(&past, 9 * PAST_S, 22);
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_ROOM));
	expect(0, 7 * PAST_S, 21.5);
	expect(1, 9 * PAST_S, 22);
	TEST_ASSERT_EQUAL_INT64(PAST_NOON + 9 * PAST_S, items[1].time_ns);
	TEST_ASSERT_TRUE(items[1].trusted);
	expect_gap(2, 20 * PAST_S, OWS_HISTORY_STOPPED);
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_LAMP));
	expect(0, 6 * PAST_S, 1);
	TEST_ASSERT_EQUAL_INT64(1, items[0].integer);
	TEST_ASSERT_EQUAL_INT64(3, past_ask(&past, "select count(*) from signal"));
	/* those of the file's ids that the clock makes dates of are dates */
	TEST_ASSERT_EQUAL_INT64((PAST_NOON + 6 * PAST_S) / 1000,
	                        past_ask(&past, "select min(id) from raw"));
}

static void test_a_reader_of_sql_sees_names_units_times_and_words(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 21.5);
	history_writer_value(past.writer, PAST_ROOM, 8 * PAST_S, OWS_Q_DEVICE, 0, NULL, 0);
	past_lamp(&past, 9 * PAST_S, 1);
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from trend where name = 'room'"
	                                           " and value = 21.5 and unit = '°C'"
	                                           " and quality = 'good'"
	                                           " and time = '2024-10-04T12:00:07.000Z'"));
	/* a bad value is never a number that could be believed */
	TEST_ASSERT_EQUAL_INT64(1,
	                        past_ask(&past, "select count(*) from trend where name = 'room'"
	                                        " and value is null and quality = 'device error'"));
	/* what ends all signals ends each, behind its last value */
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(distinct name) from trend"
	                                           " where quality = 'recorder stopped'"));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select quality = 'recorder stopped' from trend"
	                                           " where name = 'room' order by id desc"));
}

static void check_words(const char *kind, const char *what)
{
	char text[160];

	snprintf(text, sizeof(text),
	         "select count(*) from trend_event where kind = '%s' and what = '%s'", kind, what);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(1, past_ask(&past, text), text);
}

static void record_events(void)
{
	struct history_event event = {.kind = OWS_HISTORY_ALARM, .time_ns = 7 * PAST_S};

	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	event.reason = OWS_ALARM_DIFFERS;
	event.event = OWS_ALARM_RAISED;
	history_writer_event(past.writer, &event);
	event.reason = OWS_ALARM_DEVICE;
	event.event = OWS_ALARM_FAILED;
	history_writer_event(past.writer, &event);
	event.reason = 0;
	event.event = OWS_ALARM_SHELVED;
	history_writer_event(past.writer, &event);
	event.kind = OWS_HISTORY_COMMAND;
	event.reason = OWS_REASON_NONE;
	history_writer_event(past.writer, &event);
	event.reason = OWS_REASON_LAST;
	history_writer_event(past.writer, &event);
	past_end(&past, 20 * PAST_S);
}

static void check_events(void)
{
	check_words("alarm", "not as commanded raised");
	check_words("alarm", "device failed");
	check_words("alarm", "shelved");
	check_words("command", "none");
	check_words("command", "last");
	TEST_ASSERT_EQUAL_INT64(5, past_ask(&past, "select count(*) from trend_event"));
}

static void test_a_reader_of_sql_sees_what_an_event_was(void)
{
	record_events();
	check_events();
	past_begin(&past, 40 * PAST_S, PAST_NOON, false);
	history_writer_clock(past.writer, 41 * PAST_S, PAST_NOON - 90 * PAST_S, false);
	history_writer_clock(past.writer, 42 * PAST_S, PAST_NOON - 90 * PAST_S, true);
	past_end(&past, 43 * PAST_S);
	check_words("clock", "set");
	check_words("clock", "trust changed");
	TEST_ASSERT_EQUAL_INT64(-90, past_ask(&past, "select value from trend_event where"
	                                             " what = 'set' and unit = 's'"));
}

/* A hash of all values with their ids. */
static int64_t values(void)
{
	return past_ask(&past, "select total(id % 1000003 * (signal + 7) + value) from raw");
}

static void test_a_clock_that_is_late_or_set_moves_dates_and_changes_no_value(void)
{
	int64_t before, start;

	past_begin(&past, 5 * PAST_S, 1000 * PAST_DAY, false);
	past_room(&past, 7 * PAST_S, 21.5);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 8 * PAST_S));
	before = values();
	start = past_ask(&past, "select max(start) from session");
	count_of(PAST_ROOM);
	TEST_ASSERT_FALSE(items[0].trusted);
	history_writer_clock(past.writer, 9 * PAST_S, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 9 * PAST_S));
	TEST_ASSERT_EQUAL_INT64(before, values());
	TEST_ASSERT_EQUAL_INT64(start, past_ask(&past, "select max(start) from session"));
	TEST_ASSERT_TRUE(count_of(PAST_ROOM) > 0);
	TEST_ASSERT_TRUE(items[0].trusted);
	TEST_ASSERT_EQUAL_INT64(PAST_NOON + 7 * PAST_S, items[0].time_ns);
	/* back by an hour: what was before moves along, and time within the boot goes on */
	history_writer_clock(past.writer, 10 * PAST_S, PAST_NOON - 3600 * PAST_S, true);
	past_room(&past, 11 * PAST_S, 22);
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_ROOM));
	TEST_ASSERT_EQUAL_INT64(4 * PAST_S, items[1].time_ns - items[0].time_ns);
	TEST_ASSERT_EQUAL_INT64(PAST_NOON - 3600 * PAST_S + 7 * PAST_S, items[0].time_ns);
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(*) from event where kind = 6"));
}

static void test_ids_never_go_back_whatever_the_clock_says(void)
{
	static const struct {
		int64_t boot, now_ns, offset_ns;
		bool trusted;
	} runs[] = {
		{1, 5 * PAST_S, PAST_NOON, true},
		{1, 50 * PAST_S, PAST_NOON - 400 * PAST_DAY, true},
		{2, 3 * PAST_S, 0, false},
		{2, 90 * PAST_S, 10 * PAST_DAY, false},
		{3, 1 * PAST_S, PAST_NOON + PAST_DAY, true},
	};
	int64_t last = 0;

	for (size_t i = 0; i < sizeof(runs) / sizeof(runs[0]); i++) {
		past.options.boot = runs[i].boot;
		past_begin(&past, runs[i].now_ns, runs[i].offset_ns, runs[i].trusted);
		past_room(&past, runs[i].now_ns + 1, (double)i);
		past_room(&past, runs[i].now_ns + 2 * PAST_S, (double)i + 100);
		past_end(&past, runs[i].now_ns + 4 * PAST_S);
		TEST_ASSERT_TRUE(past_ask(&past, "select max(id) from raw") > last);
		last = past_ask(&past, "select max(start) from gap");
	}
	/* the run that has no date follows the one before it in time; the last one has its date */
	TEST_ASSERT_EQUAL_INT64((PAST_NOON + PAST_DAY + PAST_S) / 1000,
	                        past_ask(&past, "select max(start) from session"));
	TEST_ASSERT_EQUAL_INT(15, count_of(PAST_ROOM));
	for (int i = 0; i < 15; i += 3) {
		TEST_ASSERT_EQUAL_DOUBLE(i / 3, items[i].number);
		TEST_ASSERT_EQUAL_INT64(runs[i / 3].now_ns + 2 * PAST_S, items[i + 1].boot_ns);
		expect_gap(i + 2, runs[i / 3].now_ns + 4 * PAST_S, OWS_HISTORY_STOPPED);
	}
}

static void test_a_run_that_ended_without_a_word_ends_where_it_last_looked(void)
{
	char command[1400], copy[300];

	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 21.5);
	for (int64_t second = 8; second < 1300; second++)
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, second * PAST_S));
	snprintf(copy, sizeof(copy), "%.280s-cut", past.directory);
	snprintf(command, sizeof(command), "mkdir %s && cp %s/* %s && rm %s/*-shm", copy,
	         past.directory, copy, copy);
	TEST_ASSERT_EQUAL_INT(0, system(command));
	past_end(&past, 1300 * PAST_S);
	snprintf(past.directory, sizeof(past.directory), "%s", copy);
	past_begin(&past, 2000 * PAST_S, PAST_NOON, true);
	past_room(&past, 2001 * PAST_S, 22);
	past_end(&past, 2002 * PAST_S);
	TEST_ASSERT_EQUAL_INT(4, count_of(PAST_ROOM));
	expect(0, 7 * PAST_S, 21.5);
	TEST_ASSERT_EQUAL_STRING("recorder or machine lost",
	                         ows_history_reason_text(items[1].reason));
	/* it says each ten minutes that it looks, though nothing changes */
	TEST_ASSERT_TRUE(items[1].boot_ns > 600 * PAST_S && items[1].boot_ns < 1300 * PAST_S);
	expect(2, 2001 * PAST_S, 22);
}

/* A gap that is known longer by now is one; values between two of one time make them two. */
static void test_a_gap_at_the_time_of_values_after_a_gap_is_another(void)
{
	for (unsigned values = 0; values < 2; values++) {
		past_make(&past);
		past_begin(&past, 10 * PAST_S, PAST_NOON, true);
		past_room(&past, 10 * PAST_S, 19);
		history_writer_gap(past.writer, 11 * PAST_S, 12 * PAST_S, OWS_HISTORY_OWSD_LOST);
		history_writer_gap(past.writer, 11 * PAST_S, 12 * PAST_S, OWS_HISTORY_OWSD_LOST);
		if (values)
			past_room(&past, 11 * PAST_S, 20);
		history_writer_gap(past.writer, 11 * PAST_S, 15 * PAST_S, OWS_HISTORY_OWSD_LOST);
		past_room(&past, 15 * PAST_S, 21);
		past_end(&past, 20 * PAST_S);
		TEST_ASSERT_EQUAL_INT64(
			1 + values, past_ask(&past, "select count(*) from gap where reason = 3"));
		TEST_ASSERT_EQUAL_INT(4 + 2 * (int)values, past_items(&past, PAST_ROOM, &items));
		for (unsigned i = 0; i < 4 + 2 * values; i++)
			TEST_ASSERT_EQUAL_UINT8(i % 2 == 0, items[i].known);
	}
}

static void test_gaps_are_read_as_gaps_and_values_after_them_are_new(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 1);
	past_lamp(&past, 7 * PAST_S, 1);
	history_writer_gap(past.writer, 10 * PAST_S, 12 * PAST_S, OWS_HISTORY_OWSD_LOST);
	past_room(&past, 9 * PAST_S, 2); /* measured before it, and known after it */
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 14 * PAST_S));
	history_writer_forget(past.writer, PAST_ROOM, 13 * PAST_S, OWS_HISTORY_OVERRUN);
	past_room(&past, 15 * PAST_S, 3);
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(past.writer, past_signals, 1, 18 * PAST_S));
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT(6, count_of(PAST_ROOM));
	expect(0, 7 * PAST_S, 1);
	expect_gap(1, 10 * PAST_S, OWS_HISTORY_OWSD_LOST);
	TEST_ASSERT_INT64_WITHIN(20000, 10 * PAST_S, items[2].boot_ns);
	expect_gap(3, 13 * PAST_S, OWS_HISTORY_OVERRUN);
	expect(4, 15 * PAST_S, 3);
	expect_gap(5, 20 * PAST_S, OWS_HISTORY_STOPPED);
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_LAMP));
	expect_gap(1, 10 * PAST_S, OWS_HISTORY_OWSD_LOST);
}

static void test_a_value_that_holds_is_repeated_each_hour_and_one_of_a_gone_signal_is_not(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 21.5);
	past_title(&past, 8 * PAST_S, "held");
	for (int64_t second = 0; second < 5 * 3600; second += 10) {
		if (second == 2 * 3600)
			history_writer_forget(past.writer, PAST_TITLE, second * PAST_S,
			                      OWS_HISTORY_NOT_ASKED);
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, second * PAST_S));
	}
	past_end(&past, 5 * 3600 * PAST_S);
	TEST_ASSERT_EQUAL_INT(6, count_of(PAST_ROOM));
	for (int i = 1; i < 5; i++)
		TEST_ASSERT_INT64_WITHIN(62 * PAST_S, 3600 * PAST_S,
		                         items[i].boot_ns - items[i - 1].boot_ns);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_TITLE));
	TEST_ASSERT_EQUAL_INT64(
		3, past_ask(&past, "select count(*) from hour where id >> 3 & 65535 = 2"));
}

/*
 * --- Commits -----------------------------------------------------------------------------------
 */

static void test_values_are_committed_in_ten_minutes_and_the_begin_of_a_run_at_once(void)
{
	past.options.flush_ns = 0;
	past_begin(&past, 0, PAST_NOON, true);
	new_commits();
	seconds(1, 10, 1);
	TEST_ASSERT_EQUAL_INT(0, new_commits());
	seconds(10, 12, 1);
	TEST_ASSERT_EQUAL_INT(1, new_commits());
	seconds(12, 610, 1);
	TEST_ASSERT_EQUAL_INT(0, new_commits());
	seconds(610, 611, 1);
	TEST_ASSERT_EQUAL_INT(1, new_commits());
}

static void test_an_alarm_and_a_gap_are_committed_at_once_and_many_of_them_each_ten_seconds(void)
{
	past.options.flush_ns = 0;
	past_begin(&past, 0, PAST_NOON, true);
	seconds(1, 100, 1);
	new_commits();
	alarm_at(100);
	seconds(100, 102, 1);
	TEST_ASSERT_EQUAL_INT(1, new_commits());
	TEST_ASSERT_EQUAL(1, past_ask(&past, "select count(*) from event where kind = 8"));
	TEST_ASSERT_TRUE(past_ask(&past, "select count(*) from raw") >= 99);
	history_writer_gap(past.writer, 120 * PAST_S, 121 * PAST_S, OWS_HISTORY_OVERRUN);
	seconds(121, 123, 1);
	TEST_ASSERT_EQUAL_INT(1, new_commits());
	for (int s = 200; s < 260; s++) {
		alarm_at(s);
		seconds(s, s + 1, 1);
	}
	TEST_ASSERT_EQUAL_INT(6, new_commits());
}

static void test_from_a_minute_on_64_kb_of_values_are_worth_a_commit(void)
{
	past.options.flush_ns = 0;
	past_begin(&past, 0, PAST_NOON, true);
	seconds(1, 12, 30);
	new_commits();
	seconds(12, 70, 30);
	TEST_ASSERT_EQUAL_INT(0, new_commits());
	seconds(70, 100, 30);
	TEST_ASSERT_EQUAL_INT(1, new_commits());
}

static off_t size_of_log(void)
{
	struct stat seen;

	TEST_ASSERT_EQUAL_INT(0, stat(file("-wal"), &seen));
	return seen.st_size;
}

static void test_the_log_of_commits_has_its_size_from_the_begin(void)
{
	off_t size;

	past_begin(&past, 0, PAST_NOON, true);
	seconds(1, 20, 1);
	size = size_of_log();
	TEST_ASSERT_EQUAL_INT(4 << 20, size);
	seconds(20, 4000, 20);
	TEST_ASSERT_EQUAL_INT(size, size_of_log());
	TEST_ASSERT_EQUAL(0, past_ask(&past, "select count(*) from pragma_integrity_check"
	                                     " where integrity_check <> 'ok'"));
}

/*
 * --- What is old -------------------------------------------------------------------------------
 */

static void days(int from, int until)
{
	for (int64_t minute = from * 1440; minute < until * 1440; minute += 2) {
		past_room(&past, minute * 60 * PAST_S, (double)(minute % 97));
		TEST_ASSERT_TRUE(history_writer_tick(past.writer, minute * 60 * PAST_S) == 0);
	}
}

static void test_values_are_kept_for_days_minutes_for_more_and_hours_for_ever(void)
{
	past.options.flush_ns = 1800 * PAST_S;
	past.options.keep.days = 2;
	past.options.keep.minutes = 4;
	past_begin(&past, 0, PAST_NOON, true);
	days(0, 9);
	past_end(&past, 9 * PAST_DAY);
	TEST_ASSERT_INT64_WITHIN(INT64_C(7200000000), INT64_C(2) * 86400000000,
	                         past_ask(&past, "select max(id) - min(id) from raw"));
	TEST_ASSERT_INT64_WITHIN(
		60, 4 * 1440,
		past_ask(&past, "select (max(id) >> 16) - (min(id) >> 16) from minute"));
	TEST_ASSERT_INT64_WITHIN(2, 9 * 24, past_ask(&past, "select count(*) from hour"));
	/* hours are in blocks of eight, and the view has each of them once, in its place */
	TEST_ASSERT_EQUAL(0,
	                  past_ask(&past, "select count(*) from hour where id >> 3 & 65535 <> 1"));
	TEST_ASSERT_EQUAL(past_ask(&past, "select count(*) from hour"),
	                  past_ask(&past,
	                           "select count(distinct time) from trend_hour where name ="
	                           " (select name from signal) and time like '%:00:00.000Z'"));
	TEST_ASSERT_INT64_WITHIN(7200, 9 * 86400,
	                         past_ask(&past,
	                                  "select unixepoch(max(time)) - unixepoch(min(time))"
	                                  " from trend_hour"));
	/* whole seconds and values take two bytes each on the disk, and divide as numbers do */
	TEST_ASSERT_EQUAL(12, past_ask(&past, "select count(*) from (select * from"
	                                      " pragma_table_info('minute') union all select * from"
	                                      " pragma_table_info('hour')) where type = 'REAL'"));
	TEST_ASSERT_EQUAL(0, past_ask(&past, "select count(*) from trend_minute where"
	                                     " typeof(good) <> 'real' or typeof(least) <> 'real'"));
}

static void test_the_journal_is_kept_as_long_as_minutes(void)
{
	struct history_event event = {.kind = OWS_HISTORY_COMMAND};

	past.options.flush_ns = 1800 * PAST_S;
	past.options.keep.days = 1;
	past.options.keep.minutes = 3;
	past_begin(&past, 0, PAST_NOON, true);
	for (int day = 0; day < 6; day++) {
		event.time_ns = day * PAST_DAY + PAST_DAY / 2;
		history_writer_event(past.writer, &event);
		days(day, day + 1);
	}
	past_end(&past, 6 * PAST_DAY);
	/* those of the days 3, 4 and 5; the values of day 4 are gone */
	TEST_ASSERT_EQUAL_INT64(3, past_ask(&past, "select count(*) from event where kind = 7"));
}

/* A signal that is known no more each day, and one whose values are older than the last gap. */
static void test_a_gap_is_kept_as_long_as_the_journal_and_all_values_before_it(void)
{
	past.options.flush_ns = 1800 * PAST_S;
	past.options.keep.days = 1;
	past.options.keep.minutes = 3;
	past_begin(&past, 0, PAST_NOON, true);
	for (int day = 0; day < 9; day++) {
		int64_t until = (day + 1) * PAST_DAY;

		past_lamp(&past, until - PAST_DAY / 2, day & 1);
		days(day, day + 1);
		history_writer_forget(past.writer, PAST_LAMP, until, OWS_HISTORY_OVERRUN);
	}
	past_end(&past, 9 * PAST_DAY);
	TEST_ASSERT_EQUAL_INT64(4, past_ask(&past, "select count(*) from gap where signal <> 0"));
	/* values for ever: each of their gaps too */
	past.options.keep.days = 0;
	past_begin(&past, 9 * PAST_DAY, PAST_NOON, true);
	days(9, 12);
	past_end(&past, 12 * PAST_DAY);
	TEST_ASSERT_EQUAL_INT64(0, past_ask(&past, "select count(*) from gap where start <"
	                                           " (select min(id) from raw)"));
	TEST_ASSERT_GREATER_THAN_INT64(0, past_ask(&past, "select count(*) from gap"));
}

/* A run each day. */
static void test_a_run_is_kept_as_long_as_the_oldest_row_that_it_explains(void)
{
	past.options.flush_ns = 1800 * PAST_S;
	past.options.keep = (struct history_keep){.days = 1, .minutes = 2, .hours = 3};
	for (int day = 0; day < 13; day++) {
		/* from the tenth day on hours are kept for ever */
		if (day == 10)
			past.options.keep.hours = 0;
		past_begin(&past, day * PAST_DAY, PAST_NOON, true);
		days(day, day + 1);
		past_end(&past, (day + 1) * PAST_DAY);
		if (day == 9)
			TEST_ASSERT_EQUAL_INT64(4, past_ask(&past, "select count(*) from session"));
	}
	TEST_ASSERT_EQUAL_INT64(7, past_ask(&past, "select count(*) from session"));
	/* each hour has the date of its run */
	TEST_ASSERT_GREATER_THAN_INT64(5 * 24, past_ask(&past, "select count(*) from hour"));
	TEST_ASSERT_EQUAL_INT64(past_ask(&past, "select count(*) from hour"),
	                        past_ask(&past, "select count(*) from trend_hour"));
}

static void test_a_value_that_was_measured_before_the_last_one_comes_after_it(void)
{
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, 10 * PAST_S, 1);
	past_room(&past, 5 * PAST_S, 2);
	past_end(&past, 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_ROOM));
	expect(0, 10 * PAST_S, 1);
	expect(1, 10 * PAST_S, 2);
}

/* What a bus measured a moment ago arrives after the minute in which what held was repeated. */
static void test_what_was_measured_before_a_repeated_value_is_not_undone_by_it(void)
{
	const int64_t repeated = 3660 * PAST_S, measured = repeated - 3 * PAST_S / 10;

	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, 7 * PAST_S, 1);
	past_lamp(&past, 7 * PAST_S, 1);
	seconds(8, 3661, 0);
	past_room(&past, measured, 2);
	history_writer_forget(past.writer, PAST_LAMP, measured, OWS_HISTORY_OVERRUN);
	past_end(&past, repeated + 20 * PAST_S);
	TEST_ASSERT_EQUAL_INT(4, count_of(PAST_ROOM));
	expect(1, repeated, 1);
	expect(2, repeated, 2);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_LAMP));
	expect(1, repeated, 1);
	expect_gap(2, repeated, OWS_HISTORY_OVERRUN);
}

/* As each reload does with the signals that are not recorded. */
static void test_what_is_not_known_is_said_once(void)
{
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, 5 * PAST_S, 1);
	for (int s = 10; s < 20; s++)
		for (int signal = PAST_ROOM; signal <= PAST_LAMP; signal++)
			history_writer_forget(past.writer, (uint32_t)signal, s * PAST_S,
			                      OWS_HISTORY_NOT_ASKED);
	past_room(&past, 30 * PAST_S, 2);
	history_writer_forget(past.writer, PAST_ROOM, 40 * PAST_S, OWS_HISTORY_NOT_ASKED);
	past_end(&past, 50 * PAST_S);
	TEST_ASSERT_EQUAL_INT(4, count_of(PAST_ROOM));
	expect_gap(1, 10 * PAST_S, OWS_HISTORY_NOT_ASKED);
	expect(2, 30 * PAST_S, 2);
	expect_gap(3, 40 * PAST_S, OWS_HISTORY_NOT_ASKED);
	TEST_ASSERT_EQUAL_INT64(3, past_ask(&past, "select count(*) from gap where signal > 0"));
}

/* A reload of the largest table, and one of another. */
static void test_a_large_table_is_the_same_after_a_reload(void)
{
	static struct {
		struct history_signal signal[HISTORY_SIGNALS];
		char name[HISTORY_SIGNALS][8];
	} table;
	uint32_t count = HISTORY_SIGNALS - PAST_COUNT;

	for (uint32_t i = 0; i < HISTORY_SIGNALS; i++) {
		snprintf(table.name[i], sizeof(table.name[i]), "s%u", (unsigned)i);
		table.signal[i] = (struct history_signal){
			.name = table.name[i], .unit = "", .type = OWS_DOUBLE};
	}
	past_begin(&past, 0, PAST_NOON, true);
	for (int turn = 0; turn < 2; turn++)
		TEST_ASSERT_EQUAL_INT(
			0, history_writer_signals(past.writer, table.signal, count, PAST_S));
	TEST_ASSERT_EQUAL_INT(-E2BIG,
	                      history_writer_signals(past.writer, table.signal, count + 1, PAST_S));
}

static void test_a_file_that_is_too_large_loses_its_oldest_values(void)
{
	past.options.flush_ns = 1800 * PAST_S;
	past.options.keep.bytes = 400000;
	past_begin(&past, 0, PAST_NOON, true);
	days(0, 40);
	past_end(&past, 40 * PAST_DAY);
	TEST_ASSERT_TRUE(past_ask(&past, "select min(id) from raw") >
	                 (PAST_NOON + 10 * PAST_DAY) / 1000);
	TEST_ASSERT_TRUE(past_ask(&past, "select page_count * page_size from pragma_page_count(),"
	                                 " pragma_page_size()") < 800000);
}

/*
 * --- A disk that fails -------------------------------------------------------------------------
 */

static struct history_state state(void)
{
	struct history_state now;

	history_writer_state(past.writer, &now);
	return now;
}

static void test_without_a_directory_it_goes_on_in_memory_and_catches_up(void)
{
	char above[300];

	snprintf(above, sizeof(above), "%s", past.directory);
	snprintf(past.directory + strlen(past.directory), 8, "/deep");
	past_begin(&past, 0, PAST_NOON, true);
	for (int second = 1; second < 300; second++) {
		past_room(&past, second * PAST_S, second);
		history_writer_tick(past.writer, second * PAST_S);
	}
	TEST_ASSERT_EQUAL_INT(-ENOENT, state().error);
	TEST_ASSERT_EQUAL_INT(0, mkdir(above, 0700));
	past_end(&past, 300 * PAST_S);
	TEST_ASSERT_EQUAL_INT(300, count_of(PAST_ROOM));
	for (int i = 0; i < 299; i++)
		expect(i, (i + 1) * PAST_S, i + 1);
}

static void test_a_memory_that_is_full_becomes_a_gap_after_which_all_is_known(void)
{
	char above[300];
	int gap = 0, count;

	past.options.memory_bytes = 8000;
	snprintf(above, sizeof(above), "%s", past.directory);
	snprintf(past.directory + strlen(past.directory), 8, "/deep");
	past_begin(&past, 0, PAST_NOON, true);
	past_lamp(&past, PAST_S, 1);
	past_title(&past, PAST_S, "held");
	for (int second = 1; second < 3000; second++)
		past_room(&past, second * PAST_S, second);
	TEST_ASSERT_TRUE(state().waiting <= 16000);
	TEST_ASSERT_TRUE(state().dropped > 2500);
	TEST_ASSERT_EQUAL_INT(0, mkdir(above, 0700));
	past_end(&past, 3000 * PAST_S);
	count = count_of(PAST_ROOM);
	for (int i = 0; i + 1 < count; i++) {
		if (!items[i].known)
			gap++;
		else /* nothing that was recorded looks as if it had been otherwise */
			TEST_ASSERT_TRUE(items[i].boot_ns / PAST_S - (int64_t)items[i].number <= 1);
	}
	TEST_ASSERT_EQUAL_DOUBLE(2999, items[count - 2].number);
	TEST_ASSERT_EQUAL_INT(0, gap); /* it is before the first value that is left */
	TEST_ASSERT_EQUAL_INT64(1,
	                        past_ask(&past, "select count(*) > 0 from gap where reason = 5"));
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_LAMP));
	TEST_ASSERT_TRUE(items[0].boot_ns > 2000 * PAST_S && items[0].known);
	count_of(PAST_TITLE);
	TEST_ASSERT_TRUE(items[0].known && items[0].boot_ns > 2000 * PAST_S);
}

static void test_a_disk_that_takes_no_more_gets_all_once_it_does(void)
{
	struct rlimit before, none;

	signal(SIGXFSZ, SIG_IGN);
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 0);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 2 * PAST_S));
	getrlimit(RLIMIT_FSIZE, &before);
	none = before;
	none.rlim_cur = 1;
	setrlimit(RLIMIT_FSIZE, &none);
	for (int second = 2; second < 400; second++) {
		past_room(&past, second * PAST_S, second);
		history_writer_tick(past.writer, second * PAST_S);
	}
	TEST_ASSERT_TRUE(state().error < 0);
	setrlimit(RLIMIT_FSIZE, &before);
	past_end(&past, 4000 * PAST_S);
	TEST_ASSERT_EQUAL_INT(400, count_of(PAST_ROOM));
	for (int i = 1; i < 399; i++)
		expect(i, (i + 1) * PAST_S, i + 1);
	TEST_ASSERT_TRUE(past_ask(&past, "select count(*) from trend_minute") >= 6);
}

/* As a history that root's recorder has made, for the recorder of the service. */
static void test_a_file_of_another_owner_stays_his_and_gets_all_once_it_is_ours(void)
{
	char above[400];
	struct stat st;

	if (geteuid() != 0)
		TEST_IGNORE_MESSAGE("needs root");
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	past_end(&past, 2 * PAST_S);
	for (char *at = past.directory; (at = strchr(at + 1, '/')) != NULL;) {
		snprintf(above, sizeof(above), "%.*s", (int)(at - past.directory), past.directory);
		chmod(above, 0755);
	}
	TEST_ASSERT_EQUAL_INT(0, chown(past.directory, 65534, (gid_t)-1));
	TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	past_begin(&past, 3 * PAST_S, PAST_NOON, true);
	for (int second = 4; second < 200; second++) {
		past_room(&past, second * PAST_S, second);
		history_writer_tick(past.writer, second * PAST_S);
	}
	TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(-EACCES, state().error);
	TEST_ASSERT_EQUAL_STRING("", past.said);
	TEST_ASSERT_EQUAL_INT(0, stat(file(""), &st));
	TEST_ASSERT_EQUAL_INT(0, st.st_uid);
	TEST_ASSERT_EQUAL_INT(0, chown(file(""), 65534, (gid_t)-1));
	TEST_ASSERT_EQUAL_INT(0, chown(file("-wal"), 65534, (gid_t)-1));
	TEST_ASSERT_EQUAL_INT(0, chown(file("-shm"), 65534, (gid_t)-1));
	snprintf(above, sizeof(above), "%s/lock", past.directory);
	TEST_ASSERT_EQUAL_INT(0, chown(above, 65534, (gid_t)-1));
	TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	past_end(&past, 200 * PAST_S);
	TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	/* the first value, the end of it, those that waited, and the end */
	TEST_ASSERT_EQUAL_INT(1 + 1 + 196 + 1, count_of(PAST_ROOM));
	expect(2, 4 * PAST_S, 4);
	expect(197, 199 * PAST_S, 199);
}

static void test_a_file_that_another_program_has_locked_gets_all_later(void)
{
	sqlite3 *db;

	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 2 * PAST_S));
	sqlite3_open(file(""), &db);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_exec(db, "begin immediate", NULL, NULL, NULL));
	past_room(&past, 3 * PAST_S, 2);
	TEST_ASSERT_EQUAL_INT(-EAGAIN, history_writer_flush(past.writer, 4 * PAST_S));
	sqlite3_exec(db, "rollback", NULL, NULL, NULL);
	sqlite3_close(db);
	past_end(&past, 10 * PAST_S);
	TEST_ASSERT_EQUAL_INT(3, count_of(PAST_ROOM));
	expect(1, 3 * PAST_S, 2);
}

static void test_a_reader_that_takes_minutes_holds_nothing_up(void)
{
	struct ows_history_item *none;
	sqlite3_stmt *statement;
	sqlite3 *db;

	past_begin(&past, 0, PAST_NOON, true);
	for (int second = 1; second < 60; second++)
		past_room(&past, second * PAST_S, second);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 60 * PAST_S));
	sqlite3_open_v2(file(""), &db, SQLITE_OPEN_READONLY, NULL);
	sqlite3_prepare_v2(db, "select id from raw", -1, &statement, NULL);
	TEST_ASSERT_EQUAL_INT(SQLITE_ROW, sqlite3_step(statement));
	for (int second = 60; second < 6000; second++) {
		past_room(&past, second * PAST_S, second);
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, second * PAST_S));
	}
	sqlite3_finalize(statement);
	sqlite3_close(db);
	past_end(&past, 6000 * PAST_S);
	TEST_ASSERT_EQUAL_INT(6000, past_items(&past, PAST_ROOM, &none));
}

static void test_a_second_writer_of_a_directory_is_refused(void)
{
	struct past other = past;

	past_begin(&past, 0, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 0));
	other.options.directory = past.directory;
	past_begin(&other, 0, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(-EBUSY, history_writer_flush(other.writer, 0));
	history_writer_close(other.writer, PAST_S);
}

/*
 * Another process has locked all that a member of the group may open. Locks of one process do not
 * meet: it is a child.
 */
static pid_t lock_all(void)
{
	static const char *const names[] = {"", "lock", "history.sqlite", "history.sqlite-shm",
	                                    "history.sqlite-wal"};
	int ready[2];
	pid_t child;
	char byte;

	TEST_ASSERT_EQUAL_INT(0, pipe(ready));
	child = fork();
	if (child == 0) {
		/* not ours: the lock of the writer is one of them */
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		dup2(ready[1], STDIN_FILENO);
		close_range(3, ~0u, 0);
	}
	for (size_t i = 0; child == 0 && i < sizeof(names) / sizeof(names[0]); i++) {
		struct flock all = {.l_type = F_RDLCK, .l_whence = SEEK_SET};
		char name[400];
		struct stat seen;
		int fd;

		snprintf(name, sizeof(name), "%s/%s", past.directory, names[i]);
		if (stat(name, &seen) < 0 || !(seen.st_mode & 040))
			continue;
		fd = open(name, O_RDONLY);
		flock(fd, LOCK_EX | LOCK_NB);
		fcntl(fd, F_SETLK, &all);
	}
	if (child == 0) {
		(void)!write(STDIN_FILENO, "", 1);
		pause();
		_exit(0);
	}
	TEST_ASSERT_EQUAL_INT64(1, read(ready[0], &byte, 1));
	close(ready[0]);
	close(ready[1]);
	return child;
}

static void test_no_lock_that_a_reader_can_have_stops_the_writer(void)
{
	pid_t locks[2];

	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 2 * PAST_S));
	locks[0] = lock_all();
	for (int second = 3; second < 300; second++) {
		past_room(&past, second * PAST_S, second);
		TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, second * PAST_S));
	}
	/* nor its start, nor one after the machine has crashed */
	for (int crashed = 0; crashed < 2; crashed++) {
		history_writer_close(past.writer, (400 + 10 * crashed) * PAST_S);
		if (crashed) {
			int fd = open(file("-shm"), O_WRONLY);

			TEST_ASSERT_EQUAL_INT64(8,
			                        pwrite(fd, "\377\377\377\377\377\377\377", 8, 0));
			close(fd);
		}
		past_begin(&past, (401 + 10 * crashed) * PAST_S, PAST_NOON, true);
		past_room(&past, (402 + 10 * crashed) * PAST_S, 7);
		TEST_ASSERT_EQUAL_INT(
			0, history_writer_flush(past.writer, (403 + 10 * crashed) * PAST_S));
	}
	locks[1] = lock_all();
	past_room(&past, 420 * PAST_S, 8);
	past_end(&past, 430 * PAST_S);
	for (int i = 0; i < 2; i++) {
		kill(locks[i], SIGKILL);
		waitpid(locks[i], NULL, 0);
	}
	/* each end of a run is an item too */
	TEST_ASSERT_EQUAL_INT(298 + 3 + 3, count_of(PAST_ROOM));
}

static uint32_t files(void)
{
	struct history_state state;

	history_writer_state(past.writer, &state);
	return state.files;
}

static void test_a_file_that_is_deleted_is_begun_again_with_all_that_holds(void)
{
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	past_lamp(&past, PAST_S, 1);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 2 * PAST_S));
	TEST_ASSERT_EQUAL_UINT32(1, files());
	TEST_ASSERT_EQUAL_INT(0, unlink(file("")));
	past_room(&past, 3 * PAST_S, 2);
	TEST_ASSERT_EQUAL_INT(-ENOENT, history_writer_flush(past.writer, 4 * PAST_S));
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 5 * PAST_S));
	TEST_ASSERT_EQUAL_UINT32(2, files());
	past_end(&past, 10 * PAST_S);
	TEST_ASSERT_TRUE(count_of(PAST_ROOM) >= 2);
	expect(0, 3 * PAST_S, 2);
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_LAMP));
	expect(0, 5 * PAST_S, 1);
}

static void test_where_nothing_waits_the_new_file_has_all_that_holds_too(void)
{
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 2 * PAST_S));
	TEST_ASSERT_EQUAL_INT(0, unlink(file("")));
	TEST_ASSERT_EQUAL_INT(-ENOENT, history_writer_flush(past.writer, 4 * PAST_S));
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 5 * PAST_S));
	TEST_ASSERT_EQUAL_UINT32(2, files());
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 6 * PAST_S));
	TEST_ASSERT_EQUAL_UINT32(2, files());
	past_end(&past, 10 * PAST_S);
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_ROOM));
	expect(0, 5 * PAST_S, 1);
}

/*
 * --- Files that are there ----------------------------------------------------------------------
 */

static void put_file(const char *text, size_t size)
{
	FILE *to;

	mkdir(past.directory, 0700);
	to = fopen(file(""), "w");
	TEST_ASSERT_NOT_NULL(to);
	fwrite(text, 1, size, to);
	fclose(to);
}

static void sql(const char *text)
{
	sqlite3 *db;

	mkdir(past.directory, 0700);
	sqlite3_open(file(""), &db);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_exec(db, text, NULL, NULL, NULL));
	sqlite3_close(db);
}

static void record_one(void)
{
	past_begin(&past, 0, PAST_NOON, true);
	past_room(&past, PAST_S, 1);
	past_end(&past, 2 * PAST_S);
}

static void test_a_damaged_file_is_put_aside_by_name_and_another_is_begun(void)
{
	static char bytes[20000];
	char aside[400];

	for (int round = 1; round <= 2; round++) {
		for (size_t i = 0; i < sizeof(bytes); i++)
			bytes[i] = (char)past_random(256);
		put_file(bytes, sizeof(bytes));
		record_one();
		snprintf(aside, sizeof(aside), "history-damaged-%d.sqlite", round);
		TEST_ASSERT_NOT_NULL(strstr(past.said, aside));
		snprintf(aside, sizeof(aside), "%s/history-damaged-%d.sqlite", past.directory,
		         round);
		TEST_ASSERT_EQUAL_INT(0, access(aside, F_OK));
		TEST_ASSERT_EQUAL_INT(2, count_of(PAST_ROOM));
	}
}

/* Its head is whole, and what follows it is not. */
static void test_a_file_with_damaged_pages_is_put_aside_when_it_is_met(void)
{
	FILE *to;

	past_begin(&past, 0, PAST_NOON, true);
	for (int second = 1; second < 1000; second++)
		past_room(&past, second * PAST_S, second);
	past_end(&past, 1000 * PAST_S);
	past_ask(&past, "select count(*) from raw");
	sql("pragma wal_checkpoint(truncate)");
	to = fopen(file(""), "r+");
	fseek(to, 4096, SEEK_SET);
	for (int i = 0; i < 100000; i++)
		fputc((int)past_random(256), to);
	fclose(to);
	past_begin(&past, 2000 * PAST_S, PAST_NOON, true);
	past_room(&past, 2001 * PAST_S, 5);
	history_writer_flush(past.writer, 2002 * PAST_S);
	past_end(&past, 2010 * PAST_S);
	TEST_ASSERT_NOT_NULL(strstr(past.said, "is damaged"));
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_ROOM));
	expect(0, 2001 * PAST_S, 5);
}

static void test_a_newer_file_and_one_of_another_program_are_left_alone(void)
{
	struct ows_history *h;
	struct stat before, after;

	record_one();
	sql("pragma user_version = 99");
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(-EPROTONOSUPPORT, history_writer_flush(past.writer, 6 * PAST_S));
	TEST_ASSERT_EQUAL_INT(-EPROTONOSUPPORT, ows_history_open(NULL, past.directory, &h));
	history_writer_close(past.writer, 7 * PAST_S);
	past_make(&past);
	sql("create table theirs (x); pragma user_version = 1");
	TEST_ASSERT_EQUAL_INT(0, stat(file(""), &before));
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(-EEXIST, history_writer_flush(past.writer, 6 * PAST_S));
	TEST_ASSERT_EQUAL_INT(-EBADMSG, ows_history_open(NULL, past.directory, &h));
	TEST_ASSERT_EQUAL_INT(0, stat(file(""), &after));
	TEST_ASSERT_EQUAL_INT64(before.st_mtim.tv_nsec, after.st_mtim.tv_nsec);
}

/* An empty file is the oldest version. */
static void test_an_older_file_is_brought_up_to_date(void)
{
	put_file("", 0);
	record_one();
	TEST_ASSERT_EQUAL_INT(2, count_of(PAST_ROOM));
	TEST_ASSERT_EQUAL_INT64(HISTORY_SCHEMA, past_ask(&past, "pragma user_version"));
	TEST_ASSERT_EQUAL_STRING("", past.said);
}

/* Each minute has a row of its own. */
#define OWN_MINUTES \
	"create table former as select * from trend_minute; drop view trend_minute;" \
	"delete from minute; alter table minute drop column minutes;" \
	"insert into minute select unixepoch(time) / 60 << 16 | signal, least, most, mean, last, good," \
	" known, count, 192, 192 from former join signal using (name); drop table former;" \
	"create view trend_minute as select * from minute;"
#define WITHOUT_IDENTITY \
	OWN_MINUTES \
	"drop index signal_identity; alter table signal drop column identity;" \
	"alter table signal drop column former;"

/* Version 1 numbered the hours as it did the minutes. */
static void test_hours_of_the_first_version_are_numbered_anew(void)
{
	enum { HOUR = 21, SIGNAL = 5 };

	record_one();
	sql("drop view trend_hour; drop table hour; create table hour (id integer primary key, least,"
	    " most, mean, last, good, known, count, quality, worst);"
	    "create view trend_hour as select * from hour;"
	    "insert into hour values (21 << 16 | 5, 1, 3, 2.5, 3, 3600, 3600, 7, 192, 192);"
	    "insert into hour values (22 << 16 | 5, 4, 4, 4, 4, 3600, 3600, 1, 192, 192);" WITHOUT_IDENTITY
	    "pragma user_version = 1");
	past_begin(&past, 9 * PAST_S, PAST_NOON, true);
	past_room(&past, 10 * PAST_S, 5);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 11 * PAST_S));
	TEST_ASSERT_EQUAL_INT64(HISTORY_SCHEMA, past_ask(&past, "pragma user_version"));
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(*) from hour"));
	TEST_ASSERT_EQUAL_INT64(schema_hour(HOUR, SIGNAL),
	                        past_ask(&past, "select id from hour where count = 7"));
	TEST_ASSERT_EQUAL_INT64(schema_hour(HOUR + 1, SIGNAL),
	                        past_ask(&past, "select id from hour where least = 4"));
	TEST_ASSERT_EQUAL_INT64(0, past_ask(&past, "select count(*) from sqlite_master"
	                                           " where name = 'hours'"));
	TEST_ASSERT_EQUAL_STRING("", past.said);
}

/* The second run begins microseconds after its minute. */
static void check_hours_of_minutes(struct ows_history *h, int hours)
{
	static struct ows_history_point points[600];
	int n = hours * 30;

	TEST_ASSERT_EQUAL_INT(n, ows_history_points(h, PAST_ROOM, PAST_NOON,
	                                            PAST_NOON + hours * 3600 * PAST_S, points, n));
	for (int i = 0; i < n; i++) {
		TEST_ASSERT_EQUAL_DOUBLE(2 * i - (2 * i > 210), points[i].min);
		TEST_ASSERT_EQUAL_DOUBLE(2 * i + 1, points[i].max);
		TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2 * i + 0.5, points[i].mean);
		TEST_ASSERT_INT64_WITHIN(2000, 120 * PAST_S, points[i].good_ns);
		TEST_ASSERT_EQUAL_INT(2, points[i].count);
	}
}

/*
 * In version 4 each minute had a row, and keeps it. What the recorder adds to the hour under way
 * goes into the row of that hour, with what is of before. A reader has the file open meanwhile.
 */
static void test_minutes_of_the_fourth_version_stay_and_are_read_with_those_that_follow(void)
{
	int64_t ends = 210 * 60 * PAST_S;
	struct ows_history *h;

	past_begin(&past, 0, PAST_NOON, true);
	for (int minute = 0; minute < 210; minute++)
		past_room(&past, minute * 60 * PAST_S, minute);
	past_end(&past, ends);
	sql(OWN_MINUTES "insert into minute select id + 65536, least, most, mean, last, good,"
	                " known, count, quality, worst from minute where id >> 16 = (select max(id)"
	                " >> 16 from minute); pragma user_version = 4");
	TEST_ASSERT_EQUAL_INT64(181, past_ask(&past, "select count(*) from minute"));
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past.directory, &h));
	check_hours_of_minutes(h, 3);
	past_begin(&past, ends, PAST_NOON, true);
	for (int minute = 210; minute < 600; minute++)
		past_room(&past, minute * 60 * PAST_S, minute);
	past_end(&past, 600 * 60 * PAST_S);
	TEST_ASSERT_EQUAL_INT64(HISTORY_SCHEMA, past_ask(&past, "pragma user_version"));
	TEST_ASSERT_EQUAL_INT64(600, past_ask(&past, "select count(*) from trend_minute"));
	TEST_ASSERT_EQUAL_INT64(600, past_ask(&past, "select count(distinct time) from trend_minute"
	                                             " where most = last and count = 1"));
	TEST_ASSERT_EQUAL_INT64(187, past_ask(&past, "select count(*) from minute"));
	/* what is left of raw would do as well */
	sql("delete from raw where id < (select max(id) from raw) - 600000000");
	TEST_ASSERT_EQUAL_INT(0, ows_history_refresh(h));
	check_hours_of_minutes(h, 10);
	ows_history_close(h);
}

/* Version 2 had no words for events. */
static void test_events_of_the_second_version_get_words_and_its_readers_need_none(void)
{
	struct ows_history *h;

	record_events();
	sql("drop view trend_alarm; drop view trend_event; drop table alarm_kind; drop table alarm_event;"
	    "drop table command_reason; create view trend_event as select * from event;" WITHOUT_IDENTITY
	    "pragma user_version = 2");
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past.directory, &h));
	ows_history_close(h);
	past_begin(&past, 30 * PAST_S, PAST_NOON, true);
	past_room(&past, 31 * PAST_S, 5);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 32 * PAST_S));
	TEST_ASSERT_EQUAL_INT64(HISTORY_SCHEMA, past_ask(&past, "pragma user_version"));
	check_events();
}

/* A table with the room alone, by another name. */
static void rename_room(const char *name, const char *identity, int64_t now_ns)
{
	const struct history_signal table[] = {
		{.name = name, .unit = "", .type = OWS_DOUBLE, .identity = identity}};

	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(past.writer, table, 1, now_ns));
}

static int found(const char *name)
{
	struct ows_history *h;
	int index;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past.directory, &h));
	index = ows_history_find(h, name);
	ows_history_close(h);
	return index;
}

/* In version 3 a signal was its name: it goes on, and over another name from then on. */
static void test_a_signal_of_the_third_version_gets_an_identity_by_its_name(void)
{
	record_one();
	sql(WITHOUT_IDENTITY "pragma user_version = 3");
	TEST_ASSERT_EQUAL_INT(0, found("room"));
	past_begin(&past, 9 * PAST_S, PAST_NOON, true);
	rename_room("room", "/28/t", 9 * PAST_S);
	past_room(&past, 10 * PAST_S, 5);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 11 * PAST_S));
	rename_room("hall", "/28/t", 12 * PAST_S);
	past_room(&past, 13 * PAST_S, 6);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 14 * PAST_S));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from signal where type = 8"));
	TEST_ASSERT_EQUAL_INT(found("hall"), found("room"));
	TEST_ASSERT_EQUAL_INT(found("hall"), found("/28/t"));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from trend where name = 'hall'"
	                                           " and value = 6"));
}

/* A reader has the file open meanwhile. */
static void test_a_reader_sees_the_identities_when_the_file_is_brought_up_to_date(void)
{
	struct ows_history_signal signal;
	struct ows_history *h;

	record_one();
	sql(WITHOUT_IDENTITY "pragma user_version = 3");
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past.directory, &h));
	TEST_ASSERT_EQUAL_INT(0, ows_history_signal(h, 0, &signal));
	TEST_ASSERT_EQUAL_STRING("", signal.identity);
	past_begin(&past, 9 * PAST_S, PAST_NOON, true);
	rename_room("room", "/28/t", 9 * PAST_S);
	past_room(&past, 10 * PAST_S, 5);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 11 * PAST_S));
	TEST_ASSERT_EQUAL_INT(0, ows_history_refresh(h));
	TEST_ASSERT_EQUAL_INT(0, ows_history_signal(h, 0, &signal));
	TEST_ASSERT_EQUAL_STRING("/28/t", signal.identity);
	ows_history_close(h);
}

static void test_a_name_that_another_signal_takes_is_of_that_one_from_then_on(void)
{
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	rename_room("room", "/28/a", 5 * PAST_S);
	past_room(&past, 6 * PAST_S, 1);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 7 * PAST_S));
	rename_room("room", "/28/b", 8 * PAST_S);
	past_room(&past, 9 * PAST_S, 2);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 10 * PAST_S));
	TEST_ASSERT_EQUAL_INT(found("/28/b"), found("room"));
	TEST_ASSERT_NOT_EQUAL(found("/28/b"), found("/28/a"));
	/* the first again, and the second is left */
	rename_room("room", "/28/a", 11 * PAST_S);
	past_room(&past, 12 * PAST_S, 3);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 13 * PAST_S));
	TEST_ASSERT_EQUAL_INT(found("/28/a"), found("room"));
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(*) from trend where name = 'room'"
	                                           " and value in (1, 3)"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, found("attic"));
}

/* What is written after it is of the time before it. */
static void test_a_name_stays_with_the_signal_that_took_it_before_the_other_was_written(void)
{
	static const struct history_signal both[] = {
		{.name = "hall", .unit = "", .type = OWS_DOUBLE, .identity = "/28/a"},
		{.name = "attic", .unit = "", .type = OWS_DOUBLE, .identity = "/28/b"}};

	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(past.writer, both, 2, 5 * PAST_S));
	history_writer_value(past.writer, 0, 6 * PAST_S, OWS_Q_GOOD, 0, NULL, 0);
	history_writer_value(past.writer, 1, 7 * PAST_S, OWS_Q_GOOD, 0, NULL, 0);
	rename_room("attic", "/28/a", 8 * PAST_S);
	past_room(&past, 9 * PAST_S, 2);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(past.writer, 10 * PAST_S));
	TEST_ASSERT_EQUAL_INT(found("/28/a"), found("attic"));
	TEST_ASSERT_NOT_EQUAL(found("/28/a"), found("/28/b"));
}

static void test_what_an_earlier_run_of_the_boot_has_of_the_journals_is_known(void)
{
	struct history_event alarm = {.kind = OWS_HISTORY_ALARM,
	                              .type = OWS_DOUBLE,
	                              .signal = PAST_ROOM,
	                              .time_ns = 7 * PAST_S};
	int64_t alarms, commands;

	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	history_writer_event(past.writer, &alarm);
	/* before the run: it keeps its time */
	alarm.kind = OWS_HISTORY_COMMAND;
	alarm.time_ns = 2 * PAST_S;
	history_writer_event(past.writer, &alarm);
	past_end(&past, 9 * PAST_S);
	for (int boot = 1; boot <= 2; boot++) {
		past.options.boot = boot;
		past_begin(&past, 20 * PAST_S, PAST_NOON, true);
		TEST_ASSERT_EQUAL_INT(0, history_writer_known(past.writer, &alarms, &commands));
		TEST_ASSERT_EQUAL_INT64(boot == 1 ? 7 * PAST_S : 0, alarms / 1000 * 1000);
		TEST_ASSERT_EQUAL_INT64(boot == 1 ? 2 * PAST_S : 0, commands / 1000 * 1000);
		past_end(&past, 30 * PAST_S);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_recorded_is_read_in_the_order_of_time);
	RUN_TEST(test_a_reader_of_sql_sees_names_units_times_and_words);
	RUN_TEST(test_a_reader_of_sql_sees_what_an_event_was);
	RUN_TEST(test_a_clock_that_is_late_or_set_moves_dates_and_changes_no_value);
	RUN_TEST(test_ids_never_go_back_whatever_the_clock_says);
	RUN_TEST(test_a_run_that_ended_without_a_word_ends_where_it_last_looked);
	RUN_TEST(test_a_gap_at_the_time_of_values_after_a_gap_is_another);
	RUN_TEST(test_gaps_are_read_as_gaps_and_values_after_them_are_new);
	RUN_TEST(test_a_value_that_holds_is_repeated_each_hour_and_one_of_a_gone_signal_is_not);
	RUN_TEST(test_values_are_committed_in_ten_minutes_and_the_begin_of_a_run_at_once);
	RUN_TEST(test_an_alarm_and_a_gap_are_committed_at_once_and_many_of_them_each_ten_seconds);
	RUN_TEST(test_from_a_minute_on_64_kb_of_values_are_worth_a_commit);
	RUN_TEST(test_the_log_of_commits_has_its_size_from_the_begin);
	RUN_TEST(test_values_are_kept_for_days_minutes_for_more_and_hours_for_ever);
	RUN_TEST(test_the_journal_is_kept_as_long_as_minutes);
	RUN_TEST(test_a_gap_is_kept_as_long_as_the_journal_and_all_values_before_it);
	RUN_TEST(test_a_run_is_kept_as_long_as_the_oldest_row_that_it_explains);
	RUN_TEST(test_a_value_that_was_measured_before_the_last_one_comes_after_it);
	RUN_TEST(test_what_was_measured_before_a_repeated_value_is_not_undone_by_it);
	RUN_TEST(test_what_is_not_known_is_said_once);
	RUN_TEST(test_a_large_table_is_the_same_after_a_reload);
	RUN_TEST(test_a_file_that_is_too_large_loses_its_oldest_values);
	RUN_TEST(test_without_a_directory_it_goes_on_in_memory_and_catches_up);
	RUN_TEST(test_a_memory_that_is_full_becomes_a_gap_after_which_all_is_known);
	RUN_TEST(test_a_disk_that_takes_no_more_gets_all_once_it_does);
	RUN_TEST(test_a_file_of_another_owner_stays_his_and_gets_all_once_it_is_ours);
	RUN_TEST(test_a_file_that_another_program_has_locked_gets_all_later);
	RUN_TEST(test_a_reader_that_takes_minutes_holds_nothing_up);
	RUN_TEST(test_a_second_writer_of_a_directory_is_refused);
	RUN_TEST(test_no_lock_that_a_reader_can_have_stops_the_writer);
	RUN_TEST(test_a_file_that_is_deleted_is_begun_again_with_all_that_holds);
	RUN_TEST(test_where_nothing_waits_the_new_file_has_all_that_holds_too);
	RUN_TEST(test_a_damaged_file_is_put_aside_by_name_and_another_is_begun);
	RUN_TEST(test_a_file_with_damaged_pages_is_put_aside_when_it_is_met);
	RUN_TEST(test_a_newer_file_and_one_of_another_program_are_left_alone);
	RUN_TEST(test_an_older_file_is_brought_up_to_date);
	RUN_TEST(test_hours_of_the_first_version_are_numbered_anew);
	RUN_TEST(test_minutes_of_the_fourth_version_stay_and_are_read_with_those_that_follow);
	RUN_TEST(test_events_of_the_second_version_get_words_and_its_readers_need_none);
	RUN_TEST(test_a_signal_of_the_third_version_gets_an_identity_by_its_name);
	RUN_TEST(test_a_reader_sees_the_identities_when_the_file_is_brought_up_to_date);
	RUN_TEST(test_a_name_that_another_signal_takes_is_of_that_one_from_then_on);
	RUN_TEST(test_a_name_stays_with_the_signal_that_took_it_before_the_other_was_written);
	RUN_TEST(test_what_an_earlier_run_of_the_boot_has_of_the_journals_is_known);
	return UNITY_END();
}
