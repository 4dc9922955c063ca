/* SPDX-License-Identifier: MIT */
/* A start with alarm items: outputs do not wait for them, and no request is made twice. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"

#define PIO D "/PIO.BYTE"
#define RELAYS "/29.000000000099/PIO.BYTE" /* of a device without alarm item */

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}
void tearDown(void)
{
	scene_end(&s);
}

static void begin(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
}

static void output(const char *name, const char *path)
{
	struct config_item *out = scene_output(&s, name, path, OWS_BYTE);

	out->has_init = true;
	out->init_value = 3;
	scene_put(&s, path, "0", 0);
}

static unsigned count(const char *line)
{
	unsigned n = 0;

	for (const char *at = s.trace; (at = strstr(at, line)) != NULL; at += strlen(line))
		n++;
	return n;
}

/* Alarm items on that many boards, which are armed otherwise and none of which is in alarm. */
static void boards(unsigned boards)
{
	static char path[24][3][48], name[24][8];

	for (unsigned i = 0; i < boards; i++) {
		snprintf(name[i], sizeof(name[i]), "in%u", i);
		snprintf(path[i][0], sizeof(path[i][0]), "/29.00000000%04X/sensed.BYTE", i + 1);
		snprintf(path[i][1], sizeof(path[i][1]), "/29.00000000%04X/set_alarm", i + 1);
		alarm_item(&s, name[i], path[i][0], "latch.BYTE", "por", "set_alarm=133333333",
		           "latch.BYTE=0");
		scene_put(&s, path[i][0], "255", 0);
		scene_put(&s, path[i][1], "000000000", 0);
	}
	scene_put(&s, "/alarm", "", 0);
}

/* Where the line stands first in the trace. */
static size_t place(const char *line)
{
	const char *at = strstr(s.trace, line);

	TEST_ASSERT_NOT_NULL_MESSAGE(at, line);
	return (size_t)(at - s.trace);
}

static void test_outputs_have_their_init_value_before_the_first_list_and_any_arming(void)
{
	boards(20);
	output("relays", RELAYS);
	output("more", "/29.000000000098/PIO.BYTE");
	begin();
	TEST_ASSERT_EQUAL_STRING_LEN("W " RELAYS "=3\nW /29.000000000098/PIO.BYTE=3\n", s.trace,
	                             strlen("W " RELAYS "=3\nW " RELAYS "=3\n"));
	TEST_ASSERT_EQUAL_UINT(20, count("/set_alarm=133333333\n"));
}

/* Every write of it commands another value, as a control program without rest does. */
static unsigned commands;

static void command_again(struct scene *scene, const char *path, const char *data, uint32_t len)
{
	(void)data;
	(void)len;
	if (strcmp(path, RELAYS) == 0)
		scene_set(scene, 21, 4 + commands++ % 100);
}

static void test_outputs_that_change_without_rest_do_not_stop_the_arming(void)
{
	boards(20);
	output("relays", RELAYS);
	s.on_write = command_again;
	s.no_trace = true;
	begin();
	TEST_ASSERT_GREATER_THAN_UINT(100, commands);
	for (unsigned i = 1; i <= 20; i++) {
		char path[48];

		snprintf(path, sizeof(path), "/29.00000000%04X/set_alarm", i);
		TEST_ASSERT_EQUAL_STRING("133333333", scene_at(&s, path));
	}
}

static void test_after_max_cons_alarms_were_armed_a_reading_goes_through(void)
{
	s.config.max_cons_alarms = 2;
	boards(6);
	scene_input(&s, "t", T_TEMP, OWS_DOUBLE);
	scene_put(&s, T_TEMP, "21", 0);
	begin();
	/* the first reading is that of the end of the first cycle */
	TEST_ASSERT_LESS_THAN_size_t(place("W /29.000000000003/set_alarm"),
	                             place("R /29.000000000002/sensed.BYTE"));
	TEST_ASSERT_GREATER_THAN_size_t(place("W /29.000000000002/set_alarm"),
	                                place("R /29.000000000002/sensed.BYTE"));
	TEST_ASSERT_LESS_THAN_size_t(place("W /29.000000000005/set_alarm"),
	                             place("R /29.000000000003/sensed.BYTE"));
}

static void test_a_board_that_was_switched_on_with_owsd_gets_its_set_alarm_once(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "1");
	scene_put(&s, D "/set_alarm", "000000000", 0);
	s.on_read = alarm_on_read;
	begin();
	TEST_ASSERT_EQUAL_UINT(1, count("/set_alarm=133333333\n"));
	TEST_ASSERT_EQUAL_UINT(0, count("r " D "/set_alarm"));
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
}

static void test_an_output_that_has_its_command_does_not_go_back_to_its_init_value(void)
{
	figure_3_3(&s);
	output("relays", PIO);
	alarm_device(&s, "0", "1");
	s.on_read = alarm_on_read;
	scene_start(&s);
	scene_set(&s, 2, 7);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, count("W " PIO "=3\n"));
	TEST_ASSERT_EQUAL_UINT(2, count("W " PIO "=7\n")); /* the board may have restarted since */
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "power_on_resets"));
}

static void test_a_value_that_the_machine_has_read_is_not_read_as_an_input_besides(void)
{
	figure_3_3(&s);
	alarm_device(&s, "1", "0");
	s.on_read = alarm_on_read;
	begin();
	TEST_ASSERT_EQUAL_UINT(2, count("r " D "/sensed.BYTE\n") +
	                                  count("r /alarm" D "/sensed.BYTE\n"));
	TEST_ASSERT_EQUAL_UINT(0, count("R " D "/sensed.BYTE\n"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_outputs_have_their_init_value_before_the_first_list_and_any_arming);
	RUN_TEST(test_outputs_that_change_without_rest_do_not_stop_the_arming);
	RUN_TEST(test_after_max_cons_alarms_were_armed_a_reading_goes_through);
	RUN_TEST(test_a_board_that_was_switched_on_with_owsd_gets_its_set_alarm_once);
	RUN_TEST(test_an_output_that_has_its_command_does_not_go_back_to_its_init_value);
	RUN_TEST(test_a_value_that_the_machine_has_read_is_not_read_as_an_input_besides);
	return UNITY_END();
}
