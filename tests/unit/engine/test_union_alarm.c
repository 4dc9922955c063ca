/* SPDX-License-Identifier: MIT */
/* Alarm items of devices that go from one wire to another. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"
#include "tests/unit/aid/two_wires.h"

static struct scene s;

void setUp(void)
{
	two_wires_begin(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

static void door(void)
{
	alarm_item(&s, "door", SENSED, "latch.BYTE", "por", "set_alarm=133333333", "latch.BYTE=0")
		->fresh = true;
	scene_put_on(&s, 0, SENSED, "0", 0);
	scene_put_on(&s, 0, D3 "/latch.BYTE", "0", 0);
	scene_put_on(&s, 0, D3 "/por", "0", 0);
	scene_put_on(&s, 0, D3 "/set_alarm", "133333333", 0);
	scene_put_on(&s, 0, "/alarm", "", 0);
	scene_put_on(&s, 1, "/alarm", "", 0);
}

static void test_a_target_without_alarm_items_is_not_asked_for_alarms(void)
{
	door();
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[0].lists);
	TEST_ASSERT_EQUAL_UINT(0, s.bus[1].lists);
}

static void test_an_alarm_item_is_armed_and_served_where_its_device_is_now(void)
{
	door();
	two_wires_up(&s);
	scene_run(&s, SCENE_S);
	scene_plug(&s, D3, 1);
	scene_put_on(&s, 1, D3 "/set_alarm", "000000000", 0);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_clear_trace(&s);
	s.bus[0].lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(1, s.bus[0].lists);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[1].lists);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: W " D3 "/set_alarm=133333333"));
	/* an alarm there is seen, from the power-on flag on */
	scene_put_on(&s, 1, D3 "/latch.BYTE", "4", 0);
	scene_put_on(&s, 1, "/alarm", D3 "\n", 0);
	scene_clear_trace(&s);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "1: r " D3 "/por\n1: r " D3 "/latch.BYTE"));
	TEST_ASSERT_GREATER_THAN_UINT32(0, scene_attrs(&s, 1).alarms);
}

static void test_the_machine_goes_on_when_the_item_it_works_on_moves(void)
{
	door();
	s.bus[0].slow = D3 "/por";
	s.bus[0].slow_ns = 500 * SCENE_MS;
	scene_input(&s, "t1", T1, OWS_DOUBLE)->alarm = true;
	scene_put_on(&s, 0, T1, "21", 0);
	scene_put_on(&s, 0, "/alarm", D3 "\n", 0);
	two_wires_up(&s);
	scene_run(&s, 300 * SCENE_MS); /* the read of por is on its way */
	scene_plug(&s, D3, 1);
	scene_put_on(&s, 0, "/alarm", "", 0);
	scene_put_on(&s, 1, "/alarm", D3 "\n", 0);
	scene_put_on(&s, 1, D3 "/latch.BYTE", "4", 0);
	scene_tell(&s, 0, BUS_LOST, D3);
	scene_run(&s, 600 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	s.bus[0].lists = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.bus[0].lists);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_target_without_alarm_items_is_not_asked_for_alarms);
	RUN_TEST(test_an_alarm_item_is_armed_and_served_where_its_device_is_now);
	RUN_TEST(test_the_machine_goes_on_when_the_item_it_works_on_moves);
	return UNITY_END();
}
