/* SPDX-License-Identifier: MIT */
/* Tests of libows-history: what a writer recorded is read by the calls of ows_history.h. */
#include <errno.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/history/file/place.h"
#include "src/history/file/writer.h"
#include "src/history/library/handle.h"
#include "src/history/library/replay.h"
#include "src/public/ows_history.h"
#include "tests/unit/aid/folder.h"

#define SECOND INT64_C(1000000000)
#define DAY (86400 * SECOND)
#define NOON (20000 * DAY + DAY / 2)
#define BEYOND_DOUBLE ((INT64_C(1) << 53) + 1)
#define LOST_FROM 70 /* seconds, in which owsd was not there */
#define LOST_UNTIL 80
#define END 100
#define MOST 200
#define TOGETHER 20000 /* rows of the same time are microseconds apart */

enum { ROOM, PUMP, TITLE, STEPS, COUNT };
static const struct history_signal table[COUNT] = {
	[ROOM] = {"room", "°C", OWS_DOUBLE, 0, 2},
	[PUMP] = {"pump", "", OWS_BOOL, 1, -1},
	[TITLE] = {"title", "", OWS_STRING, 0, -1},
	[STEPS] = {"steps", "", OWS_LARGE, 0, 0},
};
static const struct history_who somebody = {7, 1000, 42, "owsctl", "anna"};

static char path[300];
static int folders;
static struct history_writer *writer;
static struct ows_history *h;

static void value(int signal, int64_t second, uint8_t quality, int64_t bits, const char *text)
{
	history_writer_value(writer, (uint32_t)signal, second * SECOND, quality, bits, text,
	                     text ? strlen(text) : 0);
}

static double temperature(int64_t second)
{
	return 20 + (double)second / 16;
}

static void room(int64_t second)
{
	value(ROOM, second, second == 30 ? OWS_Q_DEVICE : OWS_Q_GOOD,
	      value_of_double(temperature(second)), NULL);
}

static void event(struct history_event event, int64_t second)
{
	event.time_ns = second * SECOND;
	history_writer_event(writer, &event);
}

/* Values as of a second; in the time that was lost nothing is said. */
static void pass(int64_t second)
{
	if (second == LOST_FROM)
		history_writer_gap(writer, LOST_FROM * SECOND, LOST_UNTIL * SECOND,
		                   OWS_HISTORY_OWSD_LOST);
	if (second >= LOST_FROM && second < LOST_UNTIL)
		return;
	room(second);
	if (second == 1 || second == 20 || second == 40 || second == LOST_UNTIL)
		value(PUMP, second, OWS_Q_GOOD, second == 20, NULL);
	if (second == 1 || second == 50 || second == LOST_UNTIL)
		value(TITLE, second, OWS_Q_GOOD, 0, second == 1 ? "" : "Küche");
	if (second == 1 || second == LOST_UNTIL)
		value(STEPS, second, OWS_Q_GOOD, BEYOND_DOUBLE, NULL);
	if (second == 20)
		event((struct history_event){.kind = OWS_HISTORY_COMMAND,
		                             .type = OWS_BOOL,
		                             .quality = OWS_Q_GOOD,
		                             .reason = OWS_REASON_SET,
		                             .signal = PUMP,
		                             .has_value = true,
		                             .value = 1,
		                             .who = somebody},
		      second);
	if (second == 60)
		event((struct history_event){.kind = OWS_HISTORY_ALARM,
		                             .type = OWS_DOUBLE,
		                             .quality = OWS_Q_GOOD,
		                             .has_value = true,
		                             .reason = OWS_ALARM_H,
		                             .event = OWS_ALARM_RAISED,
		                             .signal = ROOM,
		                             .value = value_of_double(23.75),
		                             .before = value_of_double(99),
		                             .text = "why"},
		      second);
	TEST_ASSERT_EQUAL_INT(0, history_writer_tick(writer, second * SECOND));
}

static void record(int64_t boot)
{
	struct history_options options = {.directory = path, .boot = boot, .flush_ns = 10 * SECOND};

	TEST_ASSERT_EQUAL_INT(0, history_writer_open(&options, SECOND, NOON, true, &writer));
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, table, COUNT, SECOND));
	history_writer_begin(writer, SECOND);
	for (int64_t second = 1; second < END; second++)
		pass(second);
	TEST_ASSERT_EQUAL_INT(0, history_writer_close(writer, END * SECOND));
}

void setUp(void)
{
	snprintf(path, sizeof(path), "%s/history%d", folder_dir()->path, folders++);
	record(history_boot_present());
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, path, &h));
}

void tearDown(void)
{
	ows_history_close(h);
}

static int of(const char *name)
{
	int index = ows_history_find(h, name);

	TEST_ASSERT_TRUE(index >= 0);
	return index;
}

/* The minute that the first run begins in belongs to it, also if its middle is before that run. */
static void test_the_first_values_of_a_history_are_in_its_points(void)
{
	for (int64_t second = 1; second < 61; second += 2) {
		struct history_options options = {.boot = history_boot_present(),
		                                  .flush_ns = SECOND};
		struct ows_history_point points[24];
		struct ows_history *young;
		int64_t until = NOON + (second + 8) * SECOND;

		snprintf(path, sizeof(path), "%s/young%d", folder_dir()->path, folders++);
		options.directory = path;
		TEST_ASSERT_EQUAL_INT(
			0, history_writer_open(&options, second * SECOND, NOON, true, &writer));
		TEST_ASSERT_EQUAL_INT(
			0, history_writer_signals(writer, table, COUNT, second * SECOND));
		history_writer_begin(writer, second * SECOND);
		for (int64_t n = 1; n < 6; n++) {
			value(ROOM, second + n, OWS_Q_GOOD,
			      value_of_double(temperature(second + n)), NULL);
			TEST_ASSERT_EQUAL_INT(0,
			                      history_writer_tick(writer, (second + n) * SECOND));
		}
		TEST_ASSERT_EQUAL_INT(0, history_writer_close(writer, (second + 6) * SECOND));
		TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, path, &young));
		TEST_ASSERT_EQUAL_INT(24,
		                      ows_history_points(young, ows_history_find(young, "room"),
		                                         until - 3600 * SECOND, until, points, 24));
		TEST_ASSERT_EQUAL_DOUBLE(temperature(second + 1), points[23].min);
		TEST_ASSERT_EQUAL_DOUBLE(temperature(second + 5), points[23].max);
		ows_history_close(young);
	}
}

/* All items, got in portions. */
static int items_of(const char *name, struct ows_history_item items[MOST], int portion)
{
	int count = 0, got;

	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, of(name), 0, INT64_MAX));
	while ((got = ows_history_next(h, &items[count], portion)) > 0) {
		TEST_ASSERT_TRUE(got <= portion);
		count += got;
		TEST_ASSERT_TRUE(count + portion <= MOST);
	}
	TEST_ASSERT_EQUAL_INT(0, got);
	TEST_ASSERT_EQUAL_INT(0, ows_history_next(h, items, 1));
	return count;
}

static void test_signals_are_described_as_they_were_recorded(void)
{
	struct ows_history_signal signal;
	int64_t from, until;

	TEST_ASSERT_EQUAL_INT(COUNT, ows_history_signals(h));
	for (int i = 0; i < COUNT; i++) {
		TEST_ASSERT_EQUAL_INT(0, ows_history_signal(h, of(table[i].name), &signal));
		TEST_ASSERT_EQUAL_STRING(table[i].name, signal.name);
		TEST_ASSERT_EQUAL_STRING(table[i].unit, signal.unit);
		TEST_ASSERT_EQUAL_INT(table[i].type, signal.type);
		TEST_ASSERT_EQUAL_INT(table[i].output, signal.output);
		TEST_ASSERT_EQUAL_INT(table[i].decimals, signal.decimals);
	}
	TEST_ASSERT_EQUAL_INT(-ENOENT, ows_history_find(h, "roo"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_signal(h, COUNT, &signal));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_signal(h, -1, &signal));
	TEST_ASSERT_EQUAL_INT(0, ows_history_span(h, &from, &until));
	TEST_ASSERT_EQUAL_INT64(NOON + SECOND, from);
	TEST_ASSERT_EQUAL_INT64(NOON + END * SECOND, until);
}

static void check_room(const struct ows_history_item *items, int count)
{
	int64_t second = 1;

	for (int i = 0; i < count; i++) {
		const struct ows_history_item *item = &items[i];

		TEST_ASSERT_EQUAL_INT64(NOON + second * SECOND, item->time_ns);
		TEST_ASSERT_EQUAL_INT64(second * SECOND, item->boot_ns);
		TEST_ASSERT_TRUE(item->trusted && !item->text && item->integer == 0);
		TEST_ASSERT_EQUAL_INT(second != LOST_FROM && second != END, item->known);
		if (item->known) {
			TEST_ASSERT_EQUAL_DOUBLE(temperature(second), item->number);
			TEST_ASSERT_EQUAL_INT(second == 30 ? OWS_Q_DEVICE : OWS_Q_GOOD,
			                      item->quality);
		} else {
			TEST_ASSERT_TRUE(isnan(item->number));
			TEST_ASSERT_EQUAL_INT(0, item->quality);
			TEST_ASSERT_EQUAL_STRING(second == END ? "recorder stopped" : "owsd lost",
			                         ows_history_reason_text(item->reason));
		}
		second = second == LOST_FROM ? LOST_UNTIL : second + 1;
	}
	TEST_ASSERT_EQUAL_INT(END + 1, second);
}

static void test_numbers_are_read_in_portions_of_any_size(void)
{
	static struct ows_history_item items[MOST];

	for (int portion = 1; portion < 100; portion += 24)
		check_room(items, items_of("room", items, portion));
}

static void test_a_part_begins_with_what_held_then(void)
{
	struct ows_history_item items[MOST];

	TEST_ASSERT_EQUAL_INT(
		0, ows_history_read(h, of("pump"), NOON + 30 * SECOND, NOON + 60 * SECOND));
	TEST_ASSERT_EQUAL_INT(2, ows_history_next(h, items, MOST));
	TEST_ASSERT_INT64_WITHIN(TOGETHER, NOON + 20 * SECOND, items[0].time_ns);
	TEST_ASSERT_EQUAL_INT64(1, items[0].integer);
	TEST_ASSERT_INT64_WITHIN(TOGETHER, NOON + 40 * SECOND, items[1].time_ns);
	TEST_ASSERT_EQUAL_INT64(0, items[1].integer);
}

static void test_integers_are_whole_and_texts_come_one_at_a_time(void)
{
	static struct ows_history_item items[MOST];
	static const char *const texts[] = {"", "Küche", NULL, "Küche", NULL};

	TEST_ASSERT_TRUE(items_of("steps", items, 50) >= 3);
	TEST_ASSERT_EQUAL_INT64(BEYOND_DOUBLE, items[0].integer);
	TEST_ASSERT_EQUAL_INT(OWS_LARGE, items[0].type);
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, of("title"), 0, INT64_MAX));
	for (int i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL_INT(1, ows_history_next(h, items, texts[i] ? MOST : 1));
		TEST_ASSERT_EQUAL_INT(texts[i] != NULL, items[0].known);
		TEST_ASSERT_TRUE(isnan(items[0].number));
		if (!texts[i])
			continue;
		TEST_ASSERT_EQUAL_STRING(texts[i], items[0].text);
		TEST_ASSERT_EQUAL_INT(strlen(texts[i]), items[0].len);
	}
	TEST_ASSERT_EQUAL_INT(0, ows_history_next(h, items, 1));
}

static void test_points_have_the_range_of_each_stretch_and_gaps(void)
{
	struct ows_history_point points[10];

	TEST_ASSERT_EQUAL_INT(
		10, ows_history_points(h, of("room"), NOON, NOON + END * SECOND, points, 10));
	for (int i = 1; i < 10; i++) {
		TEST_ASSERT_EQUAL_INT64(NOON + 10 * i * SECOND, points[i].from_ns);
		TEST_ASSERT_EQUAL_INT64(NOON + 10 * (i + 1) * SECOND, points[i].until_ns);
		TEST_ASSERT_TRUE(points[i].trusted);
		TEST_ASSERT_EQUAL_INT(i == 7, points[i].gap);
		if (i == 7) {
			TEST_ASSERT_TRUE(isnan(points[i].min) && points[i].known_ns == 0);
			continue;
		}
		TEST_ASSERT_EQUAL_INT(10, points[i].count);
		TEST_ASSERT_EQUAL_DOUBLE(temperature(10 * i + (i == 3)), points[i].min);
		TEST_ASSERT_EQUAL_DOUBLE(temperature(10 * i + 9), points[i].max);
		TEST_ASSERT_EQUAL_DOUBLE(temperature(10 * i + 9), points[i].last);
		TEST_ASSERT_DOUBLE_WITHIN(1e-3,
		                          temperature(10 * i + 4) + (i == 3 ? 0.0625 : 0.03125),
		                          points[i].mean);
		TEST_ASSERT_EQUAL_INT64(10 * SECOND, points[i].known_ns);
		TEST_ASSERT_EQUAL_INT64((i == 3 ? 9 : 10) * SECOND, points[i].good_ns);
		TEST_ASSERT_EQUAL_INT(i == 3 ? OWS_Q_DEVICE : OWS_Q_GOOD, points[i].worst);
		TEST_ASSERT_EQUAL_INT(OWS_Q_GOOD, points[i].quality);
	}
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_points(h, 0, NOON, NOON, points, 10));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_points(h, 0, NOON, NOON + DAY, points, 0));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_points(h, COUNT, NOON, NOON + DAY, points, 1));
}

/* The only event of a kind. */
static struct ows_history_event only(uint32_t kind)
{
	struct ows_history_event first, more;

	TEST_ASSERT_EQUAL_INT(0, ows_history_events(h, 0, INT64_MAX, 1u << kind));
	TEST_ASSERT_EQUAL_INT(1, ows_history_next_event(h, &first));
	TEST_ASSERT_EQUAL_INT(0, ows_history_next_event(h, &more));
	TEST_ASSERT_EQUAL_INT(0, ows_history_next_event(h, &more));
	TEST_ASSERT_EQUAL_INT(kind, first.kind);
	return first;
}

static void check_events(bool this_boot)
{
	struct ows_history_event e = only(OWS_HISTORY_COMMAND);

	TEST_ASSERT_EQUAL_INT64(NOON + 20 * SECOND, e.time_ns);
	TEST_ASSERT_EQUAL_INT64(20 * SECOND, e.boot_ns);
	TEST_ASSERT_EQUAL_INT(of("pump"), e.signal);
	TEST_ASSERT_EQUAL_INT(OWS_REASON_SET, e.reason);
	TEST_ASSERT_TRUE(e.number == 1 && e.integer == 1 && e.type == OWS_BOOL);
	TEST_ASSERT_EQUAL_INT(this_boot, e.this_boot);
	TEST_ASSERT_TRUE(e.who.serial == 7 && e.who.uid == 1000 && e.who.pid == 42);
	TEST_ASSERT_EQUAL_STRING("owsctl", e.who.name);
	TEST_ASSERT_EQUAL_STRING("anna", e.who.person);
	e = only(OWS_HISTORY_ALARM);
	TEST_ASSERT_EQUAL_INT(of("room"), e.signal);
	TEST_ASSERT_TRUE(e.alarm == OWS_ALARM_H && e.event == OWS_ALARM_RAISED && e.reason == 0);
	TEST_ASSERT_TRUE(e.has_after && !e.has_before && e.before == 0 && e.number == 23.75);
	TEST_ASSERT_EQUAL_STRING("why", e.text);
	TEST_ASSERT_EQUAL_INT(0, e.who.serial);
	e = only(OWS_HISTORY_GAP);
	TEST_ASSERT_EQUAL_INT64(NOON + LOST_FROM * SECOND, e.time_ns);
	TEST_ASSERT_EQUAL_INT64(NOON + LOST_UNTIL * SECOND, e.until_ns);
	TEST_ASSERT_EQUAL_INT(OWS_HISTORY_OWSD_LOST, e.reason);
	TEST_ASSERT_EQUAL_INT(-1, e.signal);
	e = only(OWS_HISTORY_BEGIN);
	TEST_ASSERT_EQUAL_INT(OWS_HISTORY_LOST, e.reason);
	only(OWS_HISTORY_END);
}

static void test_the_journal_has_commands_alarms_and_what_the_recorder_met(void)
{
	struct ows_history_event e;
	int count = 0;

	check_events(true);
	TEST_ASSERT_EQUAL_INT(0, ows_history_events(h, NOON + 20 * SECOND, NOON + 61 * SECOND, 0));
	while (ows_history_next_event(h, &e) == 1)
		count++;
	TEST_ASSERT_EQUAL_INT(2, count);
}

static void test_another_boot_is_told_from_this_one(void)
{
	ows_history_close(h);
	snprintf(path, sizeof(path), "%s/history%d", folder_dir()->path, folders++);
	record(history_boot_present() + 1);
	TEST_ASSERT_EQUAL_INT(0, ows_history_open("OWS", path, &h));
	check_events(false);
}

static void test_calls_out_of_order_are_refused(void)
{
	struct ows_history_item item;
	struct ows_history_event e;
	struct ows_history_point point;

	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next(h, &item, 1));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next_event(h, &e));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_read(h, COUNT, 0, 1));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next(h, &item, 1));
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, 0, 0, INT64_MAX));
	TEST_ASSERT_EQUAL_INT(0, ows_history_events(h, 0, INT64_MAX, 0));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next(h, &item, 0));
	TEST_ASSERT_EQUAL_INT(1, ows_history_next(h, &item, 1));
	TEST_ASSERT_EQUAL_INT(0, ows_history_refresh(h));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next(h, &item, 1));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next_event(h, &e));
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, 0, 0, INT64_MAX));
	TEST_ASSERT_EQUAL_INT(1, ows_history_points(h, 0, NOON, NOON + DAY, &point, 1));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_next(h, &item, 1));
	ows_history_close(NULL);
}

static void test_an_instance_is_found_by_its_name(void)
{
	char state[350], expected[400], found[400];
	struct ows_history *none;
	uid_t user = geteuid();

	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_place("../OWS", found, sizeof(found)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ows_history_open("a/b", NULL, &none));
	TEST_ASSERT_NULL(none);
	TEST_ASSERT_EQUAL_INT(-ENOENT, ows_history_open(NULL, "/nowhere/at/all", &none));
	TEST_ASSERT_EQUAL_INT(-ENOENT, ows_history_open("no-such-instance", NULL, &none));
	/* that of a service that reads is its own, and is no history */
	setenv("STATE_DIRECTORY", path, 1);
	snprintf(state, sizeof(state), "%s/owsd", path);
	TEST_ASSERT_EQUAL_INT(0, mkdir(state, 0755));
	snprintf(state, sizeof(state), "%s/owsd/history", path);
	TEST_ASSERT_EQUAL_INT(0, mkdir(state, 0755));
	snprintf(expected, sizeof(expected), "%s/house", state);
	TEST_ASSERT_EQUAL_INT(0, mkdir(expected, 0755));
	setenv("XDG_STATE_HOME", path, 1);
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	TEST_ASSERT_EQUAL_INT(0, ows_history_place("house", found, sizeof(found)));
	TEST_ASSERT_EQUAL_STRING(expected, found);
	TEST_ASSERT_EQUAL_INT(-ENOSPC, ows_history_place("house", found, strlen(expected)));
	TEST_ASSERT_EQUAL_INT(0, ows_history_place("no-such-one", found, sizeof(found)));
	TEST_ASSERT_EQUAL_STRING("/var/lib/owsd-recorder/no-such-one", found);
	TEST_ASSERT_EQUAL_INT(0, seteuid(user));
	unsetenv("XDG_STATE_HOME");
	unsetenv("STATE_DIRECTORY");
}

/* One who may read the files, and write nothing beside them: also after the recorder has ended. */
static void test_a_user_who_may_only_read_reads_all(void)
{
	static struct ows_history_item items[MOST];

	if (geteuid() != 0)
		TEST_IGNORE_MESSAGE("needs root");
	ows_history_close(h);
	h = NULL;
	for (const char *at = path + 1; (at = strchr(at, '/')) != NULL; at++) {
		char above[300];

		snprintf(above, sizeof(above), "%.*s", (int)(at - path), path);
		chmod(above, 0755);
	}
	TEST_ASSERT_EQUAL_INT(0, chmod(path, 0755));
	for (int i = 0; i < 3; i++) {
		static const char *const files[] = {"", "-wal", "-shm"};
		char name[400];

		snprintf(name, sizeof(name), "%s/history.sqlite%s", path, files[i]);
		TEST_ASSERT_EQUAL_INT(0, chmod(name, 0644));
	}
	for (int running = 0; running < 2; running++) {
		int64_t alarms, commands;
		struct history_options options = {.directory = path, .boot = 9};

		if (running) {
			history_writer_open(&options, END * SECOND, NOON, true, &writer);
			history_writer_known(writer, &alarms, &commands);
		}
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
		TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, path, &h));
		TEST_ASSERT_TRUE(items_of("room", items, 40) > 80);
		ows_history_close(h);
		h = NULL;
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
		if (running)
			history_writer_close(writer, END * SECOND);
	}
}

/* A copy of the one file, where nothing can be written. */
static void test_a_copy_without_its_log_is_read_too(void)
{
	static struct ows_history_item items[MOST];
	char command[400];

	/* it has all of it once the recorder has ended */
	ows_history_close(h);
	h = NULL;
	snprintf(command, sizeof(command), "cd %s && rm history.sqlite-* && chmod 0555 .", path);
	TEST_ASSERT_EQUAL_INT(0, system(command));
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, path, &h));
	TEST_ASSERT_TRUE(items_of("room", items, 40) > 80);
	chmod(path, 0755);
}

/*
 * --- Sums of minutes and hours -----------------------------------------------------------------
 */

#define STRETCHES 30

/* Two days and more, with gaps, in two runs. */
static void record_days(void)
{
	int64_t now = 7 * SECOND;

	for (int run = 0; run < 2; run++) {
		struct history_options options = {
			.directory = path, .boot = 3, .flush_ns = 600 * SECOND};

		TEST_ASSERT_EQUAL_INT(0, history_writer_open(&options, now, NOON, true, &writer));
		TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, table, 1, now));
		history_writer_begin(writer, now);
		for (int i = 0; i < 3000; i++) {
			now += (1 + (i * 7919) % 59) * SECOND + 1000000;
			if (i % 397 == 396)
				history_writer_gap(writer, now, now, OWS_HISTORY_OWSD_LOST);
			else
				history_writer_value(writer, ROOM, now, OWS_Q_GOOD,
				                     value_of_double((double)((i * 31) % 500) / 8),
				                     NULL, 0);
			if (i % 20 == 0)
				TEST_ASSERT_EQUAL_INT(0, history_writer_tick(writer, now));
		}
		now += 500 * SECOND;
		TEST_ASSERT_EQUAL_INT(0, history_writer_close(writer, now));
		now += 700 * SECOND;
	}
}

static void open_days(void)
{
	ows_history_close(h);
	h = NULL;
	snprintf(path, sizeof(path), "%s/history%d", folder_dir()->path, folders++);
	record_days();
	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, path, &h));
}

/* What the items say of a stretch, which is widened by so much on both sides. */
static void sum_items(const struct ows_history_item *items, int count, int64_t from, int64_t until,
                      struct ows_history_point *sum)
{
	*sum = (struct ows_history_point){.min = INFINITY, .max = -INFINITY};
	for (int i = 0; i + 1 < count; i++) {
		int64_t begin = items[i].time_ns > from ? items[i].time_ns : from;
		int64_t end = items[i + 1].time_ns < until ? items[i + 1].time_ns : until;

		if (!items[i].known || begin >= end)
			continue;
		sum->known_ns += end - begin;
		sum->min = fmin(sum->min, items[i].number);
		sum->max = fmax(sum->max, items[i].number);
		sum->mean += items[i].number * (double)(end - begin);
	}
}

/* Of whole minutes and hours the points are what the values are, and no point is beyond them. */
static void test_points_of_sums_are_those_of_the_values(void)
{
	static const int64_t widths[] = {40, 60, 120, 600, 3600, 7200, 10800}; /* seconds */
	static struct ows_history_item items[7000];
	struct ows_history_point points[STRETCHES], sum, wide;
	int count = 0, got;

	open_days();
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, 0, 0, INT64_MAX));
	while ((got = ows_history_next(h, &items[count], 7000 - count)) > 0)
		count += got;
	for (size_t w = 0; w < sizeof(widths) / sizeof(widths[0]); w++) {
		int64_t width = widths[w] * SECOND, from = NOON + 3600 * SECOND;

		TEST_ASSERT_EQUAL_INT(STRETCHES,
		                      ows_history_points(h, 0, from, from + STRETCHES * width,
		                                         points, STRETCHES));
		for (int i = 0; i < STRETCHES; i++) {
			const struct ows_history_point *p = &points[i];

			sum_items(items, count, p->from_ns, p->until_ns, &sum);
			/* each stretch begins where a minute does, and an hour where it is long */
			TEST_ASSERT_INT64_WITHIN(SECOND / 1000, sum.known_ns, p->known_ns);
			TEST_ASSERT_EQUAL_INT(width - sum.known_ns > SECOND / 1000, p->gap);
			sum_items(items, count, p->from_ns - SECOND, p->until_ns + SECOND, &wide);
			if (p->good_ns == 0)
				continue;
			TEST_ASSERT_TRUE(p->min >= wide.min && p->max <= wide.max);
			TEST_ASSERT_TRUE(p->min <= sum.min && p->max >= sum.max);
			TEST_ASSERT_DOUBLE_WITHIN(0.01, sum.mean / (double)sum.known_ns, p->mean);
		}
	}
}

/* The last minute says where hours end: they are what they are when no minute is left. */
static void test_hours_are_the_same_with_and_without_minutes(void)
{
	const int64_t from = NOON + 3600 * SECOND, until = from + STRETCHES * 7200 * SECOND;
	struct ows_history_point with[STRETCHES], without[STRETCHES];
	int64_t end;
	char file[400];
	sqlite3 *db;

	open_days();
	end = h->hour_end;
	TEST_ASSERT_TRUE(end > (NOON + 2 * DAY) / 1000);
	TEST_ASSERT_EQUAL_INT(STRETCHES, ows_history_points(h, 0, from, until, with, STRETCHES));
	snprintf(file, sizeof(file), "%s/history.sqlite", path);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_open(file, &db));
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_exec(db, "delete from minute", NULL, NULL, NULL));
	sqlite3_close(db);
	TEST_ASSERT_EQUAL_INT(0, ows_history_refresh(h));
	TEST_ASSERT_EQUAL_INT64(end, h->hour_end);
	TEST_ASSERT_EQUAL_INT(STRETCHES, ows_history_points(h, 0, from, until, without, STRETCHES));
	for (int i = 0; i < STRETCHES; i++) {
		TEST_ASSERT_EQUAL_INT64(with[i].known_ns, without[i].known_ns);
		TEST_ASSERT_EQUAL_DOUBLE(with[i].min, without[i].min);
		TEST_ASSERT_EQUAL_DOUBLE(with[i].max, without[i].max);
	}
}

static void test_all_rows_come_once_in_the_order_of_recording(void)
{
	struct replay_point begin = {history_boot_present(), 0, 0}, lost = begin;
	struct replay_row rows[7];
	int of_signal[COUNT] = {0}, gaps = 0, got;
	int64_t first = replay_place(h, &begin), last = 0;

	TEST_ASSERT_TRUE(first > 0 && replay_end(h) > first);
	while ((got = replay_rows(h, first, replay_end(h), rows, 7)) > 0)
		for (int i = 0; i < got; i++) {
			TEST_ASSERT_TRUE(rows[i].at.us > last || rows[i].signal < 0);
			TEST_ASSERT_EQUAL_INT64(begin.boot, rows[i].at.boot);
			TEST_ASSERT_EQUAL_INT64(NOON / 1000, rows[i].wall_us - rows[i].at.us);
			last = rows[i].at.us;
			rows[i].at.us++;
			first = replay_place(h, &rows[i].at);
			gaps += rows[i].signal < 0;
			if (rows[i].signal >= 0)
				of_signal[rows[i].signal]++;
			if (rows[i].signal == of("title"))
				TEST_ASSERT_NOT_NULL(rows[i].text);
			free(rows[i].text);
		}
	TEST_ASSERT_EQUAL_INT(0, got);
	TEST_ASSERT_EQUAL_INT(END - 1 - (LOST_UNTIL - LOST_FROM), of_signal[of("room")]);
	TEST_ASSERT_EQUAL_INT(4, of_signal[of("pump")]);
	TEST_ASSERT_EQUAL_INT(3, of_signal[of("title")]);
	TEST_ASSERT_EQUAL_INT(2, gaps); /* the end of the recorder, too */
	lost.us = LOST_FROM * SECOND / 1000;
	first = replay_place(h, &lost);
	TEST_ASSERT_EQUAL_INT(1, replay_rows(h, first, replay_end(h), rows, 1));
	TEST_ASSERT_EQUAL_INT(-1, rows[0].signal);
	lost.boot++;
	TEST_ASSERT_EQUAL_INT64(h->sessions[0].start, replay_place(h, &lost));
}

/* The boot of a run that ended long before the moment: what comes is of the next run, all of it. */
static void test_a_moment_behind_a_run_is_not_in_the_next_one(void)
{
	struct session runs[] = {{.start = 100, .end = 200, .base = 90, .boot = 1},
	                         {.start = 200, .end = 900, .base = 190, .boot = 2}};
	struct ows_history two = {.sessions = runs, .session_count = 2};
	const struct {
		struct replay_point at;
		int64_t place;
	} cases[] = {{{1, 20, 0}, 110},  {{1, 109, 0}, 199},  {{1, 110, 0}, 200},
	             {{1, 111, 0}, 199}, {{1, 5000, 0}, 199}, {{2, 5000, 0}, 5190}};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		TEST_ASSERT_EQUAL_INT64(cases[i].place, replay_place(&two, &cases[i].at));
}

/* The recorder was not there in that boot, or has begun a new file. */
static void test_a_boot_that_is_not_known_has_its_place_by_the_clock(void)
{
	struct session runs[] = {{.start = 100, .base = 90, .boot = 1, .date = 1000},
	                         {.start = 200, .base = 190, .boot = 2, .date = 2000},
	                         {.start = 900, .base = 890, .boot = 3, .date = -900}};
	struct ows_history three = {.sessions = runs, .session_count = 3, .end = 1000};
	const struct {
		int64_t boot; /* of now */
		struct replay_point at;
		int64_t place;
	} cases[] = {
		{3, {7, 5, 1100}, 100},  {3, {7, 5, 1101}, 200},     {3, {7, 5, 2200}, 200},
		{3, {7, 5, 2201}, 900},  {3, {7, 5, 9999}, 900},     {3, {3, 15, 9999}, 905},
		{8, {7, 5, 9999}, 1001}, {8, {8, 5, 9999}, -ENOENT},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		three.boot = cases[i].boot;
		TEST_ASSERT_EQUAL_INT64(cases[i].place, replay_place(&three, &cases[i].at));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_signals_are_described_as_they_were_recorded);
	RUN_TEST(test_numbers_are_read_in_portions_of_any_size);
	RUN_TEST(test_a_part_begins_with_what_held_then);
	RUN_TEST(test_integers_are_whole_and_texts_come_one_at_a_time);
	RUN_TEST(test_points_have_the_range_of_each_stretch_and_gaps);
	RUN_TEST(test_the_journal_has_commands_alarms_and_what_the_recorder_met);
	RUN_TEST(test_another_boot_is_told_from_this_one);
	RUN_TEST(test_calls_out_of_order_are_refused);
	RUN_TEST(test_an_instance_is_found_by_its_name);
	RUN_TEST(test_a_user_who_may_only_read_reads_all);
	RUN_TEST(test_a_copy_without_its_log_is_read_too);
	RUN_TEST(test_the_first_values_of_a_history_are_in_its_points);
	RUN_TEST(test_points_of_sums_are_those_of_the_values);
	RUN_TEST(test_hours_are_the_same_with_and_without_minutes);
	RUN_TEST(test_all_rows_come_once_in_the_order_of_recording);
	RUN_TEST(test_a_moment_behind_a_run_is_not_in_the_next_one);
	RUN_TEST(test_a_boot_that_is_not_known_has_its_place_by_the_clock);
	return UNITY_END();
}
