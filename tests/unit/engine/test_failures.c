/* SPDX-License-Identifier: MIT */
/* Tests of signals whose devices or targets fail and come back. */
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
#define PIO "/29.B89115000000/PIO.BYTE"
#define SENSED "/29.B89115000000/sensed.BYTE"

static void two_thermometers(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	scene_put(&s, T2, "22.5", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 150 * SCENE_MS);
}

static void test_value_and_quality_stand_through_the_retries(void)
{
	two_thermometers();
	scene_put(&s, T1, NULL, -EBADMSG);
	scene_run(&s, 300 * SCENE_MS); /* three failures, MaxRetries is 3 */
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT32(-EBADMSG, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
}

/* The quality after one failed reading, of a device that the bus has lost or not. */
static uint8_t after_one(bool lost, int err)
{
	two_thermometers();
	if (lost)
		scene_tell(&s, 0, BUS_LOST, T1);
	scene_put(&s, T1, NULL, err);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT32(err, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
	return scene_sample(&s, 1).quality;
}

static void test_a_device_that_its_bus_lost_is_bad_at_the_first_failure(void)
{
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, after_one(true, -ENODEV));
}

/* It takes both: that the bus lost the device, and that the failure says that it is not there. */
static void test_a_lost_device_that_answers_disturbed_has_its_retries(void)
{
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, after_one(true, -EBADMSG));
}

static void test_a_device_that_was_not_looked_for_has_its_retries(void)
{
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, after_one(false, -ENODEV));
}

/* MaxRetries is for answers that may be disturbed. */
static void test_what_a_device_says_of_itself_is_in_force_at_once(void)
{
	static const struct {
		int err;
		uint8_t quality;
	} verdicts[] = {{-ENODATA, OWS_Q_DEVICE}, {-ERANGE, OWS_Q_SENSOR}};

	two_thermometers();
	for (size_t i = 0; i < sizeof(verdicts) / sizeof(verdicts[0]); i++) {
		scene_put(&s, T1, NULL, verdicts[i].err);
		scene_run(&s, 100 * SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(verdicts[i].quality, scene_sample(&s, 1).quality);
		scene_put(&s, T1, NULL, -EBADMSG);
		scene_run(&s, 200 * SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(verdicts[i].quality, scene_sample(&s, 1).quality);
		scene_put(&s, T1, NULL, verdicts[i].err);
		scene_run(&s, 100 * SCENE_S);
		scene_put(&s, T1, "21.5", 0);
		scene_run(&s, 1100 * SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	}
}

/* ... and again so, once it has come back. */
static void test_a_device_that_came_back_has_its_retries_again(void)
{
	two_thermometers();
	scene_tell(&s, 0, BUS_LOST, T1);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_put(&s, T1, NULL, -ENODEV);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, 1).quality);
}

static void test_one_success_between_failures_clears_the_count(void)
{
	two_thermometers();
	for (int i = 0; i < 10; i++) {
		scene_put(&s, T1, NULL, -EBADMSG);
		scene_run(&s, 300 * SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
		scene_put(&s, T1, "21.5", 0);
		scene_run(&s, 100 * SCENE_MS);
		TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
	}
}

static void test_a_missing_device_costs_ever_less_and_never_slows_the_others(void)
{
	two_thermometers();
	scene_put(&s, T1, NULL, -ENODEV);
	scene_run(&s, 400 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, 1).quality);
	scene_clear_trace(&s);
	scene_run(&s, 63 * SCENE_S); /* 1 + 2 + 4 + 8 + 16 + 32 */
	TEST_ASSERT_EQUAL_UINT(630 + 6, s.reads);
	scene_clear_trace(&s);
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(6000 + 10, s.reads);
}

static void test_a_device_that_comes_back_is_good_again(void)
{
	two_thermometers();
	scene_put(&s, T1, NULL, -ENODEV);
	scene_run(&s, 10 * SCENE_S);
	scene_put(&s, T1, "19", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(19, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "device_returns"));
}

static void test_a_directory_that_shows_the_device_ends_the_back_off(void)
{
	static const struct bus_event found = {.news = BUS_FOUND,
	                                       .rom = {0x28, 0x55, 0x1d, 0xdf, 0x03, 0, 0, 0xa3}};
	struct bus_event event = found;
	uint8_t crc = 0;

	for (int i = 0; i < 7; i++) {
		uint8_t byte = event.rom[i];

		for (int bit = 0; bit < 8; bit++, byte >>= 1)
			crc = (crc ^ byte) & 1 ? (crc >> 1) ^ 0x8c : crc >> 1;
	}
	event.rom[7] = crc;
	two_thermometers();
	scene_put(&s, T1, NULL, -ENODEV);
	scene_run(&s, 200 * SCENE_S);
	scene_put(&s, T1, "19", 0);
	engine_event(s.engine, 0, &event, s.now_ns);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_outputs_of_a_device_that_comes_back_are_written_again(void)
{
	scene_input(&s, "in", SENSED, OWS_BYTE);
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, SENSED, "255", 0);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 6);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_put(&s, SENSED, NULL, -ENODEV);
	scene_run(&s, 2 * SCENE_S);
	scene_put(&s, SENSED, "255", 0);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
	TEST_ASSERT_EQUAL_STRING("6", scene_at(&s, PIO));
}

static void test_a_lost_target_turns_all_its_signals_bad_at_once(void)
{
	two_thermometers();
	scene_down(&s, -ECONNRESET);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_INT32(-ECONNRESET, scene_sample(&s, 1).err);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
}

/* That of an adapter means something else of a device: "no such device there". */
static void test_why_an_adapter_does_not_open_is_no_error_of_its_signals(void)
{
	static const int errors[] = {-ENODEV, -ENXIO, -EACCES, -EBUSY, -EINVAL};

	two_thermometers();
	for (size_t i = 0; i < sizeof(errors) / sizeof(errors[0]); i++) {
		scene_down(&s, errors[i]);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
		TEST_ASSERT_EQUAL_INT32(-ENOTCONN, scene_sample(&s, 1).err);
		scene_up(&s);
		scene_run(&s, 50 * SCENE_MS);
	}
}

static void test_reconnects_count_returns_and_not_the_first_connection(void)
{
	two_thermometers();
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 0).value);
	for (int i = 0; i < 3; i++) {
		scene_down(&s, -ECONNRESET);
		scene_run(&s, SCENE_S);
		scene_up(&s);
		scene_run(&s, SCENE_S);
	}
	TEST_ASSERT_EQUAL_INT64(3, scene_sample(&s, 0).value);
}

static void test_a_target_that_is_down_at_the_start_makes_bad_and_then_good(void)
{
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	scene_start(&s);
	scene_down(&s, -ECONNREFUSED);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 0).value);
}

static void test_a_written_output_is_not_written_again_when_the_target_returns(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 1, 6);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_a_command_given_while_the_target_is_down_goes_out_when_it_returns(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_down(&s, -ECONNRESET);
	scene_set(&s, 1, 6);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=6\n", s.trace);
}

static void test_a_write_that_failed_is_tried_again_until_it_succeeds_and_then_no_more(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", -EIO);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 1, 6);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(4, s.writes);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	TEST_ASSERT_BITS_HIGH(OWS_SAMPLE_PENDING, scene_sample(&s, 1).flags);
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(6, s.writes);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(7, s.writes);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_BITS_LOW(OWS_SAMPLE_PENDING, scene_sample(&s, 1).flags);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
}

static void test_a_write_that_fails_does_not_make_a_value_bad_that_is_read(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->readable = true;
	scene_put(&s, PIO, "3", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 500 * SCENE_MS);
	scene_refuse_writes(&s, PIO, -EACCES);
	scene_set(&s, 1, 6);
	for (int i = 0; i < 20; i++) {
		scene_run(&s, 100 * SCENE_MS);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
		TEST_ASSERT_EQUAL_INT32(-EACCES, scene_sample(&s, 1).err);
		TEST_ASSERT_BITS_HIGH(OWS_SAMPLE_PENDING, scene_sample(&s, 1).flags);
		TEST_ASSERT_EQUAL_INT64(3, scene_sample(&s, 1).value);
	}
	scene_refuse_writes(&s, PIO, 0);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_INT64(6, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_BITS_LOW(OWS_SAMPLE_PENDING, scene_sample(&s, 1).flags);
}

static void test_the_error_of_a_read_goes_before_that_of_a_write(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->readable = true;
	scene_put(&s, PIO, "3", 0);
	scene_refuse_writes(&s, PIO, -EACCES);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 1, 6);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT32(-EACCES, scene_sample(&s, 1).err);
	scene_put(&s, PIO, "3", -EBADMSG);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT32(-EBADMSG, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
	scene_put(&s, PIO, "3", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_INT32(-EACCES, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
}

static void test_an_answer_that_is_no_number_is_an_item_error(void)
{
	static const char *const bad[] = {"", "   ", "abc", "12abc", "nan", "INF", "1,2"};

	two_thermometers();
	for (unsigned i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		scene_put(&s, T1, bad[i], 0);
		scene_run(&s, 5 * SCENE_S);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_TYPE, scene_sample(&s, 1).quality, bad[i]);
		TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
		scene_put(&s, T1, "21.5", 0);
		scene_run(&s, 70 * SCENE_S);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	}
}

static void test_a_value_outside_the_type_is_held_at_the_limit_and_says_so(void)
{
	scene_input(&s, "in", SENSED, OWS_BYTE);
	scene_put(&s, SENSED, "300", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(255, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_HIGH, scene_sample(&s, 1).quality);
	scene_put(&s, SENSED, "-1", 0);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LOW, scene_sample(&s, 1).quality);
}

static void test_a_bus_that_never_answers_is_given_up_and_its_signals_go_bad(void)
{
	two_thermometers();
	s.bus[0].mute = true;
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	/* and comes back with its late answer */
	s.bus[0].mute = false;
	scene_answer(&s, s.bus[0].swallowed[0]->id, 0, "1", s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, 50 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "late_answers"));
}

/* Timeout is 20 s, and each answer takes 25: the values come late, and as old as they are. */
static void test_a_slow_target_gives_its_values_late_and_not_never(void)
{
	s.bus[0].slow = T1;
	s.bus[0].slow_ns = 25 * SCENE_S;
	s.bus[0].depth = 8;
	two_thermometers();
	for (unsigned i = 0; i < 8; i++) {
		scene_run(&s, 30 * SCENE_S);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
		TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
		TEST_ASSERT_GREATER_THAN_UINT32(i, scene_sample(&s, 1).count);
	}
	TEST_ASSERT_GREATER_THAN_UINT64(7, scene_counter(&s, "late_answers"));
}

static const struct bus_req *slow_one;

static void give_the_slow_one_the_old_value(struct scene_bus *bus, const struct bus_req *req)
{
	if (strcmp(req->path, T1))
		return;
	scene_put(bus->scene, T1, req == slow_one ? "21.5" : "30", 0);
	if (req == slow_one)
		slow_one = NULL;
}

static void test_a_late_value_does_not_replace_one_that_was_asked_for_later(void)
{
	s.bus[0].slow = T1;
	s.bus[0].slow_ns = 25 * SCENE_S;
	s.bus[0].depth = 8;
	two_thermometers();
	for (unsigned i = 0; i < s.bus[0].pending_count; i++)
		if (strcmp(s.bus[0].pending[i].req->path, T1) == 0)
			slow_one = s.bus[0].pending[i].req;
	s.bus[0].slow_ns = SCENE_MS;
	s.on_done = give_the_slow_one_the_old_value;
	scene_run(&s, 23 * SCENE_S);
	for (unsigned i = 0; i < 5000; i++) {
		TEST_ASSERT_EQUAL_DOUBLE(30, scene_number(&s, 1));
		scene_run(&s, SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "late_answers"));
}

/* A memory wears with each write, and a chip that refuses one may have carried it out. */
static void test_a_write_that_fails_is_not_tried_each_second_where_a_reading_is(void)
{
	s.bus[0].brief = true;
	s.no_trace = true;
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_refuse_writes(&s, PIO, -EIO);
	two_thermometers();
	scene_put(&s, T1, "", -EIO);
	scene_set(&s, 1, 1);
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_LESS_THAN_UINT(25, s.writes);
	TEST_ASSERT_GREATER_THAN_UINT(10, s.writes);
	scene_put(&s, T1, "30", 0);
	scene_run(&s, 1200 * SCENE_MS);
	TEST_ASSERT_EQUAL_DOUBLE(30, scene_number(&s, 2));
}

static void test_one_request_without_answer_spoils_only_its_signal_on_a_bus_that_lives(void)
{
	s.bus[0].depth = 4;
	two_thermometers();
	s.bus[0].mute = true;
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(2, s.bus[0].swallowed_count);
	s.bus[0].mute = false;
	scene_answer(&s, s.bus[0].swallowed[1]->id, 0, "5", s.bus[0].swallowed[1]);
	s.bus[0].swallowed_count = 1;
	scene_run(&s, 22 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "given_up"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "item_errors"));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "target_failures"));
}

static void test_a_bus_that_only_talks_and_keeps_all_it_was_given_is_stuck_too(void)
{
	struct bus_event note = {.news = BUS_NOTE};

	two_thermometers();
	s.bus[0].mute = true;
	scene_run(&s, SCENE_S);
	engine_event(s.engine, 0, &note, s.now_ns);
	scene_run(&s, 21 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "target_failures"));
}

/* What the image says of the target; "": nothing. */
static const char *note(void)
{
	return s.image.notes[0].text;
}

static void trouble(const char *text)
{
	struct bus_event event = {.news = BUS_TROUBLE};

	memcpy(event.text, text, strlen(text));
	engine_event(s.engine, 0, &event, s.now_ns);
}

static void test_a_target_has_the_reason_while_it_is_down_and_its_trouble_while_it_is_up(void)
{
	two_thermometers();
	TEST_ASSERT_EQUAL_STRING("", note());
	trouble("owserver, \x1bprocess 109");
	TEST_ASSERT_EQUAL_STRING("owserver, ?process 109", note());
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_STRING("owserver, ?process 109", note());
	scene_down(&s, -ECONNREFUSED);
	TEST_ASSERT_EQUAL_STRING("Connection refused", note());
	scene_up(&s);
	TEST_ASSERT_EQUAL_STRING("owserver, ?process 109", note());
	scene_down(&s, -ECONNREFUSED);
	trouble("");
	TEST_ASSERT_EQUAL_STRING("Connection refused", note());
	scene_up(&s);
	TEST_ASSERT_EQUAL_STRING("", note());
}

/* What hangs reports nothing by itself. */
static void test_a_target_that_hangs_is_shown_as_down_until_it_answers(void)
{
	struct bus_event event = {.news = BUS_UP};

	two_thermometers();
	trouble("a fault of its own");
	s.bus[0].mute = true;
	scene_run(&s, 21 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT32(0, scene_target_state(&s, 0));
	TEST_ASSERT_EQUAL_STRING("no answer at all within Timeout", note());
	/* its server may be gone, and there again */
	scene_down(&s, -ECONNRESET);
	scene_run(&s, SCENE_S);
	engine_event(s.engine, 0, &event, s.now_ns);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(0, scene_target_state(&s, 0));
	TEST_ASSERT_EQUAL_STRING("no answer at all within Timeout", note());
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT32(0, scene_target_state(&s, 0));
	s.bus[0].mute = false;
	scene_answer(&s, s.bus[0].swallowed[0]->id, -EIO, NULL, s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT32(1, scene_target_state(&s, 0));
	TEST_ASSERT_EQUAL_STRING("a fault of its own", note());
}

static void test_a_timeout_shorter_than_the_period_is_kept(void)
{
	s.config.period_ns = 60 * SCENE_S;
	s.config.timeout_ns = SCENE_S;
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_input(&s, "t2", T2, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	scene_start(&s);
	scene_up(&s);
	s.bus[0].mute = true; /* the first is on its way and is answered */
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
}

static void test_a_write_in_doubt_that_ends_late_is_followed_by_the_present_value(void)
{
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	s.bus[0].mute = true;
	scene_set(&s, 1, 1);
	scene_run(&s, 21 * SCENE_S);
	s.bus[0].mute = false;
	scene_set(&s, 1, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=1\n", s.trace);
	scene_answer(&s, s.bus[0].swallowed[0]->id, 0, NULL, s.bus[0].swallowed[0]);
	s.bus[0].swallowed_count = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " PIO "=1\nW " PIO "=2\n", s.trace);
}

/* A set of an input was an event: late or not, it was one. */
static void an_input_in_doubt(void)
{
	scene_input(&s, "in", PIO, OWS_BYTE)->writable = true;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	scene_set(&s, 1, 1);
	scene_run(&s, 21 * SCENE_S);
	s.bus[0].mute = false;
}

/* Of the requests that were swallowed these are answered. */
static void answer_swallowed(enum bus_op op, int err)
{
	unsigned n = s.bus[0].swallowed_count;

	s.bus[0].swallowed_count = 0;
	for (unsigned i = 0; i < n; i++) {
		struct bus_req *req = s.bus[0].swallowed[i];

		if (req->op == op)
			scene_answer(&s, req->id, err, NULL, req);
		else
			s.bus[0].swallowed[s.bus[0].swallowed_count++] = req;
	}
}

static void answer_late(int err)
{
	answer_swallowed(BUS_READ, -EIO);
	answer_swallowed(BUS_WRITE, err);
	scene_run(&s, 10 * SCENE_S);
}

static void test_a_set_of_an_input_that_ends_late_is_not_repeated(void)
{
	an_input_in_doubt();
	answer_late(0);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_UINT(1, scene_sample(&s, 1).confirmed);
	scene_set(&s, 1, 2);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
}

/* Its target answers others, so it was tried again, and done. */
static void test_a_set_of_an_input_that_was_done_meanwhile_is_not_repeated(void)
{
	unsigned writes;

	scene_input(&s, "in", PIO, OWS_BYTE)->writable = true;
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, T1, "21.5", 0);
	s.bus[0].depth = 2;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	s.bus[0].mute = true;
	scene_set(&s, 1, 1);
	scene_run(&s, 100 * SCENE_MS);
	s.bus[0].mute = false;
	answer_swallowed(BUS_READ, -EIO);
	scene_run(&s, 120 * SCENE_S);
	writes = s.writes;
	TEST_ASSERT_EQUAL_UINT(2, writes);
	answer_late(0);
	TEST_ASSERT_EQUAL_UINT(writes, s.writes);
	/* which of both came last is not known: the next one counts, the same value too */
	scene_set(&s, 1, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(writes + 1, s.writes);
}

static void test_a_set_of_an_input_that_failed_late_is_tried_again(void)
{
	an_input_in_doubt();
	answer_late(-EIO);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
}

static void test_a_newer_set_of_an_input_follows_one_in_doubt(void)
{
	an_input_in_doubt();
	scene_set(&s, 1, 2);
	answer_late(0);
	TEST_ASSERT_EQUAL_UINT(2, s.writes);
	TEST_ASSERT_EQUAL_STRING("2", scene_at(&s, PIO));
}

static void test_answers_that_nobody_asked_for_are_counted_and_ignored(void)
{
	unsigned seed = 4711;

	two_thermometers();
	for (unsigned i = 0; i < 1000; i++) {
		seed = seed * 1664525 + 1013904223;
		scene_answer(&s, seed, 0, NULL, NULL);
	}
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(990, scene_counter(&s, "unknown_answers"));
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
}

static void test_a_second_answer_to_one_request_changes_nothing(void)
{
	struct bus_req *req;

	two_thermometers();
	s.bus[0].mute = true;
	scene_run(&s, 100 * SCENE_MS);
	req = s.bus[0].swallowed[0];
	s.bus[0].mute = false;
	s.bus[0].swallowed_count = 0;
	scene_answer(&s, req->id, 0, "30", req);
	TEST_ASSERT_EQUAL_DOUBLE(30, scene_number(&s, 1));
	scene_answer(&s, req->id, -EIO, NULL, req);
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "unknown_answers"));
}

static void test_with_max_retries_0_the_first_error_is_bad(void)
{
	s.config.max_retries = 0;
	two_thermometers();
	scene_put(&s, T1, NULL, -EBADMSG);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, 1).quality);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_value_and_quality_stand_through_the_retries);
	RUN_TEST(test_a_device_that_its_bus_lost_is_bad_at_the_first_failure);
	RUN_TEST(test_a_lost_device_that_answers_disturbed_has_its_retries);
	RUN_TEST(test_a_device_that_was_not_looked_for_has_its_retries);
	RUN_TEST(test_what_a_device_says_of_itself_is_in_force_at_once);
	RUN_TEST(test_a_device_that_came_back_has_its_retries_again);
	RUN_TEST(test_one_success_between_failures_clears_the_count);
	RUN_TEST(test_a_missing_device_costs_ever_less_and_never_slows_the_others);
	RUN_TEST(test_a_device_that_comes_back_is_good_again);
	RUN_TEST(test_a_directory_that_shows_the_device_ends_the_back_off);
	RUN_TEST(test_outputs_of_a_device_that_comes_back_are_written_again);
	RUN_TEST(test_a_lost_target_turns_all_its_signals_bad_at_once);
	RUN_TEST(test_why_an_adapter_does_not_open_is_no_error_of_its_signals);
	RUN_TEST(test_reconnects_count_returns_and_not_the_first_connection);
	RUN_TEST(test_a_target_that_is_down_at_the_start_makes_bad_and_then_good);
	RUN_TEST(test_a_written_output_is_not_written_again_when_the_target_returns);
	RUN_TEST(test_a_command_given_while_the_target_is_down_goes_out_when_it_returns);
	RUN_TEST(test_a_write_that_failed_is_tried_again_until_it_succeeds_and_then_no_more);
	RUN_TEST(test_a_write_that_fails_does_not_make_a_value_bad_that_is_read);
	RUN_TEST(test_the_error_of_a_read_goes_before_that_of_a_write);
	RUN_TEST(test_an_answer_that_is_no_number_is_an_item_error);
	RUN_TEST(test_a_value_outside_the_type_is_held_at_the_limit_and_says_so);
	RUN_TEST(test_a_slow_target_gives_its_values_late_and_not_never);
	RUN_TEST(test_a_bus_that_never_answers_is_given_up_and_its_signals_go_bad);
	RUN_TEST(test_a_late_value_does_not_replace_one_that_was_asked_for_later);
	RUN_TEST(test_a_write_that_fails_is_not_tried_each_second_where_a_reading_is);
	RUN_TEST(test_one_request_without_answer_spoils_only_its_signal_on_a_bus_that_lives);
	RUN_TEST(test_a_bus_that_only_talks_and_keeps_all_it_was_given_is_stuck_too);
	RUN_TEST(test_a_target_has_the_reason_while_it_is_down_and_its_trouble_while_it_is_up);
	RUN_TEST(test_a_target_that_hangs_is_shown_as_down_until_it_answers);
	RUN_TEST(test_a_timeout_shorter_than_the_period_is_kept);
	RUN_TEST(test_a_write_in_doubt_that_ends_late_is_followed_by_the_present_value);
	RUN_TEST(test_a_set_of_an_input_that_ends_late_is_not_repeated);
	RUN_TEST(test_a_set_of_an_input_that_was_done_meanwhile_is_not_repeated);
	RUN_TEST(test_a_set_of_an_input_that_failed_late_is_tried_again);
	RUN_TEST(test_a_newer_set_of_an_input_follows_one_in_doubt);
	RUN_TEST(test_answers_that_nobody_asked_for_are_counted_and_ignored);
	RUN_TEST(test_a_second_answer_to_one_request_changes_nothing);
	RUN_TEST(test_with_max_retries_0_the_first_error_is_bad);
	return UNITY_END();
}
