/* SPDX-License-Identifier: MIT */
/* owsctl journal and trend on a history that a writer made, beside the memory of an instance. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/history/file/place.h"
#include "src/history/file/writer.h"
#include "src/memory/shm/entries.h"
#include "src/tool/owsctl/past.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define SECOND INSTANCE_S
#define MS (SECOND / 1000)

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"pump", "/29.1/PIO.0", OWS_BOOL, true, 0},
};
enum { ROOM, PUMP, LABEL, STEPS, COUNT };
static const struct history_signal table[COUNT] = {
	[ROOM] = {"room1", "°C", OWS_DOUBLE, 0, 2},
	[PUMP] = {"pump", "", OWS_BOOL, 1, -1},
	[LABEL] = {"label", "", OWS_STRING, 1, -1},
	[STEPS] = {"steps", "", OWS_LARGE, 0, 0},
};
static const struct history_who plc = {3, 4294967290u, 4711, "plc", "Anna"};
static struct instance in;
static struct history_writer *writer;
static int64_t begun_ns;
static char path[300], words[500];
static int folders;

/* A history that begins a minute ago; of another boot of the machine, or of this one. */
static void write_from(int64_t boot, int64_t now_ns)
{
	struct history_options options = {.directory = path, .boot = boot, .flush_ns = 10 * SECOND};
	struct timespec wall;

	clock_gettime(CLOCK_REALTIME, &wall);
	begun_ns = now_ns - 60 * SECOND;
	TEST_ASSERT_EQUAL_INT(0, history_writer_open(&options, begun_ns,
	                                             wall.tv_sec * SECOND + wall.tv_nsec - now_ns,
	                                             true, &writer));
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, table, COUNT, begun_ns));
	history_writer_begin(writer, begun_ns);
}

static void written(void)
{
	TEST_ASSERT_EQUAL_INT(0, history_writer_close(writer, begun_ns + 60 * SECOND));
	writer = NULL;
}

void setUp(void)
{
	instance_start(&in, "ctlpast", signals, 2);
	caught_begin(in.name);
	snprintf(path, sizeof(path), "%s/past%d", folder_dir()->path, folders++);
	write_from(history_boot_present(), ows_now());
}

void tearDown(void)
{
	if (writer)
		written();
	instance_end(&in);
	caught_end();
}

static int journal(const char *more)
{
	snprintf(words, sizeof(words), "journal -d %s %s", path, more);
	return run(verb_journal, words);
}

static int trend(const char *more)
{
	snprintf(words, sizeof(words), "trend -d %s %s", path, more);
	return run(verb_trend, words);
}

static void test_a_trend_of_a_directory_that_is_not_there_names_the_option_and_the_key(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_trend, "trend -d /nowhere room"));
	holds(err, "/nowhere: No such file or directory; does owsd-recorder run? "
	           "-d DIR names its Directory, if it has one");
}

static void on_disk(unsigned signal, int64_t value, int64_t at_ns)
{
	struct history_event event = {.kind = OWS_HISTORY_COMMAND,
	                              .type = table[signal].type,
	                              .quality = OWS_Q_GOOD,
	                              .reason = OWS_REASON_SET,
	                              .signal = signal,
	                              .time_ns = at_ns,
	                              .has_value = true,
	                              .value = value,
	                              .who = plc};

	history_writer_event(writer, &event);
}

static void alarm_on_disk(uint8_t event, double after, int64_t at_ns)
{
	struct history_event entry = {.kind = OWS_HISTORY_ALARM,
	                              .type = OWS_DOUBLE,
	                              .quality = OWS_Q_GOOD,
	                              .has_value = true,
	                              .reason = OWS_ALARM_H,
	                              .event = event,
	                              .signal = ROOM,
	                              .time_ns = at_ns,
	                              .value = value_of_double(after),
	                              .text = "why"};

	history_writer_event(writer, &entry);
}

static struct ows_journal_entry entry_of(uint32_t record, int64_t at_ns, uint8_t kind,
                                         int64_t value)
{
	return (struct ows_journal_entry){
		.record = record + 1,
		.occurred_ns = at_ns,
		.after = value,
		.flags = OWS_JOURNAL_AFTER,
		.kind = kind,
		.quality = OWS_Q_GOOD,
		.who = {.serial = 3, .uid = 4294967290u, .pid = 4711, .name = "plc"},
	};
}

static void in_memory(int64_t value, int64_t at_ns)
{
	struct ows_journal_entry entry = entry_of(PUMP, at_ns, OWS_REASON_SET, value);

	image_command(&in.image, &entry);
}

static void alarm_in_memory(uint8_t event, double after, int64_t at_ns)
{
	struct ows_journal_entry entry = entry_of(ROOM, at_ns, OWS_ALARM_H, value_of_double(after));

	entry.event = event;
	image_alarm(&in.image, &entry);
}

static unsigned times(const char *part)
{
	unsigned n = 0;

	for (const char *at = out; (at = strstr(at, part)) != NULL; at++)
		n++;
	return n;
}

static void test_what_is_in_memory_and_on_disk_is_shown_once(void)
{
	int64_t at = begun_ns + 10 * SECOND + 123456;

	alarm_on_disk(OWS_ALARM_RAISED, 31, at);
	alarm_in_memory(OWS_ALARM_RAISED, 31, at);
	alarm_on_disk(OWS_ALARM_RETURNED, 20, at + 1); /* another event in the same millisecond */
	on_disk(PUMP, 1, at + SECOND);
	in_memory(1, at + SECOND);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json"));
	TEST_ASSERT_EQUAL(3, times("\"time\""));
	holds(out, "\"journal\":\"alarms\",\"number\":0,\"name\":\"room1\",\"alarm\":\"high\","
	           "\"event\":\"raised\",\"value\":31,");
	holds(out, "\"journal\":\"alarms\",\"number\":null,\"name\":\"room1\",\"alarm\":\"high\","
	           "\"event\":\"returned\",\"value\":20,\"before\":null,\"after\":20,"
	           "\"quality\":\"good\",\"by\":null,\"more\":0,\"remark\":\"why\"}");
	holds(out, "\"journal\":\"commands\",\"number\":0,\"name\":\"pump\"");
	TEST_ASSERT_EQUAL_STRING("", err);
}

static void test_of_the_same_in_a_millisecond_the_newest_are_those_in_memory(void)
{
	int64_t at = (begun_ns / MS + 5000) * MS;

	/* the first of three is no longer in memory */
	on_disk(PUMP, 0, at);
	on_disk(PUMP, 1, at + 10);
	on_disk(PUMP, 1, at + 20);
	in_memory(1, at + 10);
	in_memory(1, at + 20);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json"));
	TEST_ASSERT_EQUAL(3, times("\"time\""));
	TEST_ASSERT_EQUAL(1, times("\"number\":null,\"name\":\"pump\",\"alarm\":null,\"event\":"
	                           "\"set\",\"value\":false"));
	TEST_ASSERT_EQUAL(2, times("\"value\":true"));
}

static void test_one_order_in_which_earlier_boots_come_first(void)
{
	const char *first, *second, *third;

	in_memory(0, begun_ns + 30 * SECOND);
	alarm_on_disk(OWS_ALARM_RAISED, 31, begun_ns + 40 * SECOND);
	written();
	/* at the same boot times as above, and by the wall clock a moment before now */
	write_from(history_boot_present() + 1, ows_now());
	on_disk(PUMP, 1, begun_ns + 30 * SECOND);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, journal(""));
	first = strstr(out, "  pump   set              1  plc[4711]  4294967290  Anna");
	second = strstr(out, "  pump   set              0  plc[4711]  4294967290  -");
	third = strstr(out, "  room1  high raised     31  -          -           -     why");
	TEST_ASSERT_TRUE_MESSAGE(first && second && third, out);
	TEST_ASSERT_TRUE_MESSAGE(first < second && second < third, out);
}

static void test_number_patterns_and_span_choose_among_both(void)
{
	for (int i = 0; i < 9; i++)
		on_disk(i % 3 ? PUMP : STEPS, i % 2, begun_ns + (1 + i) * SECOND);
	in_memory(1, begun_ns + 50 * SECOND);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json"));
	TEST_ASSERT_EQUAL(10, times("\"time\""));
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json p*"));
	TEST_ASSERT_EQUAL(7, times("\"time\""));
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json -c 3"));
	TEST_ASSERT_EQUAL(3, times("\"time\""));
	TEST_ASSERT_EQUAL(2, times("\"number\":null"));
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json -c 0"));
	TEST_ASSERT_EQUAL_STRING("[]\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json steps"));
	TEST_ASSERT_EQUAL(3, times("\"name\":\"steps\""));
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json -s 15"));
	TEST_ASSERT_EQUAL(1, times("\"time\""));
	in_memory(1, begun_ns + 65 * SECOND);
	/* those in memory, too: the first of the two is ten seconds old, the second yet to come */
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json -s 5"));
	TEST_ASSERT_EQUAL(1, times("\"time\""));
	TEST_ASSERT_EQUAL(CTL_FAILED, journal("nothing"));
	holds(err, "there is no nothing");
	TEST_ASSERT_EQUAL(CTL_USAGE, journal("-s soon"));
	holds(err, "owsctl: -s soon: expected a time");
	TEST_ASSERT_EQUAL(CTL_USAGE, journal("--since=soon"));
	holds(err, "owsctl: --since soon: expected a time");
	TEST_ASSERT_EQUAL(CTL_USAGE, journal("--json -s soon"));
	holds(err, "owsctl: -s soon: expected a time");
	TEST_ASSERT_EQUAL(CTL_USAGE, journal("-c 1000001"));
}

static void test_of_many_the_last_ones_are_shown(void)
{
	for (int i = 0; i < 2000; i++)
		on_disk(STEPS, i, begun_ns + i * 10 * MS);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json"));
	TEST_ASSERT_EQUAL(1000, times("\"time\""));
	TEST_ASSERT_NULL(strstr(out, "\"value\":999,"));
	holds(out, "\"value\":1000,");
	holds(out, "\"value\":1999,");
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json -c 1500"));
	TEST_ASSERT_EQUAL(1500, times("\"time\""));
	TEST_ASSERT_NULL(strstr(out, "\"value\":499,"));
}

static void test_without_owsd_the_disk_is_shown_alone(void)
{
	on_disk(PUMP, 1, begun_ns + SECOND);
	written();
	caught_begin("neverran");
	TEST_ASSERT_EQUAL(CTL_DONE, journal("--json pump"));
	TEST_ASSERT_EQUAL(1, times("\"name\":\"pump\""));
	TEST_ASSERT_EQUAL_STRING("", err);
	TEST_ASSERT_EQUAL(CTL_FAILED, journal("room"));
	holds(err, "the history has no signal room\n");
	TEST_ASSERT_EQUAL(CTL_FAILED, journal("bump"));
	holds(err, "the history has no signal bump; did you mean pump?");
	TEST_ASSERT_EQUAL(CTL_FAILED, journal("-f"));
	holds(err, "no owsd of the name neverran has run here");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_journal, "journal"));
	holds(err, "no owsd of the name neverran has run here");
}

static void test_a_damaged_file_is_named(void)
{
	char file[600];

	on_disk(PUMP, 1, begun_ns + SECOND);
	written();
	snprintf(file, sizeof(file), "%s/history.sqlite-wal", path);
	TEST_ASSERT_EQUAL_INT(0, unlink(file));
	snprintf(file, sizeof(file), "%s/history.sqlite", path);
	TEST_ASSERT_EQUAL_INT(0, truncate(file, 100));
	TEST_ASSERT_EQUAL(CTL_FAILED, journal("--json"));
	holds(err, "Bad message");
}

static void value(unsigned signal, int64_t second, uint8_t quality, int64_t bits, const char *text)
{
	history_writer_value(writer, signal, begun_ns + second * SECOND, quality, bits, text,
	                     text ? strlen(text) : 0);
}

/* The line of a point, without its time. */
static void has_point(const char *line)
{
	const char *at = strstr(out, line);

	TEST_ASSERT_NOT_NULL_MESSAGE(at, out);
	at += strlen(line);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(19, strspn(at, "0123456789"), out);
	TEST_ASSERT_EQUAL_CHAR('\n', at[19]);
}

static void test_a_trend_is_drawn_in_bars_above_what_is_known(void)
{
	value(ROOM, 1, OWS_Q_GOOD, value_of_double(-8), NULL);
	value(ROOM, 20, OWS_Q_GOOD, value_of_double(8), NULL);
	value(ROOM, 40, OWS_Q_DEVICE, value_of_double(85), NULL);
	value(PUMP, 1, OWS_Q_DEVICE, 1, NULL);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, trend("--since 2m room1"));
	holds(out, "room1 (°C)\n         8 ");
	holds(out, "\n        -8 ");
	/* the least value is an eighth of a line high, the greatest eight lines */
	holds(out, "▁▁▁▁");
	TEST_ASSERT_EQUAL_INT(0, times("█") % 8);
	TEST_ASSERT_GREATER_THAN_INT(8, times("█"));
	holds(out, "  ──");
	holds(out, "─××");
	TEST_ASSERT_EQUAL(CTL_DONE, trend("--since 2m pump"));
	TEST_ASSERT_EQUAL_STRING("pump\n  no good value in that time\n", out);
}

static void test_good_values_are_points_of_the_line_protocol(void)
{
	value(ROOM, 1, OWS_Q_GOOD, value_of_double(-21.125), NULL);
	value(ROOM, 2, OWS_Q_DEVICE, value_of_double(85), NULL);
	value(ROOM, 3, OWS_Q_GOOD, value_of_double(1e-7), NULL);
	value(PUMP, 1, OWS_Q_GOOD, 1, NULL);
	value(STEPS, 1, OWS_Q_GOOD, (INT64_C(1) << 53) + 1, NULL);
	value(LABEL, 1, OWS_Q_GOOD, 0, "a \"b\", \\c=d");
	value(LABEL, 2, OWS_Q_GOOD, 0, "two\nlines");
	value(LABEL, 3, OWS_Q_GOOD, 0, "");
	written();
	caught_ctl.instance = "a=b, c";
	TEST_ASSERT_EQUAL(CTL_DONE, trend("--influx room1 pump steps label"));
	TEST_ASSERT_EQUAL(6, times("\n"));
	has_point("ows,identity=room1,instance=a\\=b\\,\\ c,signal=room1,unit=°C value=-21.125 ");
	has_point("signal=room1,unit=°C value=1e-07 ");
	has_point("signal=pump value=1 ");
	has_point("signal=steps value=9007199254740993,integer=9007199254740993i ");
	has_point("signal=label text=\"a \\\"b\\\", \\\\c=d\" ");
	has_point("signal=label text=\"\" ");
	TEST_ASSERT_NULL(strstr(out, "=85"));
	holds(err, "1 values are left out");
	TEST_ASSERT_EQUAL(CTL_USAGE, trend("--influx --csv room1"));
	TEST_ASSERT_EQUAL(CTL_USAGE, trend("--influx --json room1"));
}

static void test_a_name_that_the_history_has_not_is_answered_with_the_nearest(void)
{
	value(ROOM, 1, OWS_Q_GOOD, value_of_double(1), NULL);
	written();
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv romo1"));
	holds(err, "the history has no signal romo1; did you mean room1?");
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv elephant"));
	holds(err, "the history has no signal elephant\n");
}

static void test_of_a_signal_that_owsd_has_nothing_may_be_written_yet(void)
{
	value(ROOM, 1, OWS_Q_GOOD, value_of_double(1), NULL);
	written();
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv pump"));
	holds(err, "the history has nothing of pump yet: owsd-recorder writes every ten minutes");
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv pumq"));
	holds(err, "the history has no signal pumq; did you mean pump?");
}

static void test_the_past_of_a_signal_that_gave_its_name_to_another_is_not_that_of_the_other(void)
{
	/* room1 was called pump until now, and of the pump nothing is written yet */
	static const struct history_signal before = {"pump", "°C", OWS_DOUBLE,
	                                             0,      2,    "/28.1/temperature"};

	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, &before, 1, begun_ns));
	value(0, 1, OWS_Q_GOOD, value_of_double(21.5), NULL);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, trend("--csv room1"));
	holds(out, "21.5");
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv pump"));
	holds(err, "the history has nothing of pump yet");
}

static void test_a_name_may_have_the_instance_in_front(void)
{
	char asked[120];

	value(ROOM, 1, OWS_Q_GOOD, value_of_double(1), NULL);
	written();
	for (int i = 0; i < 2; i++) {
		snprintf(asked, sizeof(asked), "%s%s__room1", i ? "" : "--csv ",
		         caught_ctl.instance);
		TEST_ASSERT_EQUAL_MESSAGE(CTL_DONE, trend(asked), err);
		holds(out, i ? "room1 (°C)\n" : ",\"room1\",1,");
	}
	TEST_ASSERT_EQUAL(CTL_FAILED, trend("--csv other__room1"));
}

static void test_the_times_of_a_list_can_be_asked_for(void)
{
	char from[40], until[40], asked[120];
	const char *at;

	value(ROOM, 1, OWS_Q_GOOD, value_of_double(1), NULL);
	value(ROOM, 2, OWS_Q_GOOD, value_of_double(2), NULL);
	value(ROOM, 3, OWS_Q_GOOD, value_of_double(3), NULL);
	written();
	TEST_ASSERT_EQUAL(CTL_DONE, trend("--csv --since 5m room1"));
	at = strstr(out, ",\"room1\",2,") - 29;
	snprintf(from, sizeof(from), "%.29s", at);
	at = strstr(out, ",\"room1\",3,") - 29;
	snprintf(until, sizeof(until), "%.29s", at);
	snprintf(asked, sizeof(asked), "--csv -s %s -u %s room1", from, until);
	TEST_ASSERT_EQUAL_MESSAGE(CTL_DONE, trend(asked), err);
	/* the value that held comes first; a time has no more than milliseconds there */
	holds(out, from);
	TEST_ASSERT_NULL_MESSAGE(strstr(out, ",\"room1\",3,"), out);
	TEST_ASSERT_EQUAL(CTL_USAGE, trend("--until 2026-02-30 room1"));
	holds(err, "owsctl: --until 2026-02-30: there is no such day");
	TEST_ASSERT_EQUAL(CTL_USAGE, trend("-u 2200-01-01 room1"));
	holds(err, "owsctl: -u 2200-01-01: only the years 1970 to 2114");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_trend_of_a_directory_that_is_not_there_names_the_option_and_the_key);
	RUN_TEST(test_what_is_in_memory_and_on_disk_is_shown_once);
	RUN_TEST(test_of_the_same_in_a_millisecond_the_newest_are_those_in_memory);
	RUN_TEST(test_one_order_in_which_earlier_boots_come_first);
	RUN_TEST(test_number_patterns_and_span_choose_among_both);
	RUN_TEST(test_of_many_the_last_ones_are_shown);
	RUN_TEST(test_without_owsd_the_disk_is_shown_alone);
	RUN_TEST(test_a_damaged_file_is_named);
	RUN_TEST(test_a_trend_is_drawn_in_bars_above_what_is_known);
	RUN_TEST(test_good_values_are_points_of_the_line_protocol);
	RUN_TEST(test_a_name_that_the_history_has_not_is_answered_with_the_nearest);
	RUN_TEST(test_of_a_signal_that_owsd_has_nothing_may_be_written_yet);
	RUN_TEST(test_the_past_of_a_signal_that_gave_its_name_to_another_is_not_that_of_the_other);
	RUN_TEST(test_a_name_may_have_the_instance_in_front);
	RUN_TEST(test_the_times_of_a_list_can_be_asked_for);
	return UNITY_END();
}
