/* SPDX-License-Identifier: MIT */
/* The list of the devices in alarm: what is asked of a bus for it, and how often. */
#include <errno.h>
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

static void test_without_an_alarm_only_the_list_is_read(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	TEST_ASSERT_INT_WITHIN(2, 20, s.lists);
}

static void test_a_bus_without_alarm_search_has_its_items_read_as_inputs(void)
{
	figure_3_3(&s);
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
	figure_3_3(&s);
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
	alarm_device(&s, "0", "0");
	judge_alarm(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.lists);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	alarm_device(&s, "1", "0");
	judge_alarm(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
}

static void test_an_alarm_stands_no_more_where_no_look_can_tell_its_return(void)
{
	uint32_t head;

	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_refuse_writes(&s, "/alarm" D "/latch.BYTE", -EIO);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
	head = s.image.header->alarm_head;
	scene_down(&s, -ECONNRESET);
	s.on_read = NULL;
	scene_put(&s, "/alarm", NULL, -EOPNOTSUPP);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
	TEST_ASSERT_EQUAL_UINT32(head + 1, s.image.header->alarm_head);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RETURNED, s.image.alarms[head].event);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_DEVICE, s.image.alarms[head].kind);
}

static void test_a_bus_that_searches_is_asked_for_the_families_of_the_items_only(void)
{
	s.bus[0].searches = s.trace_lists = true;
	figure_3_3(&s);
	alarm_item(&s, "second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	alarm_item(&s, "t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
	alarm_device(&s, "0", "0");
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "D /alarm/29,28\n"));
	TEST_ASSERT_NULL(strstr(s.trace, "D /alarm\n"));
}

/* No latch tells there of a switch whose id was guessed; a thermometer has none to guess by. */
static void test_ids_are_read_whole_where_the_list_alone_tells_of_a_switch(void)
{
	s.bus[0].searches = s.trace_lists = true;
	alarm_item(&s, "level", E "/sensed.BYTE", "present", "", NULL, "");
	alarm_item(&s, "t", T_TEMP, "present", "", "temphigh=30", "")->type = OWS_DOUBLE;
	alarm_device(&s, "0", "0");
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "d /alarm/29,28\n"));
	TEST_ASSERT_NULL(strstr(s.trace, "D /alarm"));
}

static void test_a_list_that_fails_is_asked_for_ever_more_rarely(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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

static void test_a_list_that_finds_the_wire_short_has_its_items_read_at_once(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	s.on_read = NULL;
	scene_put(&s, "/alarm", NULL, -ECOMM);
	scene_put(&s, D "/sensed.BYTE", NULL, -ECOMM);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_SHORT, scene_sample(&s, 1).quality);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_SHORT, scene_sample(&s, 1).quality);
	scene_put(&s, "/alarm", "", 0);
	scene_put(&s, D "/sensed.BYTE", "255", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

/*
 * A bus of two requests falls silent with both out. The older one takes the target down and the
 * machine begins anew; the list that was asked for later is answered after that.
 */
static void test_a_list_that_comes_after_the_target_was_given_up_counts_for_nothing(void)
{
	s.bus[0].depth = 2;
	figure_3_3(&s);
	scene_input(&s, "room", T_TEMP, OWS_DOUBLE);
	alarm_device(&s, "0", "0");
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
	RUN_TEST(test_without_an_alarm_only_the_list_is_read);
	RUN_TEST(test_a_bus_without_alarm_search_has_its_items_read_as_inputs);
	RUN_TEST(test_a_bus_without_alarm_search_is_asked_again_when_it_comes_back);
	RUN_TEST(test_an_alarm_stands_no_more_where_no_look_can_tell_its_return);
	RUN_TEST(test_a_bus_that_searches_is_asked_for_the_families_of_the_items_only);
	RUN_TEST(test_ids_are_read_whole_where_the_list_alone_tells_of_a_switch);
	RUN_TEST(test_a_list_that_fails_is_asked_for_ever_more_rarely);
	RUN_TEST(test_a_list_that_finds_the_wire_short_has_its_items_read_at_once);
	RUN_TEST(test_a_list_that_comes_after_the_target_was_given_up_counts_for_nothing);
	return UNITY_END();
}
