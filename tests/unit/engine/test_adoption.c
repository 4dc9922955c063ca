/* SPDX-License-Identifier: MIT */
/* What a reload keeps: targets, by a comparison of two configurations; signals and lanes, whole. */
#include <string.h>

#include "unity.h"

#include "src/config/read/buses.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/reload/adopt.h"
#include "src/daemon/engine/reload/adoption.h"

/* A byte that is valid in every member, a bool too, and that nothing has by itself. */
#define PATTERN 1

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_ways_to_a_wire_stay_all_or_none(void)
{
	struct config_target before[] = {{.text = "a", .group = 0},
	                                 {.text = "b", .group = 0, .relation = CONFIG_BAR},
	                                 {.text = "c", .group = 1, .relation = CONFIG_COMMA}};
	struct config_target now[] = {{.text = "c", .group = 0},
	                              {.text = "a", .group = 1, .relation = CONFIG_COMMA}};
	struct config old = {.targets = before, .target_count = 3};
	struct config config = {.targets = now, .target_count = 2};
	struct adoption plan;

	TEST_ASSERT_EQUAL_INT(0, adoption_plan(&plan, &config, &old));
	TEST_ASSERT_EQUAL_INT(2, plan.ports[0]);
	TEST_ASSERT_EQUAL_INT(-1, plan.ports[1]);
	TEST_ASSERT_EQUAL_UINT(1, plan.kept_ports);
	adoption_free(&plan);
}

static void test_a_target_whose_options_changed_is_opened_anew(void)
{
	struct config_target targets[] = {{.text = "i2c:/dev/i2c-1"}};
	struct config_option on = {.key = "ActivePullUp", .text = "on"};
	struct config_option off = {.key = "ActivePullUp", .text = "off"};
	struct config_bus a = {.target = "i2c:/dev/i2c-1", .options = &on, .option_count = 1};
	struct config_bus b = {.target = "i2c:/dev/i2c-1", .options = &off, .option_count = 1};
	struct config old = {.targets = targets, .target_count = 1, .buses = &a, .bus_count = 1};
	struct config config = old;
	struct adoption plan;

	TEST_ASSERT_EQUAL_INT(0, adoption_plan(&plan, &config, &old));
	TEST_ASSERT_EQUAL_INT(0, plan.ports[0]);
	adoption_free(&plan);
	config.buses = &b;
	TEST_ASSERT_EQUAL_INT(0, adoption_plan(&plan, &config, &old));
	TEST_ASSERT_EQUAL_INT(-1, plan.ports[0]);
	adoption_free(&plan);
}

/* Every byte from `from` to before `to` is the pattern. */
#define ASSERT_CARRIED(object, from, to) \
	TEST_ASSERT_EACH_EQUAL_HEX8( \
		PATTERN, (const uint8_t *)&(object) + offsetof(__typeof__(object), from), \
		offsetof(__typeof__(object), to) - offsetof(__typeof__(object), from))

static void test_a_signal_that_stays_loses_nothing_over_a_reload(void)
{
	const struct config_item item = {.type = OWS_STRING, .limits.any = true};
	char before[3][TABLE_TEXT_CAP], now[3][TABLE_TEXT_CAP];
	struct signal s, was;

	memset(before, PATTERN, sizeof(before));
	memset(now, 0, sizeof(now));
	memset(&was, PATTERN, sizeof(was));
	memset(&s, 0, sizeof(s));
	was.item = s.item = &item;
	was.text = before[0];
	was.command_text = before[1];
	was.written_text = before[2];
	s.text = now[0];
	s.command_text = now[1];
	s.written_text = now[2];
	signal_adopt(&s, &was);
	memset(&s.attrs.flags, PATTERN, sizeof(s.attrs.flags)); /* they have rules of their own */
	ASSERT_CARRIED(s, sample, text);
	TEST_ASSERT_EQUAL_MEMORY(before, now, sizeof(now));
	TEST_ASSERT_EQUAL_PTR(now[0], s.text);
}

static void test_an_output_that_became_an_input_takes_no_command_along(void)
{
	const struct config_item output = {.type = OWS_BOOL, .output = true};
	const struct config_item input = {.type = OWS_BOOL};
	struct signal was = {.item = &output, .command.given = true, .command.value = 1};
	struct signal s = {.item = &input};

	signal_adopt(&s, &was);
	TEST_ASSERT_FALSE(s.command.given);
}

static void test_a_lane_that_stays_loses_nothing_over_a_reload(void)
{
	struct lane before, lane;

	memset(&before, PATTERN, sizeof(before));
	memset(&lane, 0, sizeof(lane));
	before.depth = 0; /* so that no slot of the pattern is looked at */
	lane_adopt(&lane, &before, NULL);
	ASSERT_CARRIED(lane, state, inputs);
	TEST_ASSERT_EACH_EQUAL_HEX8(PATTERN, &lane.counters, sizeof(lane.counters));
	TEST_ASSERT_NULL(before.lent.slots);
	TEST_ASSERT_EQUAL_UINT(0, before.lent.count);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_ways_to_a_wire_stay_all_or_none);
	RUN_TEST(test_a_target_whose_options_changed_is_opened_anew);
	RUN_TEST(test_a_signal_that_stays_loses_nothing_over_a_reload);
	RUN_TEST(test_an_output_that_became_an_input_takes_no_command_along);
	RUN_TEST(test_a_lane_that_stays_loses_nothing_over_a_reload);
	return UNITY_END();
}
