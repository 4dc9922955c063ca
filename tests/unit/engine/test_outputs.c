/* SPDX-License-Identifier: MIT */
/* What becomes of a commanded value: when it is written, when not, and what its stamp tells. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
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

#define T1 "/28.551DDF030000/temperature12"
#define PIO "/29.B89115000000/PIO.BYTE"
#define PIO_A "/29.B89115000000/PIO.0"

static void one_output(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
}

static void disable_writing(unsigned record)
{
	scene_enable_writes(&s, record, false);
}

static void shoot_once(unsigned record)
{
	scene_slot(&s, record)->one_shot++;
	scene_ring(&s, record);
}

static void test_a_value_is_not_applied_while_another_is_on_its_way(void)
{
	one_output();
	s.bus[0].latency_ns = 50 * SCENE_MS;
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	scene_set(&s, 1, 4);
	scene_run(&s, 20 * SCENE_MS);
	scene_set(&s, 1, 3);
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT32(3, scene_applied(&s, 1));
}

static void test_a_refused_set_is_never_applied(void)
{
	one_output();
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	scene_set(&s, 1, 256);
	scene_run(&s, SCENE_S);
	shoot_once(1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
}

static void test_a_one_shot_that_fails_is_tried_again(void)
{
	one_output();
	disable_writing(1);
	scene_set(&s, 1, 3);
	scene_put(&s, PIO, NULL, -EIO);
	shoot_once(1);
	scene_run(&s, 150 * SCENE_MS);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(1, s.writes);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	scene_clear_trace(&s);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void test_a_one_shot_comes_in_its_turn_though_inputs_are_always_due(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, T1, "21.5", 0);
	scene_put(&s, PIO, "0", 0);
	s.bus[0].latency_ns = 250 *
	                      SCENE_MS; /* more than a period: the input is due again at once */
	scene_start(&s);
	scene_up(&s);
	disable_writing(2);
	scene_set(&s, 2, 3);
	shoot_once(2);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(10, s.reads);
}

static void test_the_write_that_finds_the_device_again_is_not_repeated(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_output(&s, "other", PIO_A, OWS_BOOL);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO_A, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	scene_put(&s, PIO, NULL, -ENODEV);
	scene_set(&s, 1, 3);
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, 1).quality);
	scene_clear_trace(&s);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO_A, "0", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=3\nW " PIO_A "=1\n", s.trace);
}

static void test_outputs_of_a_device_that_was_lost_and_found_are_written_again(void)
{
	struct bus_event event = {.news = BUS_LOST};
	struct path path;

	TEST_ASSERT_EQUAL_INT(0, path_split(PIO, strlen(PIO), &path));
	memcpy(event.rom, path.rom, sizeof(event.rom));
	one_output();
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	engine_event(s.engine, 0, &event, s.now_ns);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	event.news = BUS_FOUND;
	engine_event(s.engine, 0, &event, s.now_ns);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
}

/* A set of an input is not kept: by then somebody may have changed it at the device. */
static void test_what_was_written_to_an_input_is_not_written_again_when_its_device_returns(void)
{
	scene_input(&s, "setpoint", PIO, OWS_BYTE)->writable = true;
	scene_output(&s, "out", PIO_A, OWS_BOOL);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO_A, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 1, 3);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
	scene_put(&s, PIO, NULL, -ENODEV);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_NO_DEVICE, 0);
	scene_put(&s, PIO, "8", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_INT64(8, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_UINT(3, s.writes);
	/* the same number is another set */
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	/* but what could not be written to it is */
	scene_put(&s, PIO, NULL, -ENODEV);
	scene_run(&s, 2 * SCENE_S);
	scene_set(&s, 1, 4);
	scene_run(&s, SCENE_S);
	scene_put(&s, PIO, "8", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("4", scene_at(&s, PIO));
}

static void test_a_place_left_in_order_passes_no_outputs_on_to_who_takes_it_next(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->has_safe = true;
	item->safe_value = 128;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	giving_beat(&s.controllers[0], 500);
	scene_set(&s, 1, 3);
	scene_run(&s, 300 * SCENE_MS);
	scene_goodbye(&s, 0);
	scene_run(&s, 300 * SCENE_MS);
	scene_join(&s, 0, 2);
	giving_beat(&s.controllers[0], 500);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "lost_controllers"));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "safe_outputs"));
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
}

static void test_an_output_in_doubt_is_not_good_when_its_target_returns(void)
{
	one_output();
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, 1).quality);
	s.config.max_retries = 0;
	scene_put(&s, PIO, NULL, -EINPROGRESS);
	scene_set(&s, 1, 4);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	scene_down(&s, -ECONNRESET);
	scene_up(&s);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_is_not_applied_while_another_is_on_its_way);
	RUN_TEST(test_a_refused_set_is_never_applied);
	RUN_TEST(test_a_one_shot_that_fails_is_tried_again);
	RUN_TEST(test_a_one_shot_comes_in_its_turn_though_inputs_are_always_due);
	RUN_TEST(test_the_write_that_finds_the_device_again_is_not_repeated);
	RUN_TEST(test_outputs_of_a_device_that_was_lost_and_found_are_written_again);
	RUN_TEST(test_what_was_written_to_an_input_is_not_written_again_when_its_device_returns);
	RUN_TEST(test_a_place_left_in_order_passes_no_outputs_on_to_who_takes_it_next);
	RUN_TEST(test_an_output_in_doubt_is_not_good_when_its_target_returns);
	return UNITY_END();
}
