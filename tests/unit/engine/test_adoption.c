/* SPDX-License-Identifier: MIT */
/* What a reload keeps of the targets: a pure comparison of two configurations. */
#include "unity.h"

#include "src/engine/adoption.h"

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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_ways_to_a_wire_stay_all_or_none);
	RUN_TEST(test_a_target_whose_options_changed_is_opened_anew);
	return UNITY_END();
}
