/* SPDX-License-Identifier: MIT */
/*
 * The alarm machine at work on a scripted bus. A trace is what goes over the wire: "r" reads past
 * the cache, "W" writes; expected texts are complete, so a reader can follow them beside the
 * manual.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"

static struct scene s;

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
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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
	const struct ows_journal_entry *entry;

	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	entry = s.image.alarms;
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_DEVICE, entry[0].kind);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RAISED, entry[0].event);
	TEST_ASSERT_EQUAL_UINT32(1, entry[0].record);
	TEST_ASSERT_EQUAL_INT64(255, entry[0].before);
	TEST_ASSERT_EQUAL_INT64(254, entry[0].after);
	TEST_ASSERT_EQUAL_STRING("1", entry[0].text);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RETURNED, entry[1].event);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
}

static void test_a_power_on_reset_stands_in_the_journal(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_POR, s.image.alarms[0].kind);
}

static void test_after_a_power_on_reset_everything_is_set_up_again(void)
{
	struct config_item *out;

	figure_3_3(&s);
	out = scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	out->has_init = true;
	out->init_value = 3;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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
	                         "r " D "/por\n"
	                         "r " D "/latch.BYTE\n"
	                         "W " D "/PIO.BYTE=7\n",
	                         s.trace);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, D "/PIO.BYTE"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "power_on_resets"));
}

/* The slot of a _ReadOneShot is used for InitValue next. */
static void test_an_init_value_that_fails_is_no_one_shot(void)
{
	struct config_item *out;

	figure_3_3(&s);
	out = scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	out->has_init = true;
	out->init_value = 3;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_set(&s, 2, 7);
	scene_run(&s, 200 * SCENE_MS);
	scene_refuse_writes(&s, D "/PIO.BYTE", -EIO);
	scene_clear_trace(&s);
	scene_slot(&s, 1)->dgn_reset += OWS_STEP_READ;
	scene_ring(&s, 1);
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "W " D "/PIO.BYTE=3\n"));
	scene_enable_writes(&s, 2, false);
	scene_run(&s, SCENE_S);
	scene_refuse_writes(&s, D "/PIO.BYTE", 0);
	scene_clear_trace(&s);
	scene_run(&s, 70 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, "W " D "/PIO.BYTE"));
}

static void test_all_outputs_below_the_device_get_their_init_value_in_order(void)
{
	static const char *const paths[] = {D "/PIO.0", D "/PIO.1", E "/PIO.0", D "/PIO.2"};

	figure_3_3(&s);
	for (int i = 0; i < 4; i++) {
		struct config_item *out = scene_output(&s, &"abcd"[i], paths[i], OWS_BOOL);

		out->has_init = i != 1;
		out->init_value = 1;
		scene_put(&s, paths[i], "0", 0);
	}
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " D "/por\n"
	                         "W " D "/set_alarm=133333333\n"
	                         "W " D "/PIO.0=1\n"
	                         "W " D "/PIO.2=1\n"
	                         "W " D "/por=0\n"
	                         "r " D "/por\n"
	                         "r " D "/latch.BYTE\n",
	                         s.trace);
}

static char memo[601];
static unsigned memos;

static void compare_memo(struct scene *scene, const char *path, const char *data, uint32_t len)
{
	(void)scene;
	if (strcmp(path, D "/memory"))
		return;
	TEST_ASSERT_EQUAL_UINT(sizeof(memo) - 1, len);
	TEST_ASSERT_EQUAL_MEMORY(memo, data, len);
	memos++;
}

static void test_a_long_text_is_written_whole_after_a_power_on_reset(void)
{
	struct config_item *out;

	figure_3_3(&s);
	out = scene_output(&s, "memo", D "/memory", OWS_STRING);
	memset(memo, 'm', sizeof(memo) - 1);
	out->has_init = true;
	out->init_text = memo;
	scene_put(&s, D "/memory", "", 0);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	memos = 0;
	s.on_write = compare_memo;
	scene_put(&s, D "/por", "1", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, memos);
}

static void test_the_alarm_condition_is_armed_at_start_if_it_differs(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	scene_put(&s, D "/set_alarm", "111111111", 0);
	s.on_read = alarm_on_read;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 40 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("133333333", scene_at(&s, D "/set_alarm"));
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "r " D "/set_alarm\nW " D "/set_alarm=133333333\n"));
}

static void test_numbers_are_compared_as_numbers_when_arming(void)
{
	alarm_item(&s, "t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
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

	figure_3_3(&s);
	out = scene_output(&s, "relays", D "/PIO.BYTE", OWS_BYTE);
	out->has_init = true;
	out->init_value = 3;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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
	alarm_item(&s, "t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
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
	alarm_item(&s, "a", D "/sensed.0", "latch.0", "por", "set_alarm=133333333", "latch.BYTE=0");
	alarm_item(&s, "b", D "/sensed.1", "latch.1", "por", "set_alarm=133333333", "latch.BYTE=0");
	alarm_device(&s, "0", "0");
	scene_put(&s, D "/sensed.0", "0", 0);
	scene_put(&s, D "/sensed.1", "1", 0);
	scene_put(&s, D "/latch.0", "0", 0);
	scene_put(&s, D "/latch.1", "0", 0);
	alarm_begin(&s);
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

static void test_an_alarm_that_comes_during_its_handling_is_not_lost(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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
		{"0,0,0,0,0,1,0,0", 1},
		{"0,0,0,0,0,0,0,0", 0},
		{"           1", 1},
		{"           0", 0},
		{"yes", 1},
		{"no", 0},
		{"on", 1},
		{"0.5", 1},
		{"   0,   0", 0},
		{"abc", 0},
		{"", 0},
		{"1,,1", 0},
	};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		scene_init(&s);
		alarm_item(&s, "a", D "/sensed.BYTE", "latch.ALL", "", NULL, NULL);
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

/* The trace without what was read in the cycle, which an alarm that can do nothing is. */
static void drop_inputs(void)
{
	char *at;

	while ((at = strstr(s.trace, "R " D "/sensed.BYTE\n")) != NULL) {
		char *rest = strchr(at, '\n') + 1;

		memmove(at, rest, strlen(rest) + 1);
	}
}

/*
 * All combinations of defined, empty and not defined of the five strings (por, set, latch, reset;
 * of sSensed, which comes from the path and so is always defined: defined, and empty as of an item
 * that is not read) for a device whose por and latch are set: what must go over the wire, from the
 * table.
 */
static void test_every_combination_of_defined_empty_and_not_defined(void)
{
	static const char *const por[] = {"por", "", NULL},
				 *const latch[] = {"latch.BYTE", "", NULL},
				 *const set[] = {"set_alarm=133333333", "", NULL},
				 *const reset[] = {"latch.BYTE=0", "", NULL};

	for (int n = 0; n < 162; n++) {
		int p = n % 3, l = n / 3 % 3, t = n / 9 % 3, r = n / 27 % 3;
		bool sensed = n < 81;
		bool goes_on;
		char expected[512] = "", message[48];

		scene_init(&s);
		alarm_item(&s, "a", D "/sensed.BYTE", latch[l], por[p], set[t], reset[r])
			->readable = sensed;
		alarm_device(&s, "1", "1");
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
				strcat(expected, "W " D "/por=0\nr " D "/por\n");
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
		drop_inputs();
		snprintf(message, sizeof(message), "por %d latch %d set %d reset %d sensed %d", p,
		         l, t, r, sensed);
		TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(expected, s.trace, strlen(expected), message);
		if (!*expected)
			TEST_ASSERT_EQUAL_STRING_MESSAGE("", s.trace, message);
		if (n < 161)
			scene_end(&s);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_alarm_is_read_reset_and_read_once_more);
	RUN_TEST(test_an_alarm_stands_in_the_journal_with_the_values_before_and_after);
	RUN_TEST(test_a_power_on_reset_stands_in_the_journal);
	RUN_TEST(test_after_a_power_on_reset_everything_is_set_up_again);
	RUN_TEST(test_an_init_value_that_fails_is_no_one_shot);
	RUN_TEST(test_all_outputs_below_the_device_get_their_init_value_in_order);
	RUN_TEST(test_a_long_text_is_written_whole_after_a_power_on_reset);
	RUN_TEST(test_the_alarm_condition_is_armed_at_start_if_it_differs);
	RUN_TEST(test_numbers_are_compared_as_numbers_when_arming);
	RUN_TEST(test_an_init_value_in_doubt_is_followed_by_the_present_value);
	RUN_TEST(test_a_level_alarm_gives_one_event_and_not_one_a_cycle);
	RUN_TEST(test_two_items_of_one_device_lose_nothing_to_each_others_reset);
	RUN_TEST(test_an_alarm_that_comes_during_its_handling_is_not_lost);
	RUN_TEST(test_latches_of_every_spelling_are_understood);
	RUN_TEST(test_every_combination_of_defined_empty_and_not_defined);
	return UNITY_END();
}
