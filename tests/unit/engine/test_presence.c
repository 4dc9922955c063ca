/* SPDX-License-Identifier: MIT */
/*
 * Presence belongs to the device: however its loss and its return are found, they count for all its
 * signals, also for those that are read seldom or never.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

#define D "/29.B89115000000"
#define ROW 1   /* the signal under test */
#define PLAIN 2 /* one of the same device that is read in each period */

static struct scene s;
static char message[80];

enum kind { BY_ALARM, SELDOM_READ, NOT_READ_BACK, INIT_VALUE, KINDS };
static const char *const kinds[] = {"alarm item", "PerFactor 1000", "ReadBack 0", "InitValue"};
enum how { BY_SEARCH, BY_SIGNAL, ALONE, HOWS };
static const char *const hows[] = {"search", "another signal", "alone"};

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

static struct config_item *alarm_on(struct config_item *item)
{
	item->alarm = true;
	item->latch_alarm = "latch.BYTE";
	item->por_alarm = "por";
	item->reset_latch = "latch.BYTE=0";
	return item;
}

static void add_row(enum kind kind)
{
	struct config_item *item;

	if (kind == BY_ALARM) {
		alarm_on(scene_input(&s, "row", D "/sensed.BYTE", OWS_BYTE));
	} else if (kind == SELDOM_READ) {
		scene_input(&s, "row", D "/sensed.BYTE", OWS_BYTE)->per_factor = 1000;
	} else {
		item = scene_output(&s, "row", D "/PIO.BYTE", OWS_BYTE);
		item->has_init = kind == INIT_VALUE;
		item->init_value = 6;
		item->init_text = "6";
	}
}

static void begin(enum kind kind, enum how how)
{
	snprintf(message, sizeof(message), "%s, found by %s", kinds[kind], hows[how]);
	add_row(kind);
	if (how == BY_SIGNAL)
		scene_input(&s, "plain", D "/sensed.0", OWS_BYTE)->fresh = true;
	scene_put(&s, D "/sensed.BYTE", "255", 0);
	scene_put(&s, D "/sensed.0", "1", 0);
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	scene_put(&s, D "/latch.BYTE", "0", 0);
	scene_put(&s, D "/por", "0", 0);
	scene_put(&s, "/alarm", "", 0);
	s.bus[0].searches = s.bus[0].brief = how == BY_SEARCH;
	scene_start(&s);
	scene_up(&s);
	if (kind == NOT_READ_BACK)
		scene_set(&s, ROW, 6);
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
}

/* The time until the row has that quality; at most 100 s. */
static int64_t until(uint8_t quality)
{
	int64_t from = s.now_ns;

	while (scene_sample(&s, ROW).quality != quality && s.now_ns < from + 100 * SCENE_S)
		scene_run(&s, 10 * SCENE_MS);
	return s.now_ns - from;
}

static void goes_and_comes(enum kind kind, enum how how)
{
	begin(kind, how);
	scene_unplug(&s, D, true);
	if (how == BY_SEARCH) {
		scene_run(&s, 500 * SCENE_MS);
		scene_tell(&s, 0, BUS_LOST, D "/por");
	}
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(how == ALONE ? 3 * SCENE_S : 600 * SCENE_MS,
	                                    until(OWS_Q_NO_DEVICE), message);
	TEST_ASSERT_EQUAL_INT32_MESSAGE(-ENODEV, scene_sample(&s, ROW).err, message);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_NO_DEVICE, scene_sample(&s, ROW).quality, message);

	scene_unplug(&s, D, false);
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	if (how == BY_SEARCH)
		scene_tell(&s, 0, BUS_FOUND, D "/por");
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(how == BY_SEARCH ? 200 * SCENE_MS : 3 * SCENE_S,
	                                    until(OWS_Q_GOOD), message);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(kind < NOT_READ_BACK ? "0" : "6",
	                                 scene_at(&s, D "/PIO.BYTE"), message);
	TEST_ASSERT_EQUAL_INT32_MESSAGE(0, scene_sample(&s, ROW).err, message);
}

static void test_each_signal_of_a_lost_device_is_bad_and_good_again_when_it_is_back(void)
{
	for (unsigned kind = 0; kind < KINDS; kind++)
		for (unsigned how = 0; how < HOWS; how++) {
			scene_end(&s);
			scene_init(&s);
			goes_and_comes((enum kind)kind, (enum how)how);
		}
}

/* What the wire or another property does to one signal says nothing of the device. */
static void test_a_disturbed_reading_of_one_signal_is_no_absence(void)
{
	static const int errs[] = {-EBADMSG, -EIO, -ENXIO, -ENOENT, -EACCES};

	for (unsigned kind = 0; kind < KINDS; kind++)
		for (unsigned i = 0; i < sizeof(errs) / sizeof(errs[0]); i++) {
			scene_end(&s);
			scene_init(&s);
			begin((enum kind)kind, BY_SIGNAL);
			scene_put(&s, D "/sensed.0", NULL, errs[i]);
			for (unsigned n = 0; n < 100; n++) {
				scene_run(&s, 100 * SCENE_MS);
				TEST_ASSERT_EQUAL_HEX8_MESSAGE(
					OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
			}
			TEST_ASSERT_FALSE(ows_good(scene_sample(&s, PLAIN).quality));
		}
}

/* One look that finds nothing may be a disturbed search. */
static void test_one_look_that_finds_nothing_is_no_absence(void)
{
	begin(NOT_READ_BACK, ALONE);
	while (!s.bus[0].pending_count)
		scene_run(&s, SCENE_MS / 4);
	scene_unplug(&s, D, true);
	scene_run(&s, 150 * SCENE_MS);
	scene_unplug(&s, D, false);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, ROW).quality);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_a_look_that_fails_is_no_absence_and_the_signals_that_are_read_say_why(void)
{
	begin(BY_ALARM, ALONE);
	s.bus[0].probe_err = -ENXIO;
	scene_put(&s, D "/sensed.BYTE", NULL, -ENXIO);
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_TARGET));
	scene_end(&s);
	scene_init(&s);
	begin(NOT_READ_BACK, ALONE);
	s.bus[0].probe_err = -ECOMM;
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, ROW).quality);
}

/* `present` says 0, the id is known without the device: neither brings it back. */
static void test_what_is_answered_without_the_device_does_not_bring_it_back(void)
{
	add_row(NOT_READ_BACK);
	scene_input(&s, "there", D "/present", OWS_BYTE)->fresh = true;
	scene_input(&s, "code", D "/family", OWS_BYTE)->fresh = true;
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	scene_put(&s, D "/present", "1", 0);
	scene_put(&s, D "/family", "29", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, ROW, 6);
	scene_run(&s, 4 * SCENE_S);
	scene_put(&s, D "/PIO.BYTE", "0", -ENODEV);
	scene_put(&s, D "/present", "0", 0);
	s.bus[0].probe_err = -ENODEV;
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_NO_DEVICE));
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, ROW).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "device_returns"));
}

/* It stands in alarm, so it is there, though its item would wait for its next try. */
static void test_a_lost_device_that_is_listed_in_alarm_is_read_at_once(void)
{
	begin(BY_ALARM, ALONE);
	scene_unplug(&s, D, true);
	scene_run(&s, 40 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, ROW).quality);
	scene_unplug(&s, D, false);
	scene_put(&s, "/alarm", "/alarm" D "\n", 0);
	scene_put(&s, D "/por", "1", 0);
	TEST_ASSERT_LESS_THAN_INT64(300 * SCENE_MS, until(OWS_Q_GOOD));
}

/* A device that goes while the machine visits it leaves the list: its item is read then. */
static void test_a_device_lost_in_alarm_is_bad_soon(void)
{
	begin(BY_ALARM, ALONE);
	scene_put(&s, "/alarm", "/alarm" D "\n", 0);
	scene_run(&s, 300 * SCENE_MS);
	scene_unplug(&s, D, true);
	scene_run(&s, 60 * SCENE_MS);
	scene_put(&s, "/alarm", "", 0);
	TEST_ASSERT_LESS_THAN_INT64(600 * SCENE_MS, until(OWS_Q_NO_DEVICE));
}

static void test_an_output_that_is_not_to_be_written_is_not_good_when_its_device_is_back(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_enable_writes(&s, ROW, false);
	scene_unplug(&s, D, true);
	until(OWS_Q_NO_DEVICE);
	scene_unplug(&s, D, false);
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_LAST_USABLE));
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, ROW).quality);
}

/* The first one that is refused has its back-off, as a read has. */
static void test_a_write_to_a_lost_device_is_not_tried_again_at_once(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_unplug(&s, D, true);
	until(OWS_Q_NO_DEVICE);
	s.writes = 0;
	scene_set(&s, ROW, 7);
	scene_run(&s, 900 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(4, s.writes);
	scene_unplug(&s, D, false);
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	until(OWS_Q_GOOD);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, D "/PIO.BYTE"));
}

/* --- What it costs --------------------------------------------------------------------------- */

static void test_a_device_that_is_read_in_each_period_is_not_looked_for(void)
{
	begin(BY_ALARM, BY_SIGNAL);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[0].probes);
}

static void test_a_device_alone_is_looked_for_each_two_seconds(void)
{
	begin(BY_ALARM, ALONE);
	s.bus[0].probes = 0;
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_INT_WITHIN(2, 50, s.bus[0].probes);
	TEST_ASSERT_EQUAL_UINT64(scene_counter(&s, "watches"), s.bus[0].probes + 1);
}

static void test_many_devices_take_ten_looks_a_second_at_the_most(void)
{
	static char path[40][32], name[40][8];

	for (unsigned i = 0; i < 40; i++) {
		snprintf(path[i], sizeof(path[i]), "/29.%012X/sensed.BYTE", i + 1);
		snprintf(name[i], sizeof(name[i]), "in%u", i);
		alarm_on(scene_input(&s, name[i], path[i], OWS_BYTE));
		scene_put(&s, path[i], "255", 0);
	}
	scene_put(&s, "/alarm", "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 20 * SCENE_S);
	s.bus[0].probes = 0;
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_INT_WITHIN(3, 98, s.bus[0].probes);
}

/* Each is looked for less and less often, as a signal of it would be read. */
static void test_a_device_that_stays_away_costs_ever_less(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_unplug(&s, D, true);
	scene_run(&s, 200 * SCENE_S);
	s.bus[0].probes = 0;
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_INT_WITHIN(2, 10, s.bus[0].probes);
}

static void test_a_period_longer_than_two_seconds_is_the_time_between_looks(void)
{
	s.config.period_ns = 10 * SCENE_S;
	begin(NOT_READ_BACK, ALONE);
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_INT_WITHIN(2, 10, s.bus[0].probes);
}

/* It was away for long, and another sign than a look has brought it back. */
static void test_a_device_that_is_back_is_looked_for_as_often_as_before(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_unplug(&s, D, true);
	scene_run(&s, 200 * SCENE_S);
	scene_unplug(&s, D, false);
	scene_tell(&s, 0, BUS_FOUND, D "/por");
	until(OWS_Q_GOOD);
	s.bus[0].probes = 0;
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_INT_WITHIN(1, 5, s.bus[0].probes);
	scene_unplug(&s, D, true);
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_NO_DEVICE));
}

/* The looks that failed before count no more. */
static void test_one_look_that_finds_nothing_is_no_absence_of_a_device_that_was_away(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_unplug(&s, D, true);
	until(OWS_Q_NO_DEVICE);
	scene_unplug(&s, D, false);
	scene_tell(&s, 0, BUS_FOUND, D "/por");
	until(OWS_Q_GOOD);
	s.bus[0].probes = 0;
	scene_unplug(&s, D, true);
	while (!s.bus[0].probes)
		scene_run(&s, SCENE_MS);
	scene_run(&s, 50 * SCENE_MS); /* its answer */
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].probes);
	scene_unplug(&s, D, false);
	for (unsigned ms = 0; ms < 5000; ms++) {
		scene_run(&s, SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, ROW).quality);
	}
}

/* Looks that waited for the first way are made by the second. */
static void test_devices_that_have_moved_to_another_way_are_looked_for(void)
{
	static char path[30][32], name[30][8];

	s.bus[0].holds = true;
	scene_bus(&s, "second", 0)->holds = true;
	for (unsigned i = 0; i < 30; i++) {
		snprintf(path[i], sizeof(path[i]), "/29.%012X/sensed.BYTE", i + 1);
		snprintf(name[i], sizeof(name[i]), "in%u", i);
		scene_input(&s, name[i], path[i], OWS_BYTE)->per_factor = 100000;
		scene_put(&s, path[i], "255", 0);
	}
	scene_reach(&s, 0, true);
	scene_reach(&s, 1, true);
	scene_start(&s);
	scene_run(&s, 5 * SCENE_S);
	scene_reach(&s, 0, false);
	scene_down_on(&s, 0, -ENOTCONN);
	scene_run(&s, 10 * SCENE_S);
	for (unsigned i = 0; i < 30; i++) {
		scene_expect(&s, 1 + i, OWS_Q_GOOD, 1);
		path[i][16] = '\0';
		scene_unplug(&s, path[i], true);
	}
	scene_run(&s, 30 * SCENE_S);
	for (unsigned i = 0; i < 30; i++)
		scene_expect(&s, 1 + i, OWS_Q_NO_DEVICE, 1);
}

static void test_a_reload_goes_on_looking(void)
{
	begin(NOT_READ_BACK, ALONE);
	scene_reload(&s, NULL);
	scene_unplug(&s, D, true);
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_NO_DEVICE));
	scene_reload(&s, NULL);
	scene_unplug(&s, D, false);
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	TEST_ASSERT_LESS_THAN_INT64(3 * SCENE_S, until(OWS_Q_GOOD));
	TEST_ASSERT_EQUAL_STRING("6", scene_at(&s, D "/PIO.BYTE"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_signal_of_a_lost_device_is_bad_and_good_again_when_it_is_back);
	RUN_TEST(test_a_disturbed_reading_of_one_signal_is_no_absence);
	RUN_TEST(test_one_look_that_finds_nothing_is_no_absence);
	RUN_TEST(test_a_look_that_fails_is_no_absence_and_the_signals_that_are_read_say_why);
	RUN_TEST(test_what_is_answered_without_the_device_does_not_bring_it_back);
	RUN_TEST(test_a_lost_device_that_is_listed_in_alarm_is_read_at_once);
	RUN_TEST(test_a_device_lost_in_alarm_is_bad_soon);
	RUN_TEST(test_an_output_that_is_not_to_be_written_is_not_good_when_its_device_is_back);
	RUN_TEST(test_a_write_to_a_lost_device_is_not_tried_again_at_once);
	RUN_TEST(test_a_device_that_is_read_in_each_period_is_not_looked_for);
	RUN_TEST(test_a_device_alone_is_looked_for_each_two_seconds);
	RUN_TEST(test_many_devices_take_ten_looks_a_second_at_the_most);
	RUN_TEST(test_a_device_that_stays_away_costs_ever_less);
	RUN_TEST(test_a_period_longer_than_two_seconds_is_the_time_between_looks);
	RUN_TEST(test_a_device_that_is_back_is_looked_for_as_often_as_before);
	RUN_TEST(test_one_look_that_finds_nothing_is_no_absence_of_a_device_that_was_away);
	RUN_TEST(test_devices_that_have_moved_to_another_way_are_looked_for);
	RUN_TEST(test_a_reload_goes_on_looking);
	return UNITY_END();
}
