/* SPDX-License-Identifier: MIT */
/* owsctl journal on an instance without owsd. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"pump", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
};
enum { ROOM = 1, PUMP, LABEL };

static const struct ows_who plc = {
	.serial = 3, .uid = 4294967290u, .pid = 4711, .name = "plc", .person = "Anna"};
static struct instance in;

void setUp(void)
{
	instance_start(&in, "ctljournal", signals, 3);
	caught_begin(in.name);
}

void tearDown(void)
{
	instance_end(&in);
	caught_end();
}

static void alarmed(uint8_t kind, uint8_t event, double after, int64_t age_s)
{
	struct ows_journal_entry entry = {
		.record = ROOM,
		.occurred_ns = ows_now() - age_s * INSTANCE_S,
		.after = value_of_double(after),
		.flags = OWS_JOURNAL_AFTER,
		.kind = kind,
		.event = event,
		.quality = OWS_Q_GOOD,
	};

	image_alarm(&in.image, &entry);
}

static void commanded(uint32_t record, uint8_t reason, int64_t value, const char *text,
                      int64_t age_s)
{
	struct ows_journal_entry entry = {
		.record = record,
		.occurred_ns = ows_now() - age_s * INSTANCE_S,
		.after = value,
		.flags = OWS_JOURNAL_AFTER,
		.kind = reason,
		.quality = OWS_Q_GOOD,
		.who = plc,
	};

	snprintf(entry.text, sizeof(entry.text), "%s", text);
	image_command(&in.image, &entry);
}

static unsigned lines(void)
{
	unsigned n = 0;

	for (const char *at = out; (at = strchr(at, '\n')) != NULL; at++)
		n++;
	return n;
}

static void test_an_empty_journal_has_only_the_titles(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal"));
	TEST_ASSERT_EQUAL_STRING("TIME  NAME  EVENT  VALUE  PROGRAM  USER  FOR  REMARK\n", out);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal --json"));
	TEST_ASSERT_EQUAL_STRING("[]\n", out);
}

static void test_alarms_and_commands_stand_in_the_order_of_time(void)
{
	const char *first, *second, *third, *fourth;

	alarmed(OWS_ALARM_H, OWS_ALARM_RAISED, 31.5, 40);
	alarmed(OWS_ALARM_H, OWS_ALARM_RETURNED, 20, 20);
	commanded(PUMP, OWS_REASON_SET, 1, "", 30);
	commanded(PUMP, OWS_REASON_SAFE, 0, "", 10);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal"));
	first = strstr(out, "  room1  high raised     31.5  -          -           -\n");
	second = strstr(out, "  pump   set              1    plc[4711]  4294967290  Anna\n");
	third = strstr(out, "  room1  high returned   20    -          -           -\n");
	fourth = strstr(out, "  pump   SafeValue        0    plc[4711]  4294967290  Anna\n");
	TEST_ASSERT_TRUE_MESSAGE(first && second && third && fourth, out);
	TEST_ASSERT_TRUE_MESSAGE(first < second && second < third && third < fourth, out);
}

static void test_patterns_and_a_number_choose_the_entries(void)
{
	for (int i = 0; i < 9; i++)
		commanded(i % 3 ? PUMP : LABEL, OWS_REASON_SET, i % 2, "x", 20 - i);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal pu*"));
	TEST_ASSERT_EQUAL(7, lines());
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal -c 2 pump"));
	TEST_ASSERT_EQUAL(3, lines());
	holds(out, "  pump  set        0  plc");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal -c 0"));
	TEST_ASSERT_EQUAL(1, lines());
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_journal, "journal -c many"));
	holds(err, "-c wants a number of entries, not many");
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_journal, "journal nothing"));
	holds(err, "there is no nothing");
}

static void test_what_strangers_wrote_steers_no_terminal(void)
{
	struct ows_journal_entry entry = {
		.record = LABEL,
		.occurred_ns = ows_now(),
		.kind = OWS_REASON_SET,
		.more = 3,
		.text = "\33[2J\"x\"",
		.who = {.serial = 9,
	                .pid = 1,
	                .name = "a\33b",
	                .person = "\x9b"
	                          "2J"},
	};

	memset(entry.who.person + 3, 'p', sizeof(entry.who.person) - 3);
	image_command(&in.image, &entry);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal"));
	TEST_ASSERT_NULL(strpbrk(out, "\33\x9b"));
	holds(out, "  label  set    ?[2J\"x\"  a?b[1]   root  ?2Jppp");
	holds(out, "  after 3 more\n");
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal --json"));
	holds(out, "\"value\":\"\\u001b[2J\\\"x\\\"\",\"by\":{\"program\":\"a\\u001bb\",\"pid\":1,"
	           "\"uid\":0,\"user\":\"root\",\"person\":\"\xef\xbf\xbd"
	           "2Jppp");
}

static void test_every_member_is_in_the_json(void)
{
	alarmed(OWS_ALARM_H, OWS_ALARM_RAISED, 31.5, 2);
	commanded(PUMP, OWS_REASON_SET, 1, "", 1);
	TEST_ASSERT_EQUAL(CTL_DONE, run(verb_journal, "journal --json"));
	holds(out,
	      "\"journal\":\"alarms\",\"number\":0,\"name\":\"room1\",\"alarm\":\"high\",\"event\":"
	      "\"raised\",\"value\":31.5,\"before\":null,\"after\":31.5,\"quality\":\"good\",\"by\":null,\"more\":0,\"remark\":null},");
	holds(out,
	      "\"journal\":\"commands\",\"number\":0,\"name\":\"pump\",\"alarm\":null,\"event\":"
	      "\"set\",\"value\":true,\"by\":{\"program\":\"plc\",\"pid\":4711,"
	      "\"uid\":4294967290,\"user\":\"4294967290\",\"person\":\"Anna\"},\"more\":0,"
	      "\"remark\":null}]\n");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_empty_journal_has_only_the_titles);
	RUN_TEST(test_alarms_and_commands_stand_in_the_order_of_time);
	RUN_TEST(test_patterns_and_a_number_choose_the_entries);
	RUN_TEST(test_what_strangers_wrote_steers_no_terminal);
	RUN_TEST(test_every_member_is_in_the_json);
	return UNITY_END();
}
