/* SPDX-License-Identifier: MIT */
/* Tests of lanes: which request goes to a bus, and when. */
#include <errno.h>
#include <string.h>

#include "unity.h"

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
#define T2 "/28.063BC8040000/temperature12"
#define T3 "/28.B8BDBC020000/temperature12"
#define PIO "/29.B89115000000/PIO.BYTE"
#define PIO2 "/3A.B89115000000/PIO.BYTE"

static void three_thermometers(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_input(&s, "t3", T3, OWS_DOUBLE);
	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, T2, "       22.25", 0);
	scene_put(&s, T3, "          -1", 0);
}

static void test_inputs_are_read_in_the_order_of_the_file_once_a_period(void)
{
	three_thermometers();
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 99 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("R " T1 "\nR " T2 "\nR " T3 "\n", s.trace);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("R " T1 "\nR " T2 "\nR " T3 "\nR " T1 "\nR " T2 "\nR " T3 "\n",
	                         s.trace);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(-1, scene_number(&s, 3));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_the_cycle_goes_on_where_it_stopped_when_a_period_is_too_short(void)
{
	three_thermometers();
	s.bus[0].latency_ns = 70 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 6 * 70 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING_LEN("R " T1 "\nR " T2 "\nR " T3 "\nR " T1 "\nR " T2 "\nR " T3 "\n",
	                             s.trace, 6 * (sizeof(T1) + 2));
}

static void test_one_request_at_a_time_goes_to_a_bus_of_depth_one(void)
{
	three_thermometers();
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].most_pending);
}

static void test_all_due_inputs_go_at_once_to_a_bus_that_takes_them(void)
{
	three_thermometers();
	s.bus[0].depth = 8;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(3, s.bus[0].most_pending);
}

static void test_at_most_one_write_is_in_work(void)
{
	for (int i = 0; i < 4; i++)
		scene_output(&s, &"abcd"[i], PIO, OWS_BYTE)->has_init = true;
	scene_put(&s, PIO, "0", 0);
	s.bus[0].depth = 8;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].most_pending);
	TEST_ASSERT_EQUAL_UINT(4, s.writes);
}

static void test_nothing_goes_out_while_the_target_is_down(void)
{
	three_thermometers();
	scene_start(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, 1).quality);
}

static void test_an_input_shows_its_init_value_until_it_is_read(void)
{
	struct config_item *item = scene_input(&s, "t1", T1, OWS_LONG);

	item->has_init = true;
	item->init_value = -47;
	scene_start(&s);
	TEST_ASSERT_EQUAL_INT64(-47, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 1).measured_ns);
}

/* How often the image was published for a record: two steps of its sequence each time. */
static uint32_t published(unsigned record)
{
	return s.image.records[record].seq / 2;
}

static void test_a_reading_is_published_once_when_it_ends(void)
{
	uint32_t before;

	three_thermometers();
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	before = published(1);
	scene_clear_trace(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(10, published(1) - before);
	TEST_ASSERT_EQUAL_UINT(10 * 3 * (sizeof(T1) + 2), strlen(s.trace));
}

static void test_a_reading_that_outlasts_a_period_is_shown_in_work(void)
{
	three_thermometers();
	s.bus[0].latency_ns = 250 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 99 * SCENE_MS);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_IN_WORK, scene_attrs(&s, 1).flags);
	scene_run(&s, SCENE_MS);
	TEST_ASSERT_BITS_HIGH(OWS_ATTR_IN_WORK, scene_attrs(&s, 1).flags);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 0).per_base - scene_attrs(&s, 1).pend_base);
	scene_run(&s, 150 * SCENE_MS);
	TEST_ASSERT_BITS_LOW(OWS_ATTR_IN_WORK, scene_attrs(&s, 1).flags);
}

static void test_a_per_factor_spaces_the_reads_from_begin_to_begin(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE)->per_factor = 10;
	scene_put(&s, T1, "1", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 100 * 100 * SCENE_MS - 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(10, s.reads);
}

static void test_a_fresh_item_is_read_past_the_cache(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE)->fresh = true;
	scene_put(&s, T1, "1", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("r " T1 "\n", s.trace);
}

static void test_an_init_value_is_written_once_at_start_before_any_read(void)
{
	struct config_item *item;

	scene_input(&s, "t1", T1, OWS_DOUBLE);
	item = scene_output(&s, "relay", PIO, OWS_BYTE);
	item->has_init = true;
	item->init_value = 5;
	scene_put(&s, T1, "1", 0);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, 2).quality);
	scene_up(&s);
	scene_run(&s, 250 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=5\nR " T1 "\nR " T1 "\nR " T1 "\n", s.trace);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_INT64(5, scene_sample(&s, 2).value);
}

static void test_an_output_without_init_value_waits_for_a_command(void)
{
	scene_output(&s, "relay", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_set(&s, 1, 3);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=3\n", s.trace);
}

static void test_a_command_given_before_the_start_takes_the_place_of_the_init_value(void)
{
	struct config_item *item = scene_output(&s, "relay", PIO, OWS_BYTE);

	item->has_init = true;
	item->init_value = 5;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_set(&s, 1, 9);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=9\n", s.trace);
}

static void test_only_a_change_is_written(void)
{
	scene_output(&s, "relay", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	for (int i = 0; i < 20; i++) {
		scene_set(&s, 1, 3);
		scene_run(&s, 100 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_UINT32(20, scene_applied(&s, 1));
}

static void test_the_value_of_the_moment_counts_and_back_is_no_change(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_output(&s, "relay", PIO, OWS_BYTE);
	scene_put(&s, T1, "1", 0);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 1);
	scene_run(&s, 150 * SCENE_MS);
	scene_clear_trace(&s);
	s.bus[0].latency_ns = 50 * SCENE_MS;
	scene_run(&s, 60 * SCENE_MS); /* a read is in work */
	scene_set(&s, 2, 2);
	engine_step(s.engine, s.now_ns);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void test_outputs_are_written_in_the_order_of_the_file_not_of_the_commands(void)
{
	scene_output(&s, "a", PIO, OWS_BYTE);
	scene_output(&s, "b", PIO2, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO2, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 2);
	scene_set(&s, 1, 1);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=1\nW " PIO2 "=2\n", s.trace);
}

static void test_inputs_are_read_though_outputs_change_all_the_time(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_output(&s, "a", PIO, OWS_BYTE);
	scene_output(&s, "b", PIO2, OWS_BYTE);
	scene_put(&s, T1, "1", 0);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO2, "0", 0);
	s.bus[0].latency_ns = 40 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	for (int i = 0; i < 1000; i++) {
		scene_set(&s, 2, i & 255);
		scene_set(&s, 3, i & 255);
		scene_run(&s, 10 * SCENE_MS);
	}
	/* two writes to one read, 250 requests in 10 s, and 10 looks for the devices */
	TEST_ASSERT_INT_WITHIN(3, 80, s.reads);
	TEST_ASSERT_INT_WITHIN(3, 160, s.writes);
}

static void test_an_input_that_is_writable_is_written_on_command_but_not_at_start(void)
{
	struct config_item *item = scene_input(&s, "relay", PIO, OWS_BYTE);

	item->writable = true;
	item->has_init = true;
	item->init_value = 7;
	scene_put(&s, PIO, "1", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 150 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_set(&s, 1, 4);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_STRING("4", scene_at(&s, PIO));
}

static void test_a_read_back_that_differs_is_published_and_causes_no_write(void)
{
	scene_output(&s, "relay", PIO, OWS_BYTE)->readable = true;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 1, 1);
	scene_run(&s, 150 * SCENE_MS);
	scene_put(&s, PIO, "8", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_INT64(8, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_INT64(1, scene_attrs(&s, 1).commanded);
}

static void test_the_time_of_the_last_attempt_does_not_go_back_to_a_read_before_a_write(void)
{
	int64_t written_ns;

	scene_output(&s, "relay", PIO, OWS_BYTE)->readable = true;
	scene_put(&s, PIO, "0", 0);
	s.bus[0].depth = 8;
	s.bus[0].latency_ns = 60 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 20 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	scene_set(&s, 1, 1);
	scene_run(&s, 10 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(2, s.bus[0].pending_count);
	written_ns = scene_sample(&s, 1).tried_ns;
	scene_run(&s, 40 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	TEST_ASSERT_EQUAL_INT64(written_ns, scene_sample(&s, 1).tried_ns);
}

static void test_texts_are_read_written_and_cut_where_they_are_too_long(void)
{
	scene_input(&s, "type", "/28.551DDF030000/type", OWS_STRING);
	scene_output(&s, "alias", "/28.551DDF030000/alias", OWS_STRING);
	scene_put(&s, "/28.551DDF030000/type", "DS18B20", 0);
	scene_put(&s, "/28.551DDF030000/alias", "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set_text(&s, 2, "boiler");
	scene_run(&s, 150 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("DS18B20", scene_text(&s, 1));
	TEST_ASSERT_EQUAL_STRING("boiler", scene_text(&s, 2));
	TEST_ASSERT_EQUAL_STRING("boiler", scene_at(&s, "/28.551DDF030000/alias"));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_a_bus_that_takes_nothing_is_asked_again_later(void)
{
	three_thermometers();
	s.bus[0].refuses = true;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].refuses = false;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN(20, s.reads);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_inputs_are_read_in_the_order_of_the_file_once_a_period);
	RUN_TEST(test_the_cycle_goes_on_where_it_stopped_when_a_period_is_too_short);
	RUN_TEST(test_one_request_at_a_time_goes_to_a_bus_of_depth_one);
	RUN_TEST(test_all_due_inputs_go_at_once_to_a_bus_that_takes_them);
	RUN_TEST(test_at_most_one_write_is_in_work);
	RUN_TEST(test_nothing_goes_out_while_the_target_is_down);
	RUN_TEST(test_an_input_shows_its_init_value_until_it_is_read);
	RUN_TEST(test_a_reading_is_published_once_when_it_ends);
	RUN_TEST(test_a_reading_that_outlasts_a_period_is_shown_in_work);
	RUN_TEST(test_a_per_factor_spaces_the_reads_from_begin_to_begin);
	RUN_TEST(test_a_fresh_item_is_read_past_the_cache);
	RUN_TEST(test_an_init_value_is_written_once_at_start_before_any_read);
	RUN_TEST(test_an_output_without_init_value_waits_for_a_command);
	RUN_TEST(test_a_command_given_before_the_start_takes_the_place_of_the_init_value);
	RUN_TEST(test_only_a_change_is_written);
	RUN_TEST(test_the_value_of_the_moment_counts_and_back_is_no_change);
	RUN_TEST(test_outputs_are_written_in_the_order_of_the_file_not_of_the_commands);
	RUN_TEST(test_inputs_are_read_though_outputs_change_all_the_time);
	RUN_TEST(test_an_input_that_is_writable_is_written_on_command_but_not_at_start);
	RUN_TEST(test_a_read_back_that_differs_is_published_and_causes_no_write);
	RUN_TEST(test_the_time_of_the_last_attempt_does_not_go_back_to_a_read_before_a_write);
	RUN_TEST(test_texts_are_read_written_and_cut_where_they_are_too_long);
	RUN_TEST(test_a_bus_that_takes_nothing_is_asked_again_later);
	return UNITY_END();
}
