/* SPDX-License-Identifier: MIT */
/* Tests of alarms and commands as events of history. */
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/history/recorder/series.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_an_alarm_is_whole(void)
{
	struct ows_alarm alarm = {.signal = 3,
	                          .type = OWS_DOUBLE,
	                          .quality = OWS_Q_GOOD,
	                          .kind = OWS_ALARM_H,
	                          .event = OWS_ALARM_RAISED,
	                          .has_after = 1,
	                          .after = 31.5,
	                          .before = 7,
	                          .occurred_ns = 12345,
	                          .text = "why",
	                          .who = {.serial = 7, .uid = 1000, .pid = 42, .name = "plc"}};
	struct history_event event = entries_alarm(&alarm);

	TEST_ASSERT_EQUAL_INT(OWS_HISTORY_ALARM, event.kind);
	TEST_ASSERT_EQUAL_INT(OWS_ALARM_H, event.reason);
	TEST_ASSERT_EQUAL_INT(OWS_ALARM_RAISED, event.event);
	TEST_ASSERT_TRUE(event.has_value && !event.has_before);
	TEST_ASSERT_EQUAL_DOUBLE(31.5, value_number(OWS_DOUBLE, event.value));
	TEST_ASSERT_EQUAL_INT64(12345, event.time_ns);
	TEST_ASSERT_EQUAL_UINT32(3, event.signal);
	TEST_ASSERT_EQUAL_STRING("why", event.text);
	TEST_ASSERT_EQUAL_STRING("plc", event.who.name);
	TEST_ASSERT_EQUAL_INT(42, event.who.pid);
}

/* A text that was commanded stands in the text alone. */
static void test_a_command_has_its_number_or_its_text(void)
{
	struct ows_commanded command = {.type = OWS_LARGE,
	                                .reason = OWS_REASON_SET,
	                                .integer = (INT64_C(1) << 53) + 1,
	                                .taken_ns = 5};
	struct history_event event = entries_command(&command);

	TEST_ASSERT_EQUAL_INT(OWS_HISTORY_COMMAND, event.kind);
	TEST_ASSERT_TRUE(event.has_value);
	TEST_ASSERT_EQUAL_INT64((INT64_C(1) << 53) + 1, event.value);
	TEST_ASSERT_EQUAL_UINT32(0, event.who.serial);
	command.type = OWS_STRING;
	memset(command.text, 'x', sizeof(command.text) - 1);
	event = entries_command(&command);
	TEST_ASSERT_FALSE(event.has_value);
	TEST_ASSERT_TRUE(strlen(event.text) > 0 && strlen(event.text) < sizeof(event.text));
}

static void test_no_value_reaches_back_into_a_gap(void)
{
	struct series rows = {.since_ns = 100};
	struct ows_value v = {.quality = OWS_Q_GOOD, .measured_ns = 90};

	TEST_ASSERT_EQUAL_INT64(100, series_time(&rows, &v, 200));
	v.measured_ns = 110;
	TEST_ASSERT_EQUAL_INT64(110, series_time(&rows, &v, 200));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_alarm_is_whole);
	RUN_TEST(test_a_command_has_its_number_or_its_text);
	RUN_TEST(test_no_value_reaches_back_into_a_gap);
	return UNITY_END();
}
