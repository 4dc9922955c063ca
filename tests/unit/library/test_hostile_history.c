/* SPDX-License-Identifier: MIT */
/* Histories that no recorder has made: whatever is in them costs a reader no more than a moment. */
#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/history/library/replay.h"
#include "src/public/ows_history.h"
#include "tests/unit/aid/past.h"

#define YEAR_2115 (INT64_C(4600000000) * PAST_S)
/* What all calls take at most of the processor, and what a sanitizer adds */
#define LIMIT_S 60

static struct past past;

void setUp(void)
{
	struct history_event event = {.kind = OWS_HISTORY_ALARM, .time_ns = 7 * PAST_S};

	past_make(&past);
	past_begin(&past, 5 * PAST_S, PAST_NOON, true);
	for (int minute = 0; minute < 200; minute++) {
		past_room(&past, 5 * PAST_S + minute * 60 * PAST_S, minute);
		past_lamp(&past, 5 * PAST_S + minute * 60 * PAST_S, minute & 1);
	}
	past_title(&past, 12000 * PAST_S, "text");
	history_writer_event(past.writer, &event);
	history_writer_gap(past.writer, 12001 * PAST_S, 12002 * PAST_S, OWS_HISTORY_OVERRUN);
	past_end(&past, 12003 * PAST_S);
	past_begin(&past, 12010 * PAST_S, PAST_NOON, true);
	past_room(&past, 12011 * PAST_S, 1);
	past_end(&past, 12012 * PAST_S);
}

void tearDown(void)
{
}

static const char *file(const char *more)
{
	static char path[400];

	snprintf(path, sizeof(path), "%s/history.sqlite%s", past.directory, more);
	return path;
}

/* Into the file, whatever its schema says. */
static void sql(const char *text)
{
	sqlite3 *db;

	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_open(file(""), &db));
	sqlite3_exec(db, "pragma synchronous = off", NULL, NULL, NULL);
	TEST_ASSERT_EQUAL_INT_MESSAGE(SQLITE_OK, sqlite3_exec(db, text, NULL, NULL, NULL),
	                              sqlite3_errmsg(db));
	sqlite3_close(db);
}

/* The file as setUp() has made it, which takes long: each sync of it is one. */
static void put_back(bool first)
{
	static char whole[1 << 20];
	static size_t len;
	FILE *f;

	if (first)
		sql("pragma wal_checkpoint(truncate)");
	f = fopen(file(""), first ? "r" : "w");
	if (first)
		len = fread(whole, 1, sizeof(whole), f);
	else
		fwrite(whole, 1, len, f);
	fclose(f);
	unlink(file("-wal"));
	unlink(file("-shm"));
}

static void check_time(int64_t ns)
{
	TEST_ASSERT_TRUE(ns >= 0 && ns <= YEAR_2115);
}

static void read_items(struct ows_history *h, int signal)
{
	struct ows_history_item items[50];
	int got;

	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, signal, INT64_MIN, INT64_MAX));
	while ((got = ows_history_next(h, items, 50)) > 0)
		for (int i = 0; i < got; i++)
			check_time(items[i].time_ns);
}

static void read_points(struct ows_history *h, int signal)
{
	static const int64_t until[] = {PAST_NOON + PAST_DAY, YEAR_2115};
	struct ows_history_point points[100];

	for (int i = 0; i < 2; i++) {
		ows_history_points(h, signal, 0, until[i], points, 100);
		ows_history_points(h, signal, PAST_NOON, until[i], points, 100);
	}
}

static void read_events(struct ows_history *h)
{
	struct ows_history_event event;

	ows_history_events(h, INT64_MIN, INT64_MAX, 0);
	while (ows_history_next_event(h, &event) == 1) {
		check_time(event.time_ns);
		check_time(event.until_ns);
	}
}

static void read_replay(struct ows_history *h)
{
	struct replay_row rows[100];
	int got = replay_rows(h, 0, INT64_MAX, rows, 100);

	for (int i = 0; i < got; i++) {
		check_time(rows[i].wall_us * 1000);
		free(rows[i].text);
	}
	replay_place(h, &(struct replay_point){.boot = 1, .us = INT64_MAX, .wall_us = INT64_MAX});
	replay_place(h, &(struct replay_point){.boot = 7, .us = INT64_MIN, .wall_us = INT64_MIN});
}

/* All that can be read of it, within the limit. */
static int read_all(void)
{
	clock_t begin = clock();
	struct ows_history *h;
	int64_t from, until;
	int err = ows_history_open(NULL, past.directory, &h);

	if (!err) {
		for (int i = 0; i < ows_history_signals(h); i++) {
			read_items(h, i);
			read_points(h, i);
		}
		read_events(h);
		read_replay(h);
		if (!ows_history_span(h, &from, &until)) {
			check_time(from);
			check_time(until);
		}
		TEST_ASSERT_NOT_EQUAL(-ETIMEDOUT, ows_history_refresh(h));
		ows_history_close(h);
	}
	TEST_ASSERT_LESS_THAN_INT64(LIMIT_S, (clock() - begin) / CLOCKS_PER_SEC);
	return err;
}

static void test_numbers_at_the_ends_of_their_range_are_times_that_can_be_reckoned_with(void)
{
	static const char *const columns[] = {
		"session set start",  "session set boot",    "session set base",
		"session set date",   "session set seen",    "session set trusted",
		"raw set id",         "raw set signal",      "raw set value",
		"raw set quality",    "gap set start",       "gap set until",
		"gap set reason",     "event set id",        "event set time",
		"event set kind",     "event set signal",    "event set type",
		"minute set id",      "minute set good",     "minute set known",
		"minute set count",   "hour set id",         "hour set good",
		"hour set known",     "hour set mean",       "signal set signal",
		"signal set type",    "signal set decimals", "signal set output",
		"minute set quality", "hour set quality",
	};
	static const char *const numbers[] = {"-9223372036854775807 - 1",
	                                      "9223372036854775807",
	                                      "4611686018427387904",
	                                      "-1",
	                                      "0",
	                                      "9200000000000000",
	                                      "1e308",
	                                      "'text'",
	                                      "x'00ff'"};
	char text[200];

	for (size_t i = 0; i < sizeof(columns) / sizeof(columns[0]); i++)
		for (size_t k = 0; k < sizeof(numbers) / sizeof(numbers[0]); k++) {
			put_back(i + k == 0);
			for (int most = 0; most < 2; most++) {
				/* one row of them, the newest or the oldest */
				const char *table = columns[i];
				int name = (int)strcspn(table, " ");
				const char *key = strncmp(table, "session", 7) == 0  ? "start"
				                  : strncmp(table, "gap", 3) == 0    ? "start"
				                  : strncmp(table, "signal", 6) == 0 ? "signal"
				                                                     : "id";

				snprintf(
					text, sizeof(text),
					"update or ignore %s = %s where %s = (select %s(%s) from %.*s)",
					table, numbers[k], key, most ? "max" : "min", key, name,
					table);
				if (strstr(table, " id") || strstr(table, " start") ||
				    strstr(table, "signal set signal"))
					if (k > 5)
						continue; /* a key is a whole number */
				sql(text);
				read_all();
			}
		}
}

static void test_what_is_no_file_is_not_waited_for(void)
{
	static const char *const names[] = {"-journal", "-wal", "-shm", ""};

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		unlink(file(names[i]));
		TEST_ASSERT_EQUAL_INT(0, mkfifo(file(names[i]), 0600));
		alarm(LIMIT_S);
		TEST_ASSERT_EQUAL_INT(-EBADMSG, read_all());
		alarm(0);
		unlink(file(names[i]));
	}
}

static void test_what_is_no_table_is_not_read(void)
{
	static const char *const tables[] = {"session", "signal", "raw", "gap",
	                                     "event",   "minute", "hour"};
	char text[400];

	for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++) {
		put_back(i == 0);
		snprintf(text, sizeof(text),
		         "alter table %s rename to was; create view %s as with recursive"
		         " n (x) as (select 1 union all select x + 1 from n) select x as id, x as"
		         " start, x as signal, x as value, x as quality, x as until from n",
		         tables[i], tables[i]);
		sql(text);
		TEST_ASSERT_EQUAL_INT(-EBADMSG, read_all());
	}
	put_back(false);
	sql("alter table raw rename to was; create table raw (id integer primary key, signal,"
	    " value as (zeroblob(900000000)), quality)");
	TEST_ASSERT_EQUAL_INT(-EBADMSG, read_all());
}

static void test_a_file_that_takes_for_ever_is_given_up(void)
{
	struct ows_history *h;

	sql("with recursive n (x) as (select 1 union all select x + 1 from n where x < 30000)"
	    " insert or ignore into session select x, 1, 0, 0, 1, 1 from n;"
	    "with recursive n (x) as (select 1 union all select x + 1 from n where x < 30000)"
	    " insert or ignore into gap select x, 0, -x, 1 from n");
	alarm(LIMIT_S);
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, ows_history_open(NULL, past.directory, &h));
	alarm(0);
}

static void test_a_trigger_is_not_run(void)
{
	int64_t before = past_ask(&past, "select count(*) from raw");

	sql("create trigger t after insert on raw begin select raise(abort, 'no'); end;"
	    "create trigger u after insert on session begin delete from raw; end");
	past_begin(&past, 12100 * PAST_S, PAST_NOON, true);
	past_room(&past, 12101 * PAST_S, 5);
	past_end(&past, 12102 * PAST_S);
	TEST_ASSERT_EQUAL_INT64(before + 1, past_ask(&past, "select count(*) from raw"));
	TEST_ASSERT_EQUAL_INT(0, read_all());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_numbers_at_the_ends_of_their_range_are_times_that_can_be_reckoned_with);
	RUN_TEST(test_what_is_no_file_is_not_waited_for);
	RUN_TEST(test_what_is_no_table_is_not_read);
	RUN_TEST(test_a_file_that_takes_for_ever_is_given_up);
	RUN_TEST(test_a_trigger_is_not_run);
	return UNITY_END();
}
