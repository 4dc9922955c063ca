/* SPDX-License-Identifier: MIT */
/* What the engine knows and counts of each device, as the image shows it. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows.h"
#include "tests/unit/aid/scene.h"

/* In the order of the ROM ids, which is not that of the file. */
enum { SENSOR, RELAYS, DEVICES };

static struct scene s;

void setUp(void)
{
	scene_init(&s);
	scene_put(&s, "/29.066418000000/PIO.0", "0", 0);
	scene_put(&s, "/28.551DDF030000/temperature", "21.5", 0);
	scene_put(&s, "/28.551DDF030000/power", "1", 0);
	scene_put(&s, "/kitchen/temperature", "20", 0);
	scene_output(&s, "pump", "/29.066418000000/PIO.0", OWS_BOOL);
	scene_input(&s, "room", "/28.551DDF030000/temperature", OWS_DOUBLE);
	scene_input(&s, "powered", "/28.551DDF030000/power", OWS_BOOL);
	scene_input(&s, "kitchen", "/kitchen/temperature", OWS_DOUBLE);
	s.bus[0].besides = (struct bus_answer){.retries = 1, .wire_us = 100};
}

void tearDown(void)
{
	scene_end(&s);
}

static void begin(void)
{
	scene_start(&s);
	scene_up(&s);
}

static void test_each_device_with_a_rom_id_has_a_row_and_none_has_answered(void)
{
	struct ows_device_entry device;

	scene_start(&s);
	TEST_ASSERT_EQUAL_UINT32(DEVICES, s.image.device_count);
	for (unsigned i = 0; i < DEVICES; i++) {
		device = scene_device(&s, i);
		TEST_ASSERT_EQUAL_UINT64(0, device.answers + device.errors);
		TEST_ASSERT_EQUAL_INT64(0, device.ok_ns);
		TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, device.target);
		TEST_ASSERT_EQUAL_UINT32(OWS_POWER_UNKNOWN, device.power);
		TEST_ASSERT_EQUAL_STRING("", device.identity);
	}
}

static void test_each_answer_for_a_device_is_counted_with_what_it_cost(void)
{
	struct ows_device_entry device;
	uint32_t updates;

	begin();
	scene_run(&s, SCENE_S);
	device = scene_device(&s, SENSOR);
	updates = scene_sample(&s, 2).count + scene_sample(&s, 3).count;
	TEST_ASSERT_GREATER_THAN_UINT32(10, updates);
	TEST_ASSERT_UINT64_WITHIN(2, updates, device.answers);
	TEST_ASSERT_EQUAL_UINT64(device.answers, device.retries);
	TEST_ASSERT_EQUAL_UINT64(100 * device.answers, device.wire_us);
	TEST_ASSERT_EQUAL_UINT64(0, device.errors);
	TEST_ASSERT_EQUAL_UINT32(0, device.target);
	TEST_ASSERT_INT64_WITHIN(200 * SCENE_MS, s.now_ns, device.ok_ns);
	TEST_ASSERT_EQUAL_UINT64(0, scene_device(&s, RELAYS).answers);
	scene_set(&s, 1, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(1, scene_device(&s, RELAYS).answers);
}

static void test_an_error_is_that_of_its_device(void)
{
	uint64_t errors;
	int64_t ok_ns;

	begin();
	scene_run(&s, SCENE_S);
	scene_put(&s, "/28.551DDF030000/temperature", "", -EIO);
	scene_put(&s, "/28.551DDF030000/power", "", -EIO);
	scene_run(&s, SCENE_S);
	ok_ns = scene_device(&s, SENSOR).ok_ns;
	scene_run(&s, 5 * SCENE_S);
	errors = scene_device(&s, SENSOR).errors;
	TEST_ASSERT_GREATER_THAN_UINT64(3, errors);
	TEST_ASSERT_EQUAL_UINT64(scene_counter_of(&s, 0, "item_errors"), errors);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(errors, scene_device(&s, SENSOR).answers);
	TEST_ASSERT_EQUAL_INT64(ok_ns, scene_device(&s, SENSOR).ok_ns);
	TEST_ASSERT_EQUAL_UINT64(0, scene_device(&s, RELAYS).errors);
}

static void test_a_device_that_stays_absent_is_counted_until_it_is_known_to_be(void)
{
	uint64_t errors, answers;

	begin();
	scene_run(&s, SCENE_S);
	scene_put(&s, "/28.551DDF030000/temperature", "", -ENODEV);
	scene_put(&s, "/28.551DDF030000/power", "", -ENODEV);
	scene_run(&s, 5 * SCENE_S);
	errors = scene_device(&s, SENSOR).errors;
	answers = scene_device(&s, SENSOR).answers;
	TEST_ASSERT_GREATER_THAN_UINT64(0, errors);
	TEST_ASSERT_EQUAL_UINT64(errors, scene_counter_of(&s, 0, "item_errors"));
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT64(answers, scene_device(&s, SENSOR).answers);
	TEST_ASSERT_EQUAL_UINT64(errors, scene_device(&s, SENSOR).errors);
	TEST_ASSERT_EQUAL_UINT64(errors, scene_counter_of(&s, 0, "item_errors"));
	/* another error of it says something new */
	scene_put(&s, "/28.551DDF030000/temperature", "", -EIO);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT64(errors, scene_device(&s, SENSOR).errors);
	/* and so does its next absence */
	scene_put(&s, "/28.551DDF030000/temperature", "21", 0);
	scene_put(&s, "/28.551DDF030000/power", "1", 0);
	scene_run(&s, 60 * SCENE_S);
	errors = scene_device(&s, SENSOR).errors;
	scene_put(&s, "/28.551DDF030000/temperature", "", -ENODEV);
	scene_put(&s, "/28.551DDF030000/power", "", -ENODEV);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT64(errors, scene_device(&s, SENSOR).errors);
}

static void test_what_a_bus_knows_stays_when_a_later_answer_does_not_say_it(void)
{
	begin();
	s.bus[0].besides.identity = "DS18B20 clone, family B1";
	s.bus[0].besides.supply = BUS_SUPPLY_PARASITE;
	scene_run(&s, SCENE_S);
	s.bus[0].besides.identity = NULL;
	s.bus[0].besides.supply = BUS_SUPPLY_UNKNOWN;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1", scene_device(&s, SENSOR).identity);
	TEST_ASSERT_EQUAL_UINT32(OWS_POWER_PARASITE, scene_device(&s, SENSOR).power);
	s.bus[0].besides.supply = BUS_SUPPLY_EXTERNAL;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(OWS_POWER_EXTERNAL, scene_device(&s, SENSOR).power);
}

static void test_an_identity_that_is_too_long_is_cut(void)
{
	char text[OWS_IDENTITY + 10];

	memset(text, 'x', sizeof(text) - 1);
	text[sizeof(text) - 1] = '\0';
	begin();
	s.bus[0].besides.identity = text;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(OWS_IDENTITY - 1, strlen(scene_device(&s, SENSOR).identity));
}

static void test_a_late_answer_counts_with_the_wire_that_it_took(void)
{
	uint64_t wire_us;

	s.bus[0].slow = "/28.551DDF030000/temperature";
	s.bus[0].slow_ns = 25 * SCENE_S;
	s.bus[0].depth = 4;
	begin();
	scene_run(&s, 21 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "given_up"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_device(&s, SENSOR).errors);
	s.bus[0].besides.wire_us = 1000000;
	wire_us = scene_device(&s, SENSOR).wire_us;
	scene_enable_reads(&s, 3, false);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "late_answers"));
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(wire_us + 1000000, scene_device(&s, SENSOR).wire_us);
}

/* --- Reload ---------------------------------------------------------------------------------- */

static void rename_all(struct config *config)
{
	for (unsigned i = 0; i < config->item_count; i++)
		config->items[i].name = i ? i == 1       ? "first"
		                                : i == 2 ? "second"
		                                         : "third"
		                          : "zeroth";
}

/* Another device stands before it in the order of the ids. */
static void add_before(struct config *config)
{
	struct config_item *item = &config->items[config->item_count++];

	*item = config->items[1];
	item->name = "cellar";
	item->path = "/10.000000000001/temperature";
}

static void remove_sensor(struct config *config)
{
	config->items[1] = config->items[3];
	config->item_count = 2;
}

static void test_a_reload_keeps_what_was_counted_also_under_other_names(void)
{
	struct ows_device_entry before, after;

	s.bus[0].besides.identity = "DS18B20";
	begin();
	scene_run(&s, SCENE_S);
	scene_reload(&s, NULL);
	before = scene_device(&s, SENSOR);
	TEST_ASSERT_GREATER_THAN_UINT64(10, before.answers);
	scene_reload(&s, rename_all);
	after = scene_device(&s, SENSOR);
	TEST_ASSERT_EQUAL_UINT64(before.answers, after.answers);
	TEST_ASSERT_EQUAL_UINT64(before.retries, after.retries);
	TEST_ASSERT_EQUAL_UINT64(before.wire_us, after.wire_us);
	TEST_ASSERT_EQUAL_INT64(before.ok_ns, after.ok_ns);
	TEST_ASSERT_EQUAL_UINT32(0, after.target);
	TEST_ASSERT_EQUAL_STRING("DS18B20", after.identity);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT64(before.answers, scene_device(&s, SENSOR).answers);
}

static void test_a_reload_keeps_them_where_devices_come_and_go(void)
{
	uint64_t answers;

	begin();
	scene_run(&s, SCENE_S);
	answers = scene_device(&s, SENSOR).answers;
	scene_reload(&s, add_before);
	TEST_ASSERT_EQUAL_UINT32(DEVICES + 1, s.image.device_count);
	TEST_ASSERT_EQUAL_UINT64(0, scene_device(&s, 0).answers);
	TEST_ASSERT_UINT64_WITHIN(2, answers, scene_device(&s, SENSOR + 1).answers);
	scene_reload(&s, remove_sensor);
	TEST_ASSERT_EQUAL_UINT32(1, s.image.device_count);
	TEST_ASSERT_EQUAL_UINT64(0, scene_device(&s, 0).answers);
}

static void other_target(struct config *config)
{
	config->targets[0].text = "other";
}

static void test_a_target_that_a_reload_takes_away_has_answered_nothing(void)
{
	scene_bus(&s, "other", 1);
	s.config.target_count = 1;
	begin();
	scene_run(&s, SCENE_S);
	scene_reload(&s, other_target);
	TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, scene_device(&s, SENSOR).target);
	TEST_ASSERT_GREATER_THAN_UINT64(10, scene_device(&s, SENSOR).answers);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_device_with_a_rom_id_has_a_row_and_none_has_answered);
	RUN_TEST(test_each_answer_for_a_device_is_counted_with_what_it_cost);
	RUN_TEST(test_an_error_is_that_of_its_device);
	RUN_TEST(test_a_device_that_stays_absent_is_counted_until_it_is_known_to_be);
	RUN_TEST(test_what_a_bus_knows_stays_when_a_later_answer_does_not_say_it);
	RUN_TEST(test_an_identity_that_is_too_long_is_cut);
	RUN_TEST(test_a_late_answer_counts_with_the_wire_that_it_took);
	RUN_TEST(test_a_reload_keeps_what_was_counted_also_under_other_names);
	RUN_TEST(test_a_reload_keeps_them_where_devices_come_and_go);
	RUN_TEST(test_a_target_that_a_reload_takes_away_has_answered_nothing);
	return UNITY_END();
}
