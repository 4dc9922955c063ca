/* SPDX-License-Identifier: MIT */
/* What the engine enters into the ring of changes, and what it does not. */
#include <errno.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define T2 "/28.000000000002/temperature"
#define RELAY "/29.000000000003/PIO.BYTE"

static struct scene s;
static struct config_item *room;
static uint32_t seen;

void setUp(void)
{
	scene_init(&s);
	room = scene_input(&s, "room", T1, OWS_DOUBLE);
	scene_put(&s, T1, "20", 0);
}

void tearDown(void)
{
	scene_end(&s);
}

static void look(void)
{
	seen = s.image.header->change_head;
}

/* How often was this record entered since the last look()? */
static unsigned entered(unsigned record)
{
	unsigned n = 0;

	for (uint32_t i = seen; i != s.image.header->change_head; i++) {
		const struct ows_change_entry *entry =
			&s.image.changes[i & (s.image.change_count - 1)];

		TEST_ASSERT_EQUAL_UINT32(i, entry->number);
		TEST_ASSERT_NOT_EQUAL(0, entry->record);
		n += entry->record == record;
	}
	return n;
}

static void start(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 250 * SCENE_MS);
	look();
}

/* Let the signal be read once more. */
static void measure(const char *text)
{
	uint32_t count = scene_sample(&s, 1).count;

	scene_put(&s, T1, text, 0);
	while (scene_sample(&s, 1).count == count)
		scene_run(&s, 10 * SCENE_MS);
}

static void test_each_reading_is_a_change_though_the_value_is_the_same(void)
{
	start();
	measure("20");
	measure("20");
	TEST_ASSERT_EQUAL_UINT(2, entered(1));
}

static void test_a_reading_that_takes_long_is_no_change_before_its_end(void)
{
	s.bus[0].slow = T1;
	s.bus[0].slow_ns = 5 * SCENE_S;
	start();
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_TRUE(scene_attrs(&s, 1).flags & OWS_ATTR_IN_WORK);
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
	scene_run(&s, 2 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
}

static void test_an_error_is_a_change_and_the_same_error_again_is_none(void)
{
	start();
	scene_put(&s, T1, "", -ENODEV);
	scene_run(&s, 30 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, 1).quality);
	TEST_ASSERT_GREATER_THAN(0, entered(1));
	look();
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
	measure("20");
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
}

static void test_a_command_and_its_confirmation_are_changes(void)
{
	scene_output(&s, "relay", RELAY, OWS_LONG);
	scene_put(&s, RELAY, "0", 0);
	room->per_factor = 10000;
	start();
	scene_set(&s, 2, 5);
	scene_run(&s, SCENE_MS / 2);
	TEST_ASSERT_TRUE(scene_sample(&s, 2).flags & OWS_SAMPLE_PENDING);
	TEST_ASSERT_EQUAL_UINT(1, entered(2));
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_FALSE(scene_sample(&s, 2).flags & OWS_SAMPLE_PENDING);
	TEST_ASSERT_EQUAL_UINT(2, entered(2));
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
}

static void test_what_moves_less_than_the_deadband_is_no_change(void)
{
	room->deadband = 0.5;
	start();
	measure("20.25");
	measure("19.75");
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
	TEST_ASSERT_EQUAL_DOUBLE(19.75, scene_number(&s, 1));
	measure("20.5");
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
}

static void test_a_value_that_creeps_is_entered_each_time_it_has_gone_a_deadband(void)
{
	static const char *const texts[] = {"20.2", "20.4", "20.6", "20.8", "21.0", "21.2", "21.4"};

	room->deadband = 0.5;
	start();
	for (int i = 0; i < 7; i++)
		measure(texts[i]);
	TEST_ASSERT_EQUAL_UINT(2, entered(1)); /* at 20.6 and 21.2 */
}

static void test_an_error_is_a_change_within_the_deadband_too(void)
{
	room->deadband = 100;
	start();
	scene_put(&s, T1, "", -ENODEV);
	scene_run(&s, 30 * SCENE_S);
	TEST_ASSERT_GREATER_THAN(0, entered(1));
	look();
	measure("20");
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
}

static void test_a_good_value_that_turns_stale_is_one_change(void)
{
	int64_t measured_ns;

	room->stale_after_ns = 3 * SCENE_S;
	room->per_factor = 100;
	start();
	measured_ns = scene_sample(&s, 1).measured_ns;
	scene_run(&s, measured_ns + 3 * SCENE_S - s.now_ns);
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
	scene_run(&s, 101 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
	measure("20");
	TEST_ASSERT_EQUAL_UINT(2, entered(1));
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(3, entered(1));
}

static void test_a_value_that_is_read_in_time_never_turns_stale(void)
{
	room->stale_after_ns = 3 * SCENE_S;
	room->per_factor = 10;
	start();
	scene_run(&s, 100 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(100, entered(1));
}

static void test_a_bad_value_does_not_turn_stale(void)
{
	room->stale_after_ns = 3 * SCENE_S;
	scene_put(&s, T1, "x", 0);
	start();
	scene_run(&s, 30 * SCENE_S);
	TEST_ASSERT_FALSE(ows_good(scene_sample(&s, 1).quality));
	look();
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
}

static void test_a_limit_alarm_that_time_alone_raises_is_a_change(void)
{
	room->limits = (struct config_limits){
		.any = true,
		.on_delay_ns = 5 * SCENE_S,
		.has = {[CONFIG_LIMIT_H] = true},
		.limit = {[CONFIG_LIMIT_H] = 30},
	};
	room->per_factor = 1000;
	scene_put(&s, T1, "31", 0);
	start();
	scene_run(&s, 4500 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_EQUAL(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, 1).limit_state);
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
}

static void test_a_lost_target_changes_its_signals(void)
{
	scene_input(&s, "other", T2, OWS_DOUBLE);
	scene_put(&s, T2, "7", 0);
	start();
	scene_down(&s, -ECONNRESET);
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT(1, entered(1));
	TEST_ASSERT_EQUAL_UINT(1, entered(2));
}

static void test_the_heartbeat_alone_is_no_news(void)
{
	int64_t beat;

	room->per_factor = 10000;
	start();
	engine_published(s.engine);
	beat = scene_sample(&s, 0).measured_ns;
	scene_run(&s, 1400 * SCENE_MS); /* after 2 s the device is looked for */
	TEST_ASSERT_GREATER_THAN_INT64(beat + 900 * SCENE_MS, scene_sample(&s, 0).measured_ns);
	TEST_ASSERT_FALSE(engine_published(s.engine));
	TEST_ASSERT_EQUAL_UINT(0, entered(1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_reading_is_a_change_though_the_value_is_the_same);
	RUN_TEST(test_a_reading_that_takes_long_is_no_change_before_its_end);
	RUN_TEST(test_an_error_is_a_change_and_the_same_error_again_is_none);
	RUN_TEST(test_a_command_and_its_confirmation_are_changes);
	RUN_TEST(test_what_moves_less_than_the_deadband_is_no_change);
	RUN_TEST(test_a_value_that_creeps_is_entered_each_time_it_has_gone_a_deadband);
	RUN_TEST(test_an_error_is_a_change_within_the_deadband_too);
	RUN_TEST(test_a_good_value_that_turns_stale_is_one_change);
	RUN_TEST(test_a_value_that_is_read_in_time_never_turns_stale);
	RUN_TEST(test_a_bad_value_does_not_turn_stale);
	RUN_TEST(test_a_limit_alarm_that_time_alone_raises_is_a_change);
	RUN_TEST(test_a_lost_target_changes_its_signals);
	RUN_TEST(test_the_heartbeat_alone_is_no_news);
	return UNITY_END();
}
