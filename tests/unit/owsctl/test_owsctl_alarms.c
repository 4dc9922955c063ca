/* SPDX-License-Identifier: MIT */
/* owsctl alarms on an instance without owsd. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/futex.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"door", "/29.1/sensed.BYTE", OWS_BYTE, false, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
	{"boiler", "/28.2/temperature", OWS_DOUBLE, false, 0},
};
enum { ROOM = 1, DOOR, LABEL, BOILER };

static struct instance in;

void setUp(void)
{
	instance_start(&in, "alarms", signals, 4);
	caught_begin(in.name);
}

void tearDown(void)
{
	instance_end(&in);
	caught_end();
}

static void publish(uint32_t record, double value, uint32_t flags, uint8_t state, uint8_t kind)
{
	struct ows_sample sample = {
		.value = record == DOOR ? (int64_t)value : value_of_double(value),
		.measured_ns = ows_now(),
		.quality = OWS_Q_GOOD,
		.count = 1,
	};
	struct ows_attrs attrs = {
		.alarms = 4, .flags = flags, .limit_state = state, .limit_condition = kind};

	image_publish(&in.image, record, &sample, &attrs, NULL);
	image_news(&in.image);
}

static void enter(uint32_t record, uint8_t kind, uint8_t event, int64_t age_s)
{
	struct ows_journal_entry entry = {
		.record = record,
		.occurred_ns = ows_now() - age_s * INSTANCE_S,
		.kind = kind,
		.event = event,
		.quality = OWS_Q_GOOD,
	};

	image_alarm(&in.image, &entry);
}

static void test_without_alarms_there_are_only_the_titles(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	TEST_ASSERT_EQUAL_STRING("NAME  ALARM  STATE  SINCE  VALUE  QUALITY\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json"));
	TEST_ASSERT_EQUAL_STRING("[]\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms history --json"));
	TEST_ASSERT_EQUAL_STRING("[]\n", out);
}

static void test_what_nobody_measured_is_no_value(void)
{
	struct ows_sample sample = {.value = 5, .quality = OWS_Q_NO_DEVICE, .err = -ENODEV};
	struct ows_attrs attrs = {.flags = OWS_ATTR_ALARM_UNARMED |
	                                   (OWS_UNARMED_NO_POR - 1) << OWS_ATTR_ALARM_WHY_SHIFT};

	image_publish(&in.image, DOOR, &sample, &attrs, NULL);
	run(verb_alarms, "alarms");
	holds(out, "-      -  device absent\n");
}

static void test_why_an_alarm_cannot_be_armed_names_the_key_and_stands_below_the_table(void)
{
	static const struct {
		int error;
		enum ows_unarmed unarmed;
		const char *why;
	} rows[] = {
		{-EACCES, OWS_UNARMED_SET, "cannot be armed: SetAlarm cannot be written"},
		{-EACCES, OWS_UNARMED_POR, "cannot be armed: PorAlarm cannot be written"},
		{-EUCLEAN, OWS_UNARMED_POR,
	         "cannot be armed: PorAlarm is still set after 0 was written"},
		{-EBADRQC, OWS_UNARMED_SET,
	         "cannot be armed: SetAlarm is not defined, or has no '='"},
		{-EBADMSG, OWS_UNARMED_SET, "cannot be armed: SetAlarm: wrong checksum"},
		{-EACCES, OWS_UNARMED_LATCH, "cannot be read: LatchAlarm cannot be read"},
		{-EACCES, OWS_UNARMED_POR_READ, "cannot be read: PorAlarm cannot be read"},
		{-ENOENT, OWS_UNARMED_RESET, "cannot be reset: ResetLatch: no such property"},
		{0, OWS_UNARMED_NO_POR, "can do nothing: PorAlarm is not defined"},
		{0, OWS_UNARMED_NO_LATCH, "can do nothing: LatchAlarm is not defined, or empty"},
		{0, OWS_UNARMED_STAYS, "not cleared by ResetLatch: the latch stays set"},
	};
	char line[128], *end;

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct ows_sample sample = {.value = 5,
		                            .measured_ns = ows_now(),
		                            .quality = OWS_Q_GOOD,
		                            .count = 1,
		                            .err = rows[i].error};
		struct ows_attrs attrs = {.flags = OWS_ATTR_ALARM_UNARMED |
		                                   (rows[i].unarmed - 1)
		                                           << OWS_ATTR_ALARM_WHY_SHIFT};

		image_publish(&in.image, DOOR, &sample, &attrs, NULL);
		image_news(&in.image);
		TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
		snprintf(line, sizeof(line), "\ndoor: %s\n", rows[i].why);
		holds(out, line);
		for (const char *at = out; *at; at = end + 1) {
			end = strchr(at, '\n');
			TEST_ASSERT_LESS_OR_EQUAL(80, end - at);
		}
		TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json"));
		holds(out, rows[i].why);
		TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms room1"));
		TEST_ASSERT_NULL(strstr(out, "door"));
	}
}

static void test_an_output_that_reads_otherwise_stands_in_the_table(void)
{
	struct ows_sample sample = {
		.value = 5, .measured_ns = ows_now(), .quality = OWS_Q_DIFFERS, .count = 1};

	image_publish(&in.image, DOOR, &sample, &(struct ows_attrs){0}, NULL);
	image_news(&in.image);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	holds(out, "\ndoor  not as commanded  stands ");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json"));
	holds(out, "{\"name\":\"door\",\"alarm\":\"not as commanded\",\"state\":\"stands\",");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms room1"));
	TEST_ASSERT_NULL(strstr(out, "door"));
}

static void test_a_word_that_no_signal_matches_is_refused(void)
{
	static const struct {
		const char *line, *why;
	} wrong[] = {
		{"alarms histroy", "owsctl: there is no histroy; did you mean alarms history?\n"},
		{"alarms akc", "owsctl: there is no akc; did you mean alarms ack?\n"},
		{"alarms bogus", "owsctl: there is no bogus: owsctl list shows the names\n"},
		{"alarms room", "owsctl: there is no room; did you mean room1?\n"},
		{"alarms room1 zzz*", "owsctl: no signal matches zzz*\n"},
		{"alarms history boilr", "owsctl: there is no boilr; did you mean boiler?\n"},
		{"alarms history nothing --json",
	         "owsctl: there is no nothing: owsctl list shows the names\n"},
	};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		TEST_ASSERT_EQUAL_MESSAGE(CTL_FAILED, run(verb_alarms, wrong[i].line),
		                          wrong[i].line);
		TEST_ASSERT_EQUAL_STRING(wrong[i].why, err);
		TEST_ASSERT_EQUAL_STRING("", out);
	}
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms room1"));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms history ro*"));
}

static void test_alarms_that_stand_are_shown_with_the_time_they_were_raised(void)
{
	publish(ROOM, 31.5, OWS_ATTR_LIMITS, OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	publish(DOOR, 5, OWS_ATTR_ALARM_STANDS, 0, 0);
	enter(ROOM, OWS_ALARM_H, OWS_ALARM_RAISED, 9999);
	enter(ROOM, OWS_ALARM_H, OWS_ALARM_RAISED, 300);
	enter(DOOR, OWS_ALARM_DEVICE, OWS_ALARM_RAISED, 60);
	enter(DOOR, OWS_ALARM_POR, OWS_ALARM_RAISED, 20);
	enter(ROOM, OWS_ALARM_HH, OWS_ALARM_RETURNED, 5);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	TEST_ASSERT_EQUAL_STRING("NAME   ALARM   STATE           SINCE  VALUE  QUALITY\n"
	                         "room1  high    unacknowledged     5m   31.5  good\n"
	                         "door   device  stands            60s    5    good\n",
	                         out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms d*"));
	TEST_ASSERT_NULL(strstr(out, "room1"));
	holds(out, "door");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json door"));
	holds(out, "[{\"name\":\"door\",\"alarm\":\"device\",\"state\":\"stands\",\"device\":true,"
	           "\"polled\":false,\"since\":\"");
	holds(out, "\"occurrences\":4,\"value\":5,");
}

static void test_an_item_that_is_read_as_an_input_says_so(void)
{
	publish(DOOR, 5, OWS_ATTR_ALARM_POLLED, 0, 0);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	holds(out, "door  device  no alarm search there: read as an input      -      5  good\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json"));
	holds(out, "\"polled\":true,\"since\":null,");
}

static void test_device_and_limit_alarm_of_one_signal_are_two_lines(void)
{
	publish(DOOR, 9, OWS_ATTR_ALARM_STANDS | OWS_ATTR_LIMITS, OWS_LIMIT_RETURNED, OWS_ALARM_LL);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	holds(out, "door  device   stands                                 -      9  good\n");
	holds(out, "door  low low  returned to normal unacknowledged      -      9  good\n");
}

static void test_history_shows_what_was_entered_in_its_order(void)
{
	struct ows_journal_entry entry = {
		.record = DOOR,
		.occurred_ns = ows_now(),
		.before = 3,
		.after = 7,
		.kind = OWS_ALARM_DEVICE,
		.event = OWS_ALARM_RAISED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE | OWS_JOURNAL_AFTER,
		.text = "0,\33[2J0,1",
	};
	char *first, *second;

	image_alarm(&in.image, &entry);
	enter(LABEL, OWS_ALARM_POR, OWS_ALARM_RAISED, 0);
	enter(BOILER, OWS_ALARM_BAD, OWS_ALARM_ACKNOWLEDGED, 0);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms history"));
	holds(out, "  NAME    EVENT                  VALUE  PROGRAM  USER  FOR  REMARK\n");
	first = strstr(out,
	               "  door    device raised              7  -        -     -    0,?[2J0,1\n");
	second = strstr(out, "  boiler  bad acknowledged           -  owsd     -     -\n");
	TEST_ASSERT_TRUE(first && second && first < second);
	holds(out, "  label   power-on reset raised      -  -        -     -\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms history --json do* bo*"));
	holds(out, "\"journal\":\"alarms\",\"number\":0,\"name\":\"door\",\"alarm\":\"device\","
	           "\"event\":\"raised\",\"value\":7,\"before\":3,\"after\":7,\"quality\":\"good\","
	           "\"by\":null,\"more\":0,\"remark\":\"0,\\u001b[2J0,1\"},{\"time\":");
	holds(out, "\"before\":null,\"after\":null,\"quality\":\"good\",\"by\":null,\"more\":0,"
	           "\"remark\":null}]\n");
}

static void test_history_shows_what_the_ring_keeps(void)
{
	const char *line;
	int lines = 0;

	for (int i = 0; i < OWS_JOURNAL + 10; i++)
		enter(ROOM, OWS_ALARM_H, OWS_ALARM_RAISED, 0);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms history"));
	for (line = out; (line = strchr(line, '\n')) != NULL; line++)
		lines++;
	TEST_ASSERT_EQUAL(OWS_JOURNAL + 1, lines);
}

static void test_a_shelved_alarm_is_shown_with_who_and_why(void)
{
	struct ows_sample sample = {
		.value = value_of_double(31), .measured_ns = ows_now(), .quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {
		.flags = OWS_ATTR_LIMITS, .limit_condition = OWS_ALARM_H, .shelved = 1};
	struct ows_shelf_entry shelf = {
		.record = ROOM,
		.since_ns = ows_now() - 60 * INSTANCE_S,
		.until_ns = ows_now() + 3600 * INSTANCE_S,
		.who = {.serial = 3,
	                .uid = 4294967290u,
	                .pid = 42,
	                .name = "p\33c",
	                .person = "Anna"},
		.why = "moved \"\33[2J\"",
	};

	image_publish(&in.image, ROOM, &sample, &attrs, NULL);
	image_shelf(&in.image, 5, &shelf);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms"));
	holds(out, "room1  high   shelved    60s     31  good\n");
	holds(out, "\nroom1: shelved until ");
	holds(out, " by p?c[42] (user 4294967290) for Anna: moved \"?[2J\"\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms --json"));
	holds(out, "\"alarm\":\"high\",\"state\":\"shelved\"");
	holds(out, "\"by\":{\"program\":\"p\\u001bc\",\"pid\":42,\"uid\":4294967290,\"user\":"
	           "\"4294967290\",\"person\":\"Anna\"},\"why\":\"moved \\\"\\u001b[2J\\\"\"");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list room1"));
	holds(out, "high, shelved");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_list, "list --json room1"));
	holds(out, "\"alarms\":[],\"shelved\":true");
}

/* owsd's part: takes acknowledgements of what is published as it would. */
static void *take(void *arg)
{
	unsigned before = *(unsigned *)arg;

	for (int i = 0; i < 60000; i++) {
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
		if (instance_controllers(&in) == before ||
		    !instance_slot(&in, before, ROOM)->acknowledged)
			continue;
		publish(ROOM, 31.5, OWS_ATTR_LIMITS, OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H);
		segment_wake(&in.image.header->news, 100);
		break;
	}
	return NULL;
}

static void acknowledges(const char *words)
{
	unsigned before = instance_controllers(&in);
	pthread_t thread;

	publish(ROOM, 31.5, OWS_ATTR_LIMITS, OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, take, &before));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, words));
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL_STRING("", out);
	TEST_ASSERT_EQUAL_STRING("", err);
}

/* Acknowledgements of all owsctl that ran. */
static uint32_t acknowledged(uint32_t record)
{
	uint32_t count = 0;

	for (unsigned i = 0; i < instance_controllers(&in); i++)
		count += instance_slot(&in, i, record)->acknowledged;
	return count;
}

static void test_ack_waits_until_owsd_took_it(void)
{
	acknowledges("alarms ack room1");
	TEST_ASSERT_EQUAL(1, acknowledged(ROOM));
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_alarms, "alarms ack room1"));
	TEST_ASSERT_EQUAL(1, acknowledged(ROOM));
}

static void test_ack_of_all_takes_those_that_need_it(void)
{
	publish(BOILER, 20, OWS_ATTR_LIMITS, OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_L);
	acknowledges("alarms ack --all");
	TEST_ASSERT_EQUAL(1, acknowledged(ROOM));
	TEST_ASSERT_EQUAL(0, acknowledged(DOOR));
	TEST_ASSERT_EQUAL(0, acknowledged(BOILER));
}

static void test_ack_acknowledges_nothing_when_one_name_is_wrong(void)
{
	publish(ROOM, 31.5, OWS_ATTR_LIMITS, OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_alarms, "alarms ack room1 rom1 door _RECONNECTS"));
	holds(err, "there is no rom1; did you mean room1?");
	holds(err, "door has no limit alarms");
	holds(err, "_RECONNECTS has no limit alarms");
	TEST_ASSERT_EQUAL(0, acknowledged(ROOM));
}

static void test_ack_needs_an_owsd_that_lives(void)
{
	publish(ROOM, 31.5, OWS_ATTR_LIMITS, OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	instance_beat(&in, ows_now() - 60 * INSTANCE_S, 0);
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_alarms, "alarms ack room1"));
	holds(err, "is not running");
	TEST_ASSERT_EQUAL(0, acknowledged(ROOM));
}

static void test_ack_takes_names_or_all(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_alarms, "alarms ack"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_alarms, "alarms ack --all room1"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_alarms, "alarms --all"));
	holds(err, "unknown option: --all");
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_alarms, "alarms history -x"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_alarms_there_are_only_the_titles);
	RUN_TEST(test_what_nobody_measured_is_no_value);
	RUN_TEST(test_why_an_alarm_cannot_be_armed_names_the_key_and_stands_below_the_table);
	RUN_TEST(test_an_output_that_reads_otherwise_stands_in_the_table);
	RUN_TEST(test_a_word_that_no_signal_matches_is_refused);
	RUN_TEST(test_alarms_that_stand_are_shown_with_the_time_they_were_raised);
	RUN_TEST(test_an_item_that_is_read_as_an_input_says_so);
	RUN_TEST(test_device_and_limit_alarm_of_one_signal_are_two_lines);
	RUN_TEST(test_history_shows_what_was_entered_in_its_order);
	RUN_TEST(test_history_shows_what_the_ring_keeps);
	RUN_TEST(test_a_shelved_alarm_is_shown_with_who_and_why);
	RUN_TEST(test_ack_waits_until_owsd_took_it);
	RUN_TEST(test_ack_of_all_takes_those_that_need_it);
	RUN_TEST(test_ack_acknowledges_nothing_when_one_name_is_wrong);
	RUN_TEST(test_ack_needs_an_owsd_that_lives);
	RUN_TEST(test_ack_takes_names_or_all);
	return UNITY_END();
}
