/* SPDX-License-Identifier: MIT */
/* A reload in the engine: alarms and their journal. */
#include <errno.h>

#include "unity.h"

#include "src/daemon/engine/state.h"
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

static void alarm_house(void)
{
	alarm_device(&s, "0", "0");
	alarm_item(&s, "door", D "/sensed.BYTE", "latch.BYTE", "por", NULL, "latch.BYTE=0");
	s.on_read = alarm_on_read;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

static void test_alarms_go_on_and_the_journal_with_them(void)
{
	uint32_t head;

	alarm_house();
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	head = s.image.header->alarm_head;
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT32(2, head);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT32(head, s.image.header->alarm_head);
	TEST_ASSERT_EQUAL_UINT32(1, s.image.alarms[0].record);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RAISED, s.image.alarms[0].event);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(2, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT32(head + 2, s.image.header->alarm_head);
}

static void test_a_list_of_alarms_on_its_way_comes_over(void)
{
	alarm_house();
	s.bus[0].slow = "/alarm";
	s.bus[0].slow_ns = 2 * SCENE_S;
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	scene_reload(&s, NULL);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "unknown_answers"));
}

static void without_door(struct config *config)
{
	*config->items = (struct config_item){.name = "room",
	                                      .path = "/28.551DDF030000/temperature",
	                                      .identity = "/28.551DDF030000/temperature",
	                                      .type = OWS_DOUBLE,
	                                      .per_factor = 1,
	                                      .readable = true,
	                                      .init_text = "",
	                                      .safe_text = ""};
}

static void test_the_journal_of_a_signal_that_is_gone_goes_with_it(void)
{
	alarm_house();
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	scene_put(&s, "/28.551DDF030000/temperature", "21.5", 0);
	scene_reload(&s, without_door);
	TEST_ASSERT_EQUAL_UINT32(2, s.image.header->alarm_head);
	TEST_ASSERT_EQUAL_UINT32(0, s.image.alarms[0].record);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void without_alarm(struct config *config)
{
	config->items->alarm = false;
}

/* One entry came after those: the return. */
static void returned_after(uint32_t head, uint8_t kind)
{
	TEST_ASSERT_EQUAL_UINT32(head + 1, s.image.header->alarm_head);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RETURNED, s.image.alarms[head].event);
	TEST_ASSERT_EQUAL_UINT8(kind, s.image.alarms[head].kind);
	TEST_ASSERT_EQUAL_UINT32(1, s.image.alarms[head].record);
}

static void test_an_alarm_that_stands_does_so_until_the_item_has_none(void)
{
	uint32_t head;

	alarm_house();
	scene_refuse_writes(&s, "/alarm" D "/latch.BYTE", -EIO);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	scene_reload(&s, NULL);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
	head = s.image.header->alarm_head;
	scene_reload(&s, without_alarm);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
	returned_after(head, OWS_ALARM_DEVICE);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT32(head + 1, s.image.header->alarm_head);
}

static void polls(struct config *config)
{
	(void)config;
	s.engine->lanes[0].alarm.list.polls = true;
}

/* As of a target that loses its alarm search between two looks. */
static void test_an_alarm_ends_in_the_journal_where_a_reload_has_it_polled(void)
{
	uint32_t head;

	alarm_house();
	scene_refuse_writes(&s, "/alarm" D "/latch.BYTE", -EIO);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, SCENE_S);
	head = s.image.header->alarm_head;
	scene_reload(&s, polls);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_POLLED, scene_attrs(&s, 1).flags);
	returned_after(head, OWS_ALARM_DEVICE);
}

static void without_limits(struct config *config)
{
	config->items->limits = (struct config_limits){0};
}

static void test_a_limit_alarm_ends_in_the_journal_where_a_reload_has_no_limits(void)
{
	struct config_item *room = scene_input(&s, "room", "/28.551DDF030000/temperature",
	                                       OWS_DOUBLE);
	uint32_t head;

	room->limits = (struct config_limits){
		.any = true,
		.has = {[CONFIG_LIMIT_H] = true},
		.limit = {[CONFIG_LIMIT_H] = 20},
	};
	scene_put(&s, "/28.551DDF030000/temperature", "21.5", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	head = s.image.header->alarm_head;
	TEST_ASSERT_EQUAL_UINT32(1, head);
	scene_reload(&s, without_limits);
	returned_after(head, OWS_ALARM_H);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT32(head + 1, s.image.header->alarm_head);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_alarms_go_on_and_the_journal_with_them);
	RUN_TEST(test_a_list_of_alarms_on_its_way_comes_over);
	RUN_TEST(test_the_journal_of_a_signal_that_is_gone_goes_with_it);
	RUN_TEST(test_an_alarm_that_stands_does_so_until_the_item_has_none);
	RUN_TEST(test_an_alarm_ends_in_the_journal_where_a_reload_has_it_polled);
	RUN_TEST(test_a_limit_alarm_ends_in_the_journal_where_a_reload_has_no_limits);
	return UNITY_END();
}
