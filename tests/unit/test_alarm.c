/* SPDX-License-Identifier: MIT */
/*
 * The alarm machine at work on a scripted bus. A trace is what goes over the wire: "r" reads past the
 * cache, "W" writes; expected texts are complete, so a reader can follow them beside the manual.
 */
#include "scene.h"
#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct scene s;

#define D "/29.066418000000"
#define E "/29.777777000000"
#define T "/28.551DDF030000"
#define T_TEMP T "/temperature12"

static struct config_item *alarm_item(const char *name, const char *path, const char *latch,
                                      const char *por, const char *set, const char *reset)
{
	struct config_item *item = scene_input(&s, name, path, OWS_BYTE);

	item->alarm = true;
	item->latch_alarm = latch;
	item->por_alarm = por;
	item->set_alarm = set;
	item->reset_latch = reset;
	return item;
}

/* Figure 3.3 of the manual. */
static struct config_item *figure_3_3(void)
{
	return alarm_item("inputs", D "/sensed.BYTE", "latch.BYTE", "por", "set_alarm=133333333",
	                  "latch.BYTE=0");
}

/* A DS2408: in alarm while its latch or its por is not zero. */
static void judge_alarm(void)
{
	static char list[256];

	list[0] = '\0';
	if (strcmp(scene_at(&s, D "/latch.BYTE"), "0") || strcmp(scene_at(&s, D "/por"), "0"))
		strcat(list, "/alarm" D "\n");
	if (scene_at(&s, E "/latch.BYTE") && strcmp(scene_at(&s, E "/latch.BYTE"), "0"))
		strcat(list, "/alarm" E "\n");
	scene_put(&s, "/alarm", list, 0);
}

static void device(const char *latch, const char *por)
{
	scene_put(&s, D "/sensed.BYTE", "255", 0);
	scene_put(&s, D "/latch.BYTE", latch, 0);
	scene_put(&s, D "/por", por, 0);
	scene_put(&s, D "/set_alarm", "133333333", 0);
	scene_put(&s, D "/PIO.BYTE", "0", 0);
	judge_alarm();
}

static void on_read(struct scene *scene, const char *path)
{
	(void)scene;
	if (strcmp(path, "/alarm") == 0)
		judge_alarm();
}

/* Start, and let the first values and the arming pass. */
static void begin(void)
{
	s.on_read = on_read;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	scene_clear_trace(&s);
}

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

static void test_an_alarm_is_read_reset_and_read_once_more(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " D "/por\n"
	                         "r " D "/latch.BYTE\n"
	                         "r /alarm" D "/sensed.BYTE\n"
	                         "W /alarm" D "/latch.BYTE=0\n"
	                         "r " D "/sensed.BYTE\n",
	                         s.trace);
	TEST_ASSERT_EQUAL_INT64(254, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
}

static void test_an_alarm_stands_in_the_journal_with_the_values_before_and_after(void)
{
	const struct ows_alarm_entry *entry;

	figure_3_3();
	device("0", "0");
	begin();
	entry = s.image.alarms;
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_DEVICE, entry[0].kind);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RAISED, entry[0].event);
	TEST_ASSERT_EQUAL_UINT32(1, entry[0].record);
	TEST_ASSERT_EQUAL_INT64(255, entry[0].before);
	TEST_ASSERT_EQUAL_INT64(254, entry[0].after);
	TEST_ASSERT_EQUAL_STRING("1", entry[0].latch);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RETURNED, entry[1].event);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
}

static void test_a_power_on_reset_stands_in_the_journal(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_POR, s.image.alarms[0].kind);
}

static void test_without_an_alarm_only_the_list_is_read(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	s.lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	TEST_ASSERT_INT_WITHIN(2, 20, s.lists);
}

static void test_after_a_power_on_reset_everything_is_set_up_again(void)
{
	struct config_item *out;

	figure_3_3();
	out = scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	out->has_init = true;
	out->init_value = 3;
	device("0", "0");
	begin();
	scene_set(&s, 2, 7);
	scene_run(&s, 200 * SCENE_MS);
	scene_clear_trace(&s);
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	/* InitValue as the manual says, and the commanded value by the write step */
	TEST_ASSERT_EQUAL_STRING("r " D "/por\n"
	                         "W " D "/set_alarm=133333333\n"
	                         "W " D "/PIO.BYTE=3\n"
	                         "W " D "/por=0\n"
	                         "r " D "/latch.BYTE\n"
	                         "W " D "/PIO.BYTE=7\n",
	                         s.trace);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, D "/PIO.BYTE"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "power_on_resets"));
}

static void test_all_outputs_below_the_device_get_their_init_value_in_order(void)
{
	static const char *const paths[] = { D "/PIO.0", D "/PIO.1", E "/PIO.0", D "/PIO.2" };

	figure_3_3();
	for (int i = 0; i < 4; i++) {
		struct config_item *out = scene_output(&s, &"abcd"[i], paths[i], OWS_BOOL);

		out->has_init = i != 1;
		out->init_value = 1;
		scene_put(&s, paths[i], "0", 0);
	}
	device("0", "0");
	begin();
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " D "/por\n"
	                         "W " D "/set_alarm=133333333\n"
	                         "W " D "/PIO.0=1\n"
	                         "W " D "/PIO.2=1\n"
	                         "W " D "/por=0\n"
	                         "r " D "/latch.BYTE\n",
	                         s.trace);
}

static void test_the_alarm_condition_is_armed_at_start_if_it_differs(void)
{
	figure_3_3();
	device("0", "0");
	scene_put(&s, D "/set_alarm", "111111111", 0);
	s.on_read = on_read;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 40 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("133333333", scene_at(&s, D "/set_alarm"));
	TEST_ASSERT_EQUAL_STRING_LEN("r " D "/set_alarm\nW " D "/set_alarm=133333333\n", s.trace,
	                             2 * strlen("r " D "/set_alarm\n") + 10);
}

static void test_numbers_are_compared_as_numbers_when_arming(void)
{
	alarm_item("t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
	scene_put(&s, "/alarm", "", 0);
	scene_put(&s, T "/temphigh", "          30", 0);
	scene_put(&s, T_TEMP, "21", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void mute_at_init(struct scene *scene, const char *path, const char *data, uint32_t len)
{
	(void)data;
	(void)len;
	if (strstr(path, "/set_alarm"))
		scene->bus[0].mute = true; /* the next request, InitValue, is not answered */
}

static void test_an_init_value_in_doubt_is_followed_by_the_present_value(void)
{
	struct config_item *out;

	figure_3_3();
	out = scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	out->has_init = true;
	out->init_value = 3;
	device("0", "0");
	begin();
	scene_set(&s, 2, 7);
	scene_run(&s, 200 * SCENE_MS);
	s.on_write = mute_at_init;
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 25 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	s.bus[0].mute = false;
	s.on_write = NULL;
	scene_put(&s, D "/por", "0", 0);
	scene_put(&s, D "/PIO.BYTE", "3", 0);
	scene_clear_trace(&s);
	scene_answer(&s, s.bus[0].swallowed[0]->id, 0, NULL, s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, D "/PIO.BYTE"));
}

static void test_a_level_alarm_gives_one_event_and_not_one_a_cycle(void)
{
	alarm_item("t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
	scene_put(&s, "/alarm", "", 0);
	scene_put(&s, T "/temphigh", "30", 0);
	scene_put(&s, T "/present", "1", 0);
	scene_put(&s, T_TEMP, "31", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	scene_put(&s, "/alarm", "/alarm" T "\n", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	scene_put(&s, "/alarm", "", 0);
	scene_run(&s, SCENE_S);
	scene_put(&s, "/alarm", "/alarm" T "\n", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(2, scene_attrs(&s, 1).alarms);
}

static void test_two_items_of_one_device_lose_nothing_to_each_others_reset(void)
{
	alarm_item("a", D "/sensed.0", "latch.0", "por", "set_alarm=133333333", "latch.BYTE=0");
	alarm_item("b", D "/sensed.1", "latch.1", "por", "set_alarm=133333333", "latch.BYTE=0");
	device("0", "0");
	scene_put(&s, D "/sensed.0", "0", 0);
	scene_put(&s, D "/sensed.1", "1", 0);
	scene_put(&s, D "/latch.0", "0", 0);
	scene_put(&s, D "/latch.1", "0", 0);
	begin();
	scene_put(&s, D "/latch.BYTE", "3", 0);
	scene_put(&s, D "/latch.0", "1", 0);
	scene_put(&s, D "/latch.1", "1", 0);
	scene_run(&s, 70 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " D "/por\n"
	                         "r " D "/latch.1\n"
	                         "r " D "/latch.0\n"
	                         "r /alarm" D "/sensed.0\n"
	                         "W /alarm" D "/latch.BYTE=0\n"
	                         "r " D "/sensed.0\n"
	                         "r /alarm" D "/sensed.1\n"
	                         "r " D "/sensed.1\n",
	                         s.trace);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 2).alarms);
}

static void test_after_max_cons_alarms_one_other_request_goes_through(void)
{
	s.config.max_cons_alarms = 1;
	figure_3_3();
	alarm_item("second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	device("1", "0");
	scene_put(&s, E "/sensed.BYTE", "1", 0);
	scene_put(&s, E "/latch.BYTE", "1", 0);
	scene_put(&s, T_TEMP, "21", 0);
	s.bus[0].latency_ns = 30 * SCENE_MS;
	scene_start(&s);
	s.on_read = on_read;
	scene_up(&s);
	scene_run(&s, 2 * SCENE_S);
	/* between the last request of one alarm and the first of the next stands a reading */
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "r " D "/sensed.BYTE\nR "));
}

static void test_an_alarm_does_not_wait_for_a_conversion(void)
{
	static const char *const values[] = { "254", "253", "252", "251", "250", "249" };

	s.bus[0].depth = 4;
	s.bus[0].slow = T_TEMP;
	s.bus[0].slow_ns = 750 * SCENE_MS;
	figure_3_3();
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	device("0", "0");
	scene_put(&s, T_TEMP, "21", 0);
	begin();
	for (unsigned i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		scene_put(&s, D "/sensed.BYTE", values[i], 0);
		scene_put(&s, D "/latch.BYTE", "1", 0);
		scene_run(&s, 120 * SCENE_MS);
		TEST_ASSERT_EQUAL_INT64(254 - i, scene_sample(&s, 1).value);
		TEST_ASSERT_EQUAL_UINT32(i + 1, scene_attrs(&s, 1).alarms);
	}
	TEST_ASSERT_GREATER_THAN(0, scene_sample(&s, 2).count);
}

static void test_the_engine_sleeps_while_a_write_holds_the_alarms_up(void)
{
	uint64_t steps;

	s.bus[0].depth = 4;
	s.bus[0].slow = D "/PIO.BYTE";
	s.bus[0].slow_ns = SCENE_S;
	figure_3_3();
	scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	device("0", "0");
	begin();
	steps = scene_counter(&s, "steps");
	scene_set(&s, 2, 1);
	scene_run(&s, 900 * SCENE_MS);
	/* Nine periods, and a list or two before them. */
	TEST_ASSERT_LESS_THAN_UINT64(steps + 30, scene_counter(&s, "steps"));
}

static void test_a_storm_of_alarms_starves_neither_reads_nor_writes(void)
{
	figure_3_3();
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	scene_output(&s, "out", D "/PIO.BYTE", OWS_BYTE);
	device("1", "0");
	scene_put(&s, T_TEMP, "21", 0);
	scene_put(&s, "/alarm", "/alarm" D "\n", 0);
	scene_start(&s);
	scene_up(&s);
	for (int i = 0; i < 200; i++) {
		scene_put(&s, D "/latch.BYTE", "1", 0);
		scene_set(&s, 3, i & 127);
		scene_run(&s, 50 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_INT64(199 & 127, scene_sample(&s, 3).value);
	TEST_ASSERT_GREATER_THAN(50, scene_sample(&s, 2).count);
	TEST_ASSERT_GREATER_THAN(50, scene_sample(&s, 3).count);
	TEST_ASSERT_GREATER_THAN(50, scene_attrs(&s, 1).alarms);
}

static void test_a_bus_without_alarm_search_has_its_items_read_as_inputs(void)
{
	figure_3_3();
	scene_put(&s, D "/sensed.BYTE", "255", 0);
	scene_put(&s, D "/set_alarm", "133333333", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.lists);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	TEST_ASSERT_GREATER_THAN(8, scene_sample(&s, 1).count);
}

/* Once for each time that it comes back: it may be another one, or have another driver. */
static void test_a_bus_without_alarm_search_is_asked_again_when_it_comes_back(void)
{
	figure_3_3();
	scene_put(&s, D "/sensed.BYTE", "255", 0);
	scene_put(&s, D "/set_alarm", "133333333", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.lists);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	scene_down(&s, -ECONNRESET);
	device("0", "0");
	judge_alarm();
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.lists);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	device("1", "0");
	judge_alarm();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
}

static void test_a_bus_that_searches_is_asked_for_the_families_of_the_items_only(void)
{
	s.bus[0].searches = s.trace_lists = true;
	figure_3_3();
	alarm_item("second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	alarm_item("t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
	device("0", "0");
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "D /alarm/29,28\n"));
	TEST_ASSERT_NULL(strstr(s.trace, "D /alarm\n"));
}

static void test_a_list_that_fails_is_asked_for_ever_more_rarely(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	s.on_read = NULL;
	scene_put(&s, "/alarm", NULL, -EIO);
	s.lists = 0;
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_LESS_THAN(25, s.lists);
	scene_put(&s, "/alarm", "", 0);
	scene_run(&s, 60 * SCENE_S);
	s.lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_INT_WITHIN(2, 20, s.lists);
}

static void test_a_device_that_fails_is_left_for_the_next_alarm(void)
{
	figure_3_3();
	alarm_item("second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	device("1", "0");
	scene_put(&s, E "/sensed.BYTE", "77", 0);
	scene_put(&s, E "/latch.BYTE", "0", 0);
	begin();
	scene_put(&s, D "/por", NULL, -ENODEV);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_put(&s, E "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 2).alarms);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, E "/latch.BYTE"));
}

/* Its device vanishes at the n-th request of a visit: whatever the state, the others go on. */
static unsigned vanish_at, asked;
static void vanish(struct scene *scene, const char *path)
{
	static const char *const all[] = { D "/por", D "/latch.BYTE", D "/sensed.BYTE",
		                           D "/set_alarm", D "/PIO.BYTE" };

	(void)scene;
	if (strcmp(path, "/alarm") == 0 || !strstr(path, D) || ++asked != vanish_at)
		return;
	for (unsigned i = 0; i < 5; i++)
		scene_put(&s, all[i], scene_at(&s, all[i]), -ENODEV);
}
static void vanish_on_write(struct scene *scene, const char *path, const char *data, uint32_t len)
{
	(void)data;
	(void)len;
	vanish(scene, path);
}

static void test_a_device_that_vanishes_in_any_state_does_not_stop_the_machine(void)
{
	for (vanish_at = 1; vanish_at <= 9; vanish_at++) {
		struct config_item *out;

		scene_init(&s);
		figure_3_3();
		alarm_item("second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
		out = scene_output(&s, "out", D "/PIO.BYTE", OWS_BYTE);
		out->has_init = true;
		out->init_value = 3;
		device("0", "0");
		scene_put(&s, E "/sensed.BYTE", "77", 0);
		scene_put(&s, E "/latch.BYTE", "0", 0);
		begin();
		asked = 0;
		s.on_read = vanish;
		s.on_write = vanish_on_write;
		scene_put(&s, D "/por", "1", 0);
		scene_put(&s, D "/latch.BYTE", "1", 0);
		scene_put(&s, E "/latch.BYTE", "1", 0);
		scene_put(&s, "/alarm", "/alarm" D "\n/alarm" E "\n", 0);
		scene_run(&s, 5 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 2).alarms);
		TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, E "/latch.BYTE"));
		if (vanish_at < 9)
			scene_end(&s);
	}
}

static void test_a_lost_target_begins_the_machine_anew(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	s.bus[0].latency_ns = 20 * SCENE_MS;
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 90 * SCENE_MS);
	scene_down(&s, -ECONNRESET);
	scene_run(&s, SCENE_S);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/latch.BYTE"));
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_an_alarm_that_comes_during_its_handling_is_not_lost(void)
{
	figure_3_3();
	device("0", "0");
	begin();
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_run(&s, 54 * SCENE_MS);
	/* after the latch was reset, before the value is read once more */
	scene_put(&s, D "/sensed.BYTE", "252", 0);
	scene_put(&s, D "/latch.BYTE", "2", 0);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(252, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/latch.BYTE"));
}

static void test_latches_of_every_spelling_are_understood(void)
{
	static const struct {
		const char *latch;
		unsigned alarms;
	} table[] = {
		{ "0,0,0,0,0,1,0,0", 1 }, { "0,0,0,0,0,0,0,0", 0 }, { "           1", 1 },
		{ "           0", 0 },     { "yes", 1 },             { "no", 0 },
		{ "on", 1 },               { "0.5", 1 },             { "   0,   0", 0 },
		{ "abc", 0 },              { "", 0 },                { "1,,1", 0 },
	};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		scene_init(&s);
		alarm_item("a", D "/sensed.BYTE", "latch.ALL", "", NULL, NULL);
		scene_put(&s, D "/sensed.BYTE", "1", 0);
		scene_put(&s, D "/latch.ALL", table[i].latch, 0);
		scene_put(&s, "/alarm", "/alarm" D "\n", 0);
		scene_start(&s);
		scene_up(&s);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_UINT32_MESSAGE(table[i].alarms, scene_attrs(&s, 1).alarms,
		                                 table[i].latch);
		if (i + 1 < sizeof(table) / sizeof(table[0]))
			scene_end(&s);
	}
}

/*
 * All combinations of defined, empty and not defined of the five strings (por, set, latch, reset; of
 * sSensed, which comes from the path and so is always defined: defined, and empty as of an item that
 * is not read) for a device whose por and latch are set: what must go over the wire, from the table.
 */
static void test_every_combination_of_defined_empty_and_not_defined(void)
{
	static const char *const por[] = { "por", "", NULL }, *const latch[] = { "latch.BYTE", "", NULL },
	                        *const set[] = { "set_alarm=133333333", "", NULL },
	                        *const reset[] = { "latch.BYTE=0", "", NULL };

	for (int n = 0; n < 162; n++) {
		int p = n % 3, l = n / 3 % 3, t = n / 9 % 3, r = n / 27 % 3;
		bool sensed = n < 81;
		bool goes_on;
		char expected[512] = "", message[48];

		scene_init(&s);
		alarm_item("a", D "/sensed.BYTE", latch[l], por[p], set[t], reset[r])->readable =
			sensed;
		device("1", "1");
		scene_put(&s, "/alarm", "", 0);
		scene_start(&s);
		scene_up(&s);
		scene_run(&s, 300 * SCENE_MS);
		scene_clear_trace(&s);
		scene_put(&s, "/alarm", "/alarm" D "\n", 0);
		/* one visit */
		scene_run(&s, 60 * SCENE_MS);
		goes_on = p != 2;
		if (p == 0) {
			strcat(expected, "r " D "/por\n");
			goes_on = t != 2;
			if (t == 0)
				strcat(expected, "W " D "/set_alarm=133333333\n");
			if (goes_on)
				strcat(expected, "W " D "/por=0\n");
		}
		if (goes_on && l == 0) {
			strcat(expected, "r " D "/latch.BYTE\n");
			if (sensed)
				strcat(expected, "r /alarm" D "/sensed.BYTE\n");
			if (r == 0)
				strcat(expected, "W /alarm" D "/latch.BYTE=0\n");
			if (r != 2 && sensed)
				strcat(expected, "r " D "/sensed.BYTE\n");
		}
		snprintf(message, sizeof(message), "por %d latch %d set %d reset %d sensed %d", p,
		         l, t, r, sensed);
		TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(expected, s.trace, strlen(expected), message);
		if (!*expected)
			TEST_ASSERT_EQUAL_STRING_MESSAGE("", s.trace, message);
		if (n < 161)
			scene_end(&s);
	}
}

/*
 * A bus of two requests falls silent with both out. The older one takes the target down and the
 * machine begins anew; the list that was asked for later is answered after that.
 */
static void test_a_list_that_comes_after_the_target_was_given_up_counts_for_nothing(void)
{
	s.bus[0].depth = 2;
	figure_3_3();
	scene_input(&s, "room", T_TEMP, OWS_DOUBLE);
	device("0", "0");
	scene_put(&s, "/alarm", "", 0);
	scene_put(&s, T_TEMP, "21.5", 0);
	scene_start(&s);
	scene_up(&s);
	for (unsigned round = 0; round < 20; round++) {
		uint64_t failures = scene_counter(&s, "target_failures");
		uint64_t lists = scene_counter(&s, "alarm_lists");

		scene_run(&s, SCENE_S + (int64_t)round * 7 * SCENE_MS);
		s.bus[0].mute = true;
		while (scene_counter(&s, "target_failures") == failures)
			scene_run(&s, SCENE_MS);
		TEST_ASSERT_EQUAL_UINT(2, s.bus[0].swallowed_count);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
		s.bus[0].mute = false;
		while (s.bus[0].swallowed_count) {
			struct bus_req *req = s.bus[0].swallowed[--s.bus[0].swallowed_count];

			scene_answer(&s, req->id, 0, req->op == BUS_DIR ? "" : "21.5", req);
		}
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
		TEST_ASSERT_GREATER_THAN_UINT64(lists + 5, scene_counter(&s, "alarm_lists"));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_alarm_is_read_reset_and_read_once_more);
	RUN_TEST(test_an_alarm_stands_in_the_journal_with_the_values_before_and_after);
	RUN_TEST(test_a_power_on_reset_stands_in_the_journal);
	RUN_TEST(test_without_an_alarm_only_the_list_is_read);
	RUN_TEST(test_after_a_power_on_reset_everything_is_set_up_again);
	RUN_TEST(test_all_outputs_below_the_device_get_their_init_value_in_order);
	RUN_TEST(test_the_alarm_condition_is_armed_at_start_if_it_differs);
	RUN_TEST(test_numbers_are_compared_as_numbers_when_arming);
	RUN_TEST(test_an_init_value_in_doubt_is_followed_by_the_present_value);
	RUN_TEST(test_a_level_alarm_gives_one_event_and_not_one_a_cycle);
	RUN_TEST(test_two_items_of_one_device_lose_nothing_to_each_others_reset);
	RUN_TEST(test_after_max_cons_alarms_one_other_request_goes_through);
	RUN_TEST(test_an_alarm_does_not_wait_for_a_conversion);
	RUN_TEST(test_the_engine_sleeps_while_a_write_holds_the_alarms_up);
	RUN_TEST(test_a_storm_of_alarms_starves_neither_reads_nor_writes);
	RUN_TEST(test_a_bus_without_alarm_search_has_its_items_read_as_inputs);
	RUN_TEST(test_a_bus_without_alarm_search_is_asked_again_when_it_comes_back);
	RUN_TEST(test_a_bus_that_searches_is_asked_for_the_families_of_the_items_only);
	RUN_TEST(test_a_list_that_fails_is_asked_for_ever_more_rarely);
	RUN_TEST(test_a_device_that_fails_is_left_for_the_next_alarm);
	RUN_TEST(test_a_device_that_vanishes_in_any_state_does_not_stop_the_machine);
	RUN_TEST(test_a_lost_target_begins_the_machine_anew);
	RUN_TEST(test_an_alarm_that_comes_during_its_handling_is_not_lost);
	RUN_TEST(test_latches_of_every_spelling_are_understood);
	RUN_TEST(test_every_combination_of_defined_empty_and_not_defined);
	RUN_TEST(test_a_list_that_comes_after_the_target_was_given_up_counts_for_nothing);
	return UNITY_END();
}
