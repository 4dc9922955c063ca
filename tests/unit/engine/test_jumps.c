/* SPDX-License-Identifier: MIT */
/* MaxStep in the engine: a reading that jumps is held back until it is confirmed. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/ground/text/log.h"
#include "tests/unit/aid/scene.h"

#define FREEZER "/28.000000000004/temperature"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

/* Read once a second; a second reading comes at once. */
static struct config_item *freezer(void)
{
	struct config_item *item = scene_input(&s, "freezer", FREEZER, OWS_DOUBLE);

	item->max_step = 2;
	item->per_factor = 10;
	scene_put(&s, FREEZER, "-16", 0);
	return item;
}

/* Until the next reading has come. */
static void freezer_reads(const char *text)
{
	unsigned before = s.reads;

	scene_put(&s, FREEZER, text, 0);
	while (s.reads == before)
		scene_run(&s, 10 * SCENE_MS);
	scene_run(&s, 10 * SCENE_MS);
}

static void start(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 250 * SCENE_MS);
}

static void expect(uint8_t quality, int err)
{
	TEST_ASSERT_EQUAL_HEX8(quality, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT(err, scene_sample(&s, 1).err);
}

static void test_a_spike_is_not_published_and_the_value_before_grows_old(void)
{
	struct config_item *item = freezer();
	struct ows_sample before;

	item->limits = (struct config_limits){
		.any = true, .has = {[CONFIG_LIMIT_H] = true}, .limit = {[CONFIG_LIMIT_H] = -10}};
	start();
	expect(OWS_Q_GOOD, 0);
	before = scene_sample(&s, 1);
	freezer_reads("80.5625");
	expect(OWS_Q_GOOD, -EREMCHG);
	TEST_ASSERT_EQUAL_DOUBLE(-16, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(-16, value_number(OWS_DOUBLE, scene_attrs(&s, 1).raw));
	TEST_ASSERT_EQUAL_INT64(before.measured_ns, scene_sample(&s, 1).measured_ns);
	TEST_ASSERT_EQUAL_UINT32(before.count, scene_sample(&s, 1).count);
	freezer_reads("-16.0625");
	expect(OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_DOUBLE(-16.0625, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_NORMAL, scene_attrs(&s, 1).limit_state);
	TEST_ASSERT_EQUAL_INT64(0, s.image.alarms[0].occurred_ns);
	TEST_ASSERT_EQUAL_UINT64(2, scene_counter(&s, "held_back")); /* the first value was one */
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "item_errors"));
}

static void test_the_reading_that_confirms_comes_at_once_and_past_the_caches(void)
{
	int64_t begun;

	freezer()->per_factor = 100;
	start();
	scene_put(&s, FREEZER, "-10", 0);
	while (scene_sample(&s, 1).err == 0)
		scene_run(&s, 10 * SCENE_MS);
	begun = s.now_ns;
	scene_clear_trace(&s);
	while (scene_sample(&s, 1).err)
		scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_LESS_THAN_INT64(300 * SCENE_MS, s.now_ns - begun);
	TEST_ASSERT_EQUAL_STRING("r " FREEZER "\n", s.trace);
	TEST_ASSERT_EQUAL_DOUBLE(-10, scene_number(&s, 1));
	scene_clear_trace(&s);
	freezer_reads("-10");
	TEST_ASSERT_EQUAL_STRING("R " FREEZER "\n", s.trace);
}

static void test_the_first_value_is_initial_until_a_second_reading_confirms_it(void)
{
	freezer();
	scene_put(&s, FREEZER, "80.5625", 0);
	scene_start(&s);
	scene_up(&s);
	while (!scene_sample(&s, 1).err)
		scene_run(&s, 10 * SCENE_MS);
	expect(OWS_Q_INITIAL, -EREMCHG);
	freezer_reads("-16");
	expect(OWS_Q_INITIAL, -EREMCHG);
	freezer_reads("-16");
	expect(OWS_Q_GOOD, 0);
}

/* The log as a text. */
static void drain(struct log *log, char *text, size_t size)
{
	FILE *out = tmpfile();
	size_t n;

	log_drain(log, fileno(out), 0);
	rewind(out);
	n = fread(text, 1, size - 1, out);
	text[n] = '\0';
	fclose(out);
}

static void test_the_log_has_what_is_held_back_and_not_the_first_value(void)
{
	struct log *log = log_create(LOG_LEVEL_NOTICE);
	char text[2048];

	s.log = log;
	freezer();
	start();
	drain(log, text, sizeof(text));
	TEST_ASSERT_NULL_MESSAGE(strstr(text, "MaxStep"), text);
	freezer_reads("80.5625");
	freezer_reads("-16");
	drain(log, text, sizeof(text));
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(text, "freezer (" FREEZER
	                     "): 80.5625 after -16 jumps beyond MaxStep: it is held back"),
		text);
	s.log = NULL;
	scene_end(&s);
	log_destroy(log);
	scene_init(&s);
}

static void test_what_jumps_each_time_is_the_last_usable_value_and_read_as_often(void)
{
	char text[16];

	freezer();
	start();
	for (int i = 1; i <= 20; i++) {
		int64_t begun = s.now_ns;

		snprintf(text, sizeof(text), "%d", -16 + 5 * i);
		freezer_reads(text);
		expect(i <= 3 ? OWS_Q_GOOD : OWS_Q_LAST_USABLE, -EREMCHG);
		TEST_ASSERT_TRUE(i == 1 || s.now_ns - begun < 300 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_DOUBLE(-16, scene_number(&s, 1));
	scene_run(&s, 40 * SCENE_S);
	expect(OWS_Q_LAST_USABLE, -EREMCHG);
	scene_run(&s, 20 * SCENE_S); /* it has had the time for 100 */
	expect(OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_DOUBLE(84, scene_number(&s, 1));
}

static void test_a_device_that_comes_back_is_compared_with_its_last_good_value(void)
{
	freezer();
	start();
	scene_put(&s, FREEZER, NULL, -ENODEV);
	scene_run(&s, 20 * SCENE_S);
	expect(OWS_Q_NO_DEVICE, -ENODEV);
	freezer_reads("80.5625");
	expect(OWS_Q_LAST_USABLE, -EREMCHG);
	TEST_ASSERT_EQUAL_DOUBLE(-16, scene_number(&s, 1));
	freezer_reads("-15");
	expect(OWS_Q_GOOD, 0);
}

static void test_out_of_range_shows_at_once_and_is_no_value_to_compare_with(void)
{
	struct config_item *item = freezer();

	item->scale = (struct scale){.has_max = true, .max = 50};
	start();
	freezer_reads("80.5625");
	expect(OWS_Q_RANGE, 0);
	freezer_reads("40");
	expect(OWS_Q_RANGE, -EREMCHG);
	TEST_ASSERT_EQUAL_DOUBLE(80.5625, scene_number(&s, 1));
	freezer_reads("-16");
	expect(OWS_Q_GOOD, 0);
}

static void test_a_jump_is_in_the_unit_of_the_value_and_does_not_bend_the_filter(void)
{
	struct config_item *item = freezer();

	item->scale = (struct scale){.linear = true, .factor = 1.8, .offset = 32};
	item->filter_s = 1000;
	start();
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.2, scene_number(&s, 1));
	freezer_reads("-14.5"); /* 2.7 of Fahrenheit */
	expect(OWS_Q_GOOD, -EREMCHG);
	freezer_reads("-16");
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3.2, scene_number(&s, 1));
	freezer_reads("-15");
	expect(OWS_Q_GOOD, 0);
}

static void test_what_was_written_to_an_input_is_known_to_be_true(void)
{
	freezer()->writable = true;
	start();
	scene_set(&s, 1, value_of_double(40));
	scene_run(&s, 3 * SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(40, scene_number(&s, 1));
	expect(OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "held_back")); /* the first value */
}

static void in_fahrenheit(struct config *config)
{
	config->items[0].scale = (struct scale){.linear = true, .factor = 1.8, .offset = 32};
}

static void test_a_reload_that_changes_the_scale_has_the_next_value_confirmed(void)
{
	freezer();
	start();
	scene_reload(&s, NULL);
	freezer_reads("-15");
	expect(OWS_Q_GOOD, 0);
	scene_reload(&s, in_fahrenheit);
	freezer_reads("-15");
	expect(OWS_Q_GOOD, -EREMCHG);
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5, scene_number(&s, 1));
	freezer_reads("-15");
	expect(OWS_Q_GOOD, 0);
}

/* The device answered whole: its first fault waits as long as a first fault does. */
static void test_what_jumped_does_not_lengthen_the_back_off_of_a_fault(void)
{
	char text[16];
	unsigned before;

	freezer();
	start();
	for (int i = 1; i <= 12; i++) {
		snprintf(text, sizeof(text), "%d", -16 + 5 * i);
		freezer_reads(text);
	}
	expect(OWS_Q_LAST_USABLE, -EREMCHG);
	scene_put(&s, FREEZER, NULL, -EBADMSG);
	while (scene_sample(&s, 1).err == -EREMCHG)
		scene_run(&s, 10 * SCENE_MS);
	expect(OWS_Q_DEVICE, -EBADMSG);
	before = s.reads;
	scene_run(&s, 1500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(before + 1, s.reads);
}

static void without_max_step(struct config *config)
{
	config->items[0].max_step = 0;
}

/* Nothing confirms it any more: it is no reason to read past the caches for ever. */
static void test_a_reload_without_max_step_reads_from_the_caches_again(void)
{
	freezer();
	start();
	freezer_reads("80.5625");
	expect(OWS_Q_GOOD, -EREMCHG);
	scene_reload(&s, without_max_step);
	freezer_reads("80.5625");
	expect(OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_DOUBLE(80.5625, scene_number(&s, 1));
	scene_clear_trace(&s);
	freezer_reads("-16");
	TEST_ASSERT_EQUAL_STRING("R " FREEZER "\n", s.trace);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_spike_is_not_published_and_the_value_before_grows_old);
	RUN_TEST(test_the_reading_that_confirms_comes_at_once_and_past_the_caches);
	RUN_TEST(test_the_first_value_is_initial_until_a_second_reading_confirms_it);
	RUN_TEST(test_the_log_has_what_is_held_back_and_not_the_first_value);
	RUN_TEST(test_what_jumps_each_time_is_the_last_usable_value_and_read_as_often);
	RUN_TEST(test_a_device_that_comes_back_is_compared_with_its_last_good_value);
	RUN_TEST(test_out_of_range_shows_at_once_and_is_no_value_to_compare_with);
	RUN_TEST(test_a_jump_is_in_the_unit_of_the_value_and_does_not_bend_the_filter);
	RUN_TEST(test_what_was_written_to_an_input_is_known_to_be_true);
	RUN_TEST(test_a_reload_that_changes_the_scale_has_the_next_value_confirmed);
	RUN_TEST(test_what_jumped_does_not_lengthen_the_back_off_of_a_fault);
	RUN_TEST(test_a_reload_without_max_step_reads_from_the_caches_again);
	return UNITY_END();
}
