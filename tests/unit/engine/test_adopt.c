/* SPDX-License-Identifier: MIT */
/* A reload in the engine: what stays goes on as if nothing had been. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/public/ows.h"
#include "tests/unit/aid/scene.h"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

/* Items of the file by name; a new one at its end, or in the place of another. */
static struct config_item *item_of(struct config *config, const char *name)
{
	for (unsigned i = 0; i < config->item_count; i++)
		if (strcmp(config->items[i].name, name) == 0)
			return &config->items[i];
	TEST_FAIL_MESSAGE("no such item");
	return NULL;
}

static void add(struct config *config, const char *name, const char *path)
{
	config->items[config->item_count++] = (struct config_item){.name = name,
	                                                           .path = path,
	                                                           .identity = path,
	                                                           .type = OWS_DOUBLE,
	                                                           .per_factor = 1,
	                                                           .readable = true,
	                                                           .init_text = "",
	                                                           .safe_text = ""};
}

static void house(void)
{
	scene_put(&s, "/28.551DDF030000/temperature", "21.5", 0);
	scene_put(&s, "/29.066418000000/PIO.0", "0", 0);
	scene_input(&s, "room", "/28.551DDF030000/temperature", OWS_DOUBLE);
	scene_output(&s, "pump", "/29.066418000000/PIO.0", OWS_BOOL);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

static void test_nothing_changes_when_nothing_was_changed(void)
{
	struct ows_sample room, pump, now;
	struct ows_attrs attrs;
	uint64_t periods;

	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	room = scene_sample(&s, 1);
	pump = scene_sample(&s, 2);
	attrs = scene_attrs(&s, 1);
	periods = scene_counter(&s, "periods");
	scene_clear_trace(&s);
	scene_reload(&s, NULL);
	now = scene_sample(&s, 1);
	TEST_ASSERT_EQUAL_MEMORY(&room, &now, sizeof(now));
	now = scene_sample(&s, 2);
	TEST_ASSERT_EQUAL_MEMORY(&pump, &now, sizeof(now));
	TEST_ASSERT_EQUAL_UINT32(attrs.transactions, scene_attrs(&s, 1).transactions);
	TEST_ASSERT_EQUAL_UINT32(attrs.per_base, scene_attrs(&s, 1).per_base);
	TEST_ASSERT_EQUAL_UINT64(periods, scene_counter(&s, "periods"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "reloads"));
	TEST_ASSERT_EQUAL_UINT32(1, scene_target_state(&s, 0));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_GREATER_THAN_UINT(8, s.reads);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void cellar_then_pump_then_room(struct config *config)
{
	struct config_item room = *item_of(config, "room"), pump = *item_of(config, "pump");

	config->item_count = 0;
	add(config, "cellar", "/28.000000000003/temperature");
	config->items[config->item_count++] = pump;
	config->items[config->item_count++] = room;
}

static void test_signals_go_on_in_another_place_of_the_file(void)
{
	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_put(&s, "/28.000000000003/temperature", "12.25", 0);
	scene_clear_trace(&s);
	scene_reload(&s, cellar_then_pump_then_room);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 3).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 3));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(12.25, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_set(&s, 2, 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, "/29.066418000000/PIO.0"));
}

static void test_what_was_commanded_just_before_is_written(void)
{
	house();
	scene_set(&s, 2, 1);
	scene_reload(&s, cellar_then_pump_then_room);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, "/29.066418000000/PIO.0"));
	TEST_ASSERT_EQUAL_UINT32(scene_slot(&s, 2)->stamp, scene_applied(&s, 2));
}

static void test_a_reading_in_flight_goes_on(void)
{
	struct ows_sample before;

	house();
	scene_run(&s, SCENE_S);
	s.bus[0].latency_ns = SCENE_S;
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	before = scene_sample(&s, 1);
	scene_put(&s, "/28.551DDF030000/temperature", "22", 0);
	scene_clear_trace(&s);
	scene_reload(&s, cellar_then_pump_then_room);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_IN_WORK, scene_attrs(&s, 3).flags);
	TEST_ASSERT_EQUAL_UINT32(before.count, scene_sample(&s, 3).count);
	scene_run(&s, 600 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(before.count + 1, scene_sample(&s, 3).count);
	TEST_ASSERT_EQUAL_UINT(1, s.reads); /* the cellar's */
	TEST_ASSERT_BITS_LOW(OWS_ATTR_IN_WORK, scene_attrs(&s, 3).flags);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT32(before.count + 3, scene_sample(&s, 3).count);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "unknown_answers"));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "late_answers"));
}

static void test_readings_arrive_though_reloads_come_faster_than_answers(void)
{
	uint32_t count;

	house();
	s.bus[0].latency_ns = SCENE_S;
	count = scene_sample(&s, 1).count;
	for (int i = 0; i < 100; i++) {
		scene_reload(&s, NULL);
		scene_run(&s, 100 * SCENE_MS);
	}
	TEST_ASSERT_GREATER_THAN_UINT32(count + 7, scene_sample(&s, 1).count);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void room_fresh(struct config *config)
{
	item_of(config, "room")->fresh = true;
}

static void room_unread(struct config *config)
{
	item_of(config, "room")->readable = false;
}

/* What was asked otherwise than the file now says is no answer to it. */
static void test_a_reading_in_flight_that_is_not_wanted_so_any_more_is_left(void)
{
	uint32_t count;

	house();
	s.bus[0].latency_ns = SCENE_S;
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	count = scene_sample(&s, 1).count;
	scene_reload(&s, room_fresh);
	scene_run(&s, 700 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(count, scene_sample(&s, 1).count);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(count + 1, scene_sample(&s, 1).count);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	scene_reload(&s, room_unread);
	scene_run(&s, 3 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(count + 1, scene_sample(&s, 1).count);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
}

static void without_room(struct config *config)
{
	config->items[0] = *item_of(config, "pump");
	config->item_count = 1;
}

static void test_a_request_of_a_signal_that_is_gone_outlives_several_reloads(void)
{
	house();
	s.bus[0].latency_ns = 3 * SCENE_S;
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	for (int i = 0; i < 5; i++) {
		scene_reload(&s, without_room);
		scene_run(&s, 100 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "unknown_answers"));
	scene_set(&s, 1, 1);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, "/29.066418000000/PIO.0"));
}

static void test_a_write_in_flight_ends_with_the_present_value(void)
{
	house();
	s.bus[0].latency_ns = 300 * SCENE_MS;
	scene_run(&s, SCENE_S);
	scene_set(&s, 2, 1);
	for (int i = 0; i < 40 && !strstr(s.trace, "W /29.066418000000/PIO.0=1"); i++)
		scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "W /29.066418000000/PIO.0=1"));
	scene_clear_trace(&s);
	scene_set(&s, 2, 0);
	scene_reload(&s, NULL);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, "/29.066418000000/PIO.0"));
	TEST_ASSERT_EQUAL_UINT32(scene_slot(&s, 2)->stamp, scene_applied(&s, 2));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
}

static void without_pump(struct config *config)
{
	config->item_count = 1;
}

static void test_an_output_that_is_gone_is_left_as_it_is(void)
{
	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
	scene_reload(&s, without_pump);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, "/29.066418000000/PIO.0"));
}

static void other_path(struct config *config)
{
	item_of(config, "pump")->path = "/29.066418000000/PIO.1";
}

static void test_a_command_for_another_path_is_not_carried(void)
{
	scene_put(&s, "/29.066418000000/PIO.1", "0", 0);
	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
	scene_reload(&s, other_path);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, "/29.066418000000/PIO.1"));
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, 2).quality);
}

/* --- Another name ----------------------------------------------------------------------------- */

static void new_name(struct config *config)
{
	config->items[1].name = "circulation";
}

static void each_others_names(struct config *config)
{
	config->items[0].name = "valve";
	config->items[1].name = "pump";
}

/* Who renames an output in Home Assistant does not want to switch it. */
static void test_an_output_that_was_renamed_keeps_its_command(void)
{
	scene_put(&s, "/29.066418000000/PIO.0", "0", 0);
	scene_input(&s, "room", "/28.551DDF030000/temperature", OWS_DOUBLE);
	scene_output(&s, "pump", "/29.066418000000/PIO.0", OWS_BOOL)->has_init = true;
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, "/29.066418000000/PIO.0"));
	scene_clear_trace(&s);
	scene_reload(&s, new_name);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_INT64(1, scene_sample(&s, 2).value);
	scene_expect(&s, 2, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SET, scene_origin(&s, 2).reason);
	TEST_ASSERT_EQUAL_STRING("controller0", scene_origin(&s, 2).who.name);
	/* and it is the one that a restart of the device asks for */
	scene_tell(&s, 0, BUS_POR, "/29.066418000000");
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("1", scene_at(&s, "/29.066418000000/PIO.0"));
}

static void test_outputs_that_swap_their_names_keep_their_commands(void)
{
	scene_put(&s, "/29.066418000000/PIO.0", "0", 0);
	scene_put(&s, "/29.066418000000/PIO.1", "0", 0);
	scene_output(&s, "pump", "/29.066418000000/PIO.0", OWS_BOOL);
	scene_output(&s, "valve", "/29.066418000000/PIO.1", OWS_BOOL);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
	scene_reload(&s, each_others_names);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_INT64(1, scene_sample(&s, 2).value);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SET, scene_origin(&s, 2).reason);
}

static void test_a_bad_signal_keeps_its_back_off(void)
{
	scene_put(&s, "/28.551DDF030000/temperature", "", -EIO);
	scene_put(&s, "/29.066418000000/PIO.0", "0", 0);
	scene_input(&s, "room", "/28.551DDF030000/temperature", OWS_DOUBLE);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 200 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(0, scene_sample(&s, 1).quality & 0xc0);
	scene_clear_trace(&s);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(1, s.reads);
	TEST_ASSERT_EQUAL_HEX8(0, scene_sample(&s, 1).quality & 0xc0);
}

static void slower(struct config *config)
{
	config->period_ns = 500 * SCENE_MS;
}

static void test_the_count_of_periods_goes_on_when_their_length_changes(void)
{
	uint64_t before;

	house();
	scene_run(&s, 10 * SCENE_S);
	before = scene_counter(&s, "periods");
	scene_reload(&s, slower);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_UINT64_WITHIN(1, before + 20, scene_counter(&s, "periods"));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_LESS_OR_EQUAL_UINT32(2,
	                                 scene_sample(&s, 0).count - scene_attrs(&s, 1).per_base);
}

static void slowest(struct config *config)
{
	config->period_ns = 60 * SCENE_S;
}

/*
 * So many periods that, were they as long as the new ones, owsd would have run for four centuries.
 */
static void test_the_count_of_periods_goes_on_after_years(void)
{
	uint64_t before;
	int64_t measured_ns;

	house();
	s.now_ns += 7 * INT64_C(365) * 86400 * SCENE_S;
	scene_run(&s, 10 * SCENE_S);
	before = scene_counter(&s, "periods");
	TEST_ASSERT_GREATER_THAN_UINT64(UINT64_C(2000000000), before);
	scene_reload(&s, slowest);
	measured_ns = scene_sample(&s, 1).measured_ns;
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_UINT64_WITHIN(1, before + 10, scene_counter(&s, "periods"));
	TEST_ASSERT_GREATER_THAN_INT64(measured_ns + 500 * SCENE_S,
	                               scene_sample(&s, 1).measured_ns);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_LESS_OR_EQUAL_UINT32(2,
	                                 scene_sample(&s, 0).count - scene_attrs(&s, 1).per_base);
}

static void other_alias(struct config *config)
{
	add(config, "late", "/28.000000000009/temperature");
	item_of(config, "late")->stale_after_ns = 5 * SCENE_S;
	item_of(config, "late")->limits = (struct config_limits){
		.any = true, .has = {[CONFIG_LIMIT_H] = true}, .limit = {[CONFIG_LIMIT_H] = 100}};
}

static void test_a_new_signal_is_not_stale_from_its_first_moment(void)
{
	house();
	scene_run(&s, 60 * SCENE_S);
	s.bus[0].slow = "/28.000000000009/temperature";
	s.bus[0].slow_ns = 15 * SCENE_S;
	scene_put(&s, "/28.000000000009/temperature", "20", 0);
	scene_reload(&s, other_alias);
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(0, scene_attrs(&s, 3).limit_condition);
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_STALE, scene_attrs(&s, 3).limit_condition);
}

static void room_not_read(struct config *config)
{
	item_of(config, "room")->readable = false;
}

static void room_read(struct config *config)
{
	item_of(config, "room")->readable = true;
}

static void test_a_signal_that_is_not_read_any_more_is_not_good(void)
{
	house();
	scene_reload(&s, room_not_read);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, value_number(OWS_DOUBLE, scene_sample(&s, 1).value));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	scene_reload(&s, room_read);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void room_has_a_limit(struct config *config)
{
	item_of(config, "room")->limits = (struct config_limits){
		.any = true, .has = {[CONFIG_LIMIT_H] = true}, .limit = {[CONFIG_LIMIT_H] = 20}};
}

static void test_a_limit_that_is_new_knows_no_value_before_its_first(void)
{
	house();
	scene_reload(&s, room_has_a_limit);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_H, scene_attrs(&s, 1).limit_condition);
	TEST_ASSERT_EQUAL_UINT32(1, s.image.header->alarm_head);
	TEST_ASSERT_EQUAL_HEX8(OWS_JOURNAL_AFTER, s.image.alarms[0].flags);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, value_number(OWS_DOUBLE, s.image.alarms[0].after));
}

static void second_first(struct config *config)
{
	config->targets[0] = (struct config_target){.text = "other", .group = 0};
	config->targets[1] = (struct config_target){
		.text = "scene", .group = 1, .relation = CONFIG_COMMA};
	config->target_count = 2;
}

static void test_a_target_keeps_its_signals_when_it_is_named_second(void)
{
	struct scene_bus *other;

	house();
	other = scene_bus(&s, "other", 1);
	s.config.target_count = 1;
	scene_clear_trace(&s);
	TEST_ASSERT_NOT_NULL(other);
	scene_reload(&s, second_first);
	TEST_ASSERT_EQUAL_UINT32(1, scene_target_state(&s, 1));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT8(1, scene_sample(&s, 1).target);
	scene_up_on(&s, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT8(1, scene_sample(&s, 1).target);
	TEST_ASSERT_EQUAL_UINT(0, other->writes);
}

static void only_other(struct config *config)
{
	config->targets[0] = (struct config_target){.text = "other", .group = 0};
	config->target_count = 1;
}

static void test_a_value_of_a_target_that_is_gone_is_not_good(void)
{
	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_bus(&s, "other", 1);
	s.config.target_count = 1;
	scene_plug(&s, "/28.551DDF030000", 1);
	scene_plug(&s, "/29.066418000000", 1);
	scene_clear_trace(&s);
	scene_reload(&s, only_other);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, 1).quality);
	scene_up_on(&s, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: W /29.066418000000/PIO.0=1"));
}

static void other_and_not_writable(struct config *config)
{
	only_other(config);
	item_of(config, "pump")->writable = false;
}

/* Nothing reads it, and nothing is to be written: the target that was down is not its own now. */
static void test_an_output_of_a_target_that_was_down_and_is_gone_is_not_target_down(void)
{
	house();
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ENOTCONN);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
	scene_bus(&s, "other", 1);
	s.config.target_count = 1;
	scene_plug(&s, "/29.066418000000", 1);
	scene_reload(&s, other_and_not_writable);
	scene_up_on(&s, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 2).err);
}

static void test_a_silent_bus_stays_stuck_and_gives_back_what_it_had(void)
{
	house();
	s.bus[0].mute = true;
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	scene_reload(&s, cellar_then_pump_then_room);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 3).quality);
	s.bus[0].mute = false;
	for (unsigned i = 0; i < s.bus[0].swallowed_count; i++)
		scene_answer(&s, s.bus[0].swallowed[i]->id, 0, "20", s.bus[0].swallowed[i]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 3).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 3));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_nothing_changes_when_nothing_was_changed);
	RUN_TEST(test_signals_go_on_in_another_place_of_the_file);
	RUN_TEST(test_what_was_commanded_just_before_is_written);
	RUN_TEST(test_a_reading_in_flight_goes_on);
	RUN_TEST(test_readings_arrive_though_reloads_come_faster_than_answers);
	RUN_TEST(test_a_reading_in_flight_that_is_not_wanted_so_any_more_is_left);
	RUN_TEST(test_a_request_of_a_signal_that_is_gone_outlives_several_reloads);
	RUN_TEST(test_a_write_in_flight_ends_with_the_present_value);
	RUN_TEST(test_an_output_that_is_gone_is_left_as_it_is);
	RUN_TEST(test_a_command_for_another_path_is_not_carried);
	RUN_TEST(test_an_output_that_was_renamed_keeps_its_command);
	RUN_TEST(test_outputs_that_swap_their_names_keep_their_commands);
	RUN_TEST(test_a_bad_signal_keeps_its_back_off);
	RUN_TEST(test_the_count_of_periods_goes_on_when_their_length_changes);
	RUN_TEST(test_the_count_of_periods_goes_on_after_years);
	RUN_TEST(test_a_new_signal_is_not_stale_from_its_first_moment);
	RUN_TEST(test_a_signal_that_is_not_read_any_more_is_not_good);
	RUN_TEST(test_a_limit_that_is_new_knows_no_value_before_its_first);
	RUN_TEST(test_a_target_keeps_its_signals_when_it_is_named_second);
	RUN_TEST(test_a_value_of_a_target_that_is_gone_is_not_good);
	RUN_TEST(test_an_output_of_a_target_that_was_down_and_is_gone_is_not_target_down);
	RUN_TEST(test_a_silent_bus_stays_stuck_and_gives_back_what_it_had);
	return UNITY_END();
}
