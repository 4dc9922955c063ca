/* SPDX-License-Identifier: MIT */
/*
 * Limit alarms in the engine: what they do to attributes and journal, and by whom they are woken.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define T2 "/28.000000000002/temperature"
#define RELAY "/29.000000000003/PIO.BYTE"

static struct scene s;
static struct config_item *room;

void setUp(void)
{
	scene_init(&s);
	room = scene_input(&s, "room", T1, OWS_DOUBLE);
	room->limits = (struct config_limits){
		.any = true,
		.has = {[CONFIG_LIMIT_H] = true, [CONFIG_LIMIT_HH] = true},
		.limit = {[CONFIG_LIMIT_H] = 30, [CONFIG_LIMIT_HH] = 40},
	};
	scene_put(&s, T1, "20", 0);
}

void tearDown(void)
{
	scene_end(&s);
}

static void start(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 300 * SCENE_MS);
}

static void measure(const char *text)
{
	scene_put(&s, T1, text, 0);
	scene_run(&s, 200 * SCENE_MS);
}

static uint32_t entered(void)
{
	return s.image.header->alarm_head;
}

static const struct ows_journal_entry *last(void)
{
	TEST_ASSERT_GREATER_THAN(0, entered());
	return &s.image.alarms[(entered() - 1) % OWS_JOURNAL];
}

static void expect(enum ows_limit_state state, uint8_t kind)
{
	TEST_ASSERT_EQUAL(state, scene_attrs(&s, 1).limit_state);
	TEST_ASSERT_EQUAL(kind, scene_attrs(&s, 1).limit_condition);
}

static void expect_last(uint8_t event, uint8_t kind)
{
	TEST_ASSERT_EQUAL(event, last()->event);
	TEST_ASSERT_EQUAL(kind, last()->kind);
	TEST_ASSERT_EQUAL(1, last()->record);
}

static void acknowledge(unsigned record)
{
	scene_slot(&s, record)->acknowledged++;
	scene_ring(&s, record);
	scene_run(&s, SCENE_MS);
}

static void test_a_signal_says_whether_it_has_limit_alarms(void)
{
	scene_input(&s, "other", T2, OWS_DOUBLE);
	scene_put(&s, T2, "99", 0);
	start();
	TEST_ASSERT_TRUE(scene_attrs(&s, 1).flags & OWS_ATTR_LIMITS);
	TEST_ASSERT_FALSE(scene_attrs(&s, 2).flags & OWS_ATTR_LIMITS);
	TEST_ASSERT_EQUAL(0, entered());
}

static void test_a_value_beyond_its_limit_enters_the_journal_with_both_values(void)
{
	start();
	measure("31");
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(1, entered());
	expect_last(OWS_ALARM_RAISED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(OWS_JOURNAL_BEFORE | OWS_JOURNAL_AFTER, last()->flags);
	TEST_ASSERT_EQUAL_DOUBLE(20, value_number(OWS_DOUBLE, last()->before));
	TEST_ASSERT_EQUAL_DOUBLE(31, value_number(OWS_DOUBLE, last()->after));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, last()->quality);
	TEST_ASSERT_TRUE(s.now_ns - last()->occurred_ns < SCENE_S);
	measure("20");
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_H);
	expect_last(OWS_ALARM_RETURNED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(2, entered());
}

static void test_the_first_value_has_none_before_it(void)
{
	scene_put(&s, T1, "31", 0);
	start();
	expect_last(OWS_ALARM_RAISED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(OWS_JOURNAL_AFTER, last()->flags);
}

static void test_an_alarm_that_is_acknowledged_goes_to_normal_when_it_returns(void)
{
	start();
	measure("31");
	acknowledge(1);
	expect(OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H);
	expect_last(OWS_ALARM_ACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(0, last()->flags);
	measure("20");
	expect(OWS_LIMIT_NORMAL, 0);
}

static void test_nothing_to_acknowledge_enters_nothing(void)
{
	scene_input(&s, "other", T2, OWS_DOUBLE);
	scene_put(&s, T2, "99", 0);
	start();
	acknowledge(1);
	acknowledge(2);
	acknowledge(0);
	TEST_ASSERT_EQUAL(0, entered());
	expect(OWS_LIMIT_NORMAL, 0);
}

static void test_a_command_alone_acknowledges_nothing(void)
{
	start();
	measure("31");
	scene_ring(&s, 1);
	scene_run(&s, SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
}

static void test_an_on_delay_ends_without_a_new_value(void)
{
	room->limits.on_delay_ns = 5 * SCENE_S;
	room->per_factor = 1000;
	scene_put(&s, T1, "31", 0);
	start();
	scene_run(&s, 4500 * SCENE_MS);
	expect(OWS_LIMIT_NORMAL, 0);
	TEST_ASSERT_EQUAL_UINT(1, s.reads);
	scene_run(&s, 500 * SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL_UINT(1, s.reads);
}

static void test_an_off_delay_ends_without_a_new_value(void)
{
	room->limits.off_delay_ns = 5 * SCENE_S;
	room->per_factor = 20;
	scene_put(&s, T1, "31", 0);
	start();
	scene_put(&s, T1, "20", 0);
	scene_run(&s, 2 * SCENE_S);
	room->per_factor = 1000;
	scene_run(&s, 2 * SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	scene_run(&s, 4 * SCENE_S);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_H);
}

static void test_a_signal_that_goes_stale_raises_an_alarm_by_itself(void)
{
	room->stale_after_ns = 3 * SCENE_S;
	room->per_factor = 40;
	start();
	scene_run(&s, 2500 * SCENE_MS);
	expect(OWS_LIMIT_NORMAL, 0);
	scene_run(&s, 400 * SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_STALE);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_STALE);
}

static void test_a_signal_never_read_goes_stale_after_the_start(void)
{
	room->stale_after_ns = 3 * SCENE_S;
	scene_start(&s);
	scene_run(&s, 2900 * SCENE_MS);
	expect(OWS_LIMIT_NORMAL, 0);
	scene_run(&s, 300 * SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_STALE);
}

static void test_an_absent_device_is_a_bad_alarm(void)
{
	start();
	measure("31");
	scene_put(&s, T1, NULL, -ENODEV);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_BAD);
	expect_last(OWS_ALARM_RAISED, OWS_ALARM_BAD);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, last()->quality);
	scene_put(&s, T1, "31", 0);
	scene_run(&s, 3 * SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	expect_last(OWS_ALARM_RETURNED, OWS_ALARM_BAD);
}

static void test_a_target_that_goes_down_is_a_bad_alarm(void)
{
	start();
	scene_down(&s, -ECONNREFUSED);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_BAD);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, last()->quality);
}

static void test_a_signal_that_is_not_read_keeps_its_alarm(void)
{
	start();
	measure("31");
	scene_enable_reads(&s, 1, false);
	scene_put(&s, T1, "20", 0);
	scene_run(&s, 10 * SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H);
	scene_enable_reads(&s, 1, true);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_RETURNED, OWS_ALARM_H);
}

static void test_an_output_has_limit_alarms_of_what_was_written(void)
{
	struct config_item *relay = scene_output(&s, "relay", RELAY, OWS_BYTE);

	relay->limits = (struct config_limits){
		.any = true, .has = {[CONFIG_LIMIT_H] = true}, .limit = {[CONFIG_LIMIT_H] = 8}};
	scene_put(&s, RELAY, "0", 0);
	start();
	scene_set(&s, 2, 8);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, 2).limit_state);
	TEST_ASSERT_EQUAL(2, last()->record);
}

static void test_a_limit_alarm_is_no_alarm_of_the_device(void)
{
	start();
	measure("41");
	TEST_ASSERT_EQUAL(0, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_FALSE(scene_attrs(&s, 1).flags & OWS_ATTR_ALARM_STANDS);
}

static void test_words_of_acknowledgement_overwritten_with_rubbish_do_no_harm(void)
{
	start();
	measure("31");
	scene_slot(&s, 0)->acknowledged = scene_slot(&s, 1)->acknowledged = 0xffffffffu;
	scene_ring(&s, 0);
	scene_ring(&s, 1);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_ACKNOWLEDGED, OWS_ALARM_H);
	TEST_ASSERT_EQUAL(2, entered());
}

/* Values that go up and down all the time; the log speaks of that now and then only. */
static void test_the_log_has_the_return_of_each_alarm_whose_begin_it_has(void)
{
	static char said[65536];
	unsigned raised = 0, returned = 0;
	FILE *out = tmpfile();

	TEST_ASSERT_NOT_NULL(out);
	s.log = log_create(LOG_LEVEL_NOTICE);
	start();
	for (int i = 0; i < 40; i++) {
		scene_put(&s, T1, i % 2 ? "20" : i % 3 ? "35" : "45", 0);
		scene_run(&s, 2 * SCENE_S);
		log_drain(s.log, fileno(out), 0);
	}
	ssize_t n = pread(fileno(out), said, sizeof(said) - 1, 0);
	TEST_ASSERT_GREATER_THAN(0, n);
	said[n] = '\0';
	for (const char *at = said; (at = strstr(at, "room: alarm: ")) != NULL; at++) {
		const char *end = strchr(at, '\n');
		bool over = memmem(at, (size_t)(end - at), "returned to normal", 18);

		raised += !over;
		returned += over;
		TEST_ASSERT_EQUAL_UINT_MESSAGE(returned + !over, raised, said);
	}
	TEST_ASSERT_GREATER_THAN_UINT(3, raised);
	TEST_ASSERT_LESS_THAN_UINT(20, raised);
	TEST_ASSERT_EQUAL_UINT(raised, returned);
	struct log *log = s.log;
	scene_end(&s);
	log_destroy(log);
	fclose(out);
	scene_init(&s);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_signal_says_whether_it_has_limit_alarms);
	RUN_TEST(test_a_value_beyond_its_limit_enters_the_journal_with_both_values);
	RUN_TEST(test_the_first_value_has_none_before_it);
	RUN_TEST(test_an_alarm_that_is_acknowledged_goes_to_normal_when_it_returns);
	RUN_TEST(test_nothing_to_acknowledge_enters_nothing);
	RUN_TEST(test_a_command_alone_acknowledges_nothing);
	RUN_TEST(test_an_on_delay_ends_without_a_new_value);
	RUN_TEST(test_an_off_delay_ends_without_a_new_value);
	RUN_TEST(test_a_signal_that_goes_stale_raises_an_alarm_by_itself);
	RUN_TEST(test_a_signal_never_read_goes_stale_after_the_start);
	RUN_TEST(test_an_absent_device_is_a_bad_alarm);
	RUN_TEST(test_a_target_that_goes_down_is_a_bad_alarm);
	RUN_TEST(test_a_signal_that_is_not_read_keeps_its_alarm);
	RUN_TEST(test_an_output_has_limit_alarms_of_what_was_written);
	RUN_TEST(test_a_limit_alarm_is_no_alarm_of_the_device);
	RUN_TEST(test_words_of_acknowledgement_overwritten_with_rubbish_do_no_harm);
	RUN_TEST(test_the_log_has_the_return_of_each_alarm_whose_begin_it_has);
	return UNITY_END();
}
