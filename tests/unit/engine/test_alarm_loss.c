/* SPDX-License-Identifier: MIT */
/* The alarm machine when its device or its target is lost while it works. */
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

static void test_a_device_that_fails_is_left_for_the_next_alarm(void)
{
	figure_3_3(&s);
	alarm_item(&s, "second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
	alarm_device(&s, "1", "0");
	scene_put(&s, E "/sensed.BYTE", "77", 0);
	scene_put(&s, E "/latch.BYTE", "0", 0);
	alarm_begin(&s);
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
	static const char *const all[] = {D "/por", D "/latch.BYTE", D "/sensed.BYTE",
	                                  D "/set_alarm", D "/PIO.BYTE"};

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
		figure_3_3(&s);
		alarm_item(&s, "second", E "/sensed.BYTE", "latch.BYTE", "", NULL, "latch.BYTE=0");
		out = scene_output(&s, "out", D "/PIO.BYTE", OWS_BYTE);
		out->has_init = true;
		out->init_value = 3;
		alarm_device(&s, "0", "0");
		scene_put(&s, E "/sensed.BYTE", "77", 0);
		scene_put(&s, E "/latch.BYTE", "0", 0);
		alarm_begin(&s);
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
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_that_fails_is_left_for_the_next_alarm);
	RUN_TEST(test_a_device_that_vanishes_in_any_state_does_not_stop_the_machine);
	RUN_TEST(test_a_lost_target_begins_the_machine_anew);
	return UNITY_END();
}
