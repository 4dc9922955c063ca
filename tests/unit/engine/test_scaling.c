/* SPDX-License-Identifier: MIT */
/* Engineering values in the engine: what is read is scaled, filtered, judged; commands go back. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/table.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/scene.h"

#define VOLT "/20.000000000001/volt.A"
#define WIPER "/2C.000000000002/wiper"
#define PIO "/3A.000000000003/PIO.A"

static struct scene s;
static const struct scale_point current_loop[] = {{1, 0}, {5, 100}};
static const struct scale_point wiper_steps[] = {{0, 0}, {255, 100}};

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

static struct config_item *level(void)
{
	struct config_item *item = scene_input(&s, "level", VOLT, OWS_DOUBLE);

	item->scale = (struct scale){.points = current_loop, .count = 2};
	scene_put(&s, VOLT, "3", 0);
	return item;
}

static struct config_item *valve(void)
{
	struct config_item *item = scene_output(&s, "valve", WIPER, OWS_DOUBLE);

	item->scale = (struct scale){.points = wiper_steps, .count = 2};
	scene_put(&s, WIPER, "0", 0);
	return item;
}

static void start(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 250 * SCENE_MS);
}

static void measure(const char *text)
{
	scene_put(&s, VOLT, text, 0);
	scene_run(&s, 200 * SCENE_MS);
}

static double raw(unsigned record)
{
	return value_number(OWS_DOUBLE, scene_attrs(&s, record).raw);
}

static void command(unsigned record, double value)
{
	scene_set(&s, record, value_of_double(value));
	scene_run(&s, 200 * SCENE_MS);
}

/* --- Reading --------------------------------------------------------------------------------- */

static void test_what_is_read_is_scaled_and_the_raw_value_is_kept(void)
{
	level();
	start();
	TEST_ASSERT_EQUAL_DOUBLE(50, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(3, raw(1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_the_raw_value_of_what_is_not_scaled_is_its_value(void)
{
	scene_input(&s, "plain", VOLT, OWS_BYTE);
	scene_put(&s, VOLT, "3", 0);
	start();
	TEST_ASSERT_EQUAL_INT64(3, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_DOUBLE(3, raw(1));
}

static void test_beyond_the_points_a_value_is_held_and_out_of_range(void)
{
	level();
	start();
	measure("0.2");
	TEST_ASSERT_EQUAL_DOUBLE(0, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(0.2, raw(1));
	scene_expect(&s, 1, OWS_Q_LOW, 0);
	measure("5.1");
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_HIGH, 0);
	measure("5");
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

static void test_a_value_beyond_min_or_max_is_shown_with_quality_out_of_range(void)
{
	struct config_item *item = level();

	item->scale.has_min = true;
	item->scale.min = -2.5;
	start();
	measure("0.95");
	TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1.25, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	measure("0");
	TEST_ASSERT_EQUAL_DOUBLE(-25, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_RANGE, 0);
	TEST_ASSERT_EQUAL_INT(0, scene_sample(&s, 1).err);
}

static void test_the_value_of_an_integer_type_is_rounded(void)
{
	static const struct {
		const char *volt;
		int64_t percent;
	} cases[] = {{"3", 50}, {"1.0196", 0}, {"1.0204", 1}, {"4.99", 100}, {"3.0596", 51}};

	level()->type = OWS_BYTE;
	start();
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		measure(cases[i].volt);
		TEST_ASSERT_EQUAL_INT64(cases[i].percent, scene_sample(&s, 1).value);
		scene_expect(&s, 1, OWS_Q_GOOD, 0);
	}
}

static void test_a_scaled_value_that_the_type_cannot_hold_is_held_at_its_end(void)
{
	struct config_item *item = level();

	item->type = OWS_BYTE;
	item->scale = (struct scale){.linear = true, .factor = 100};
	start();
	measure("3");
	TEST_ASSERT_EQUAL_INT64(255, scene_sample(&s, 1).value);
	scene_expect(&s, 1, OWS_Q_HIGH, 0);
}

static void test_a_bool_is_inverted(void)
{
	struct config_item *item = scene_input(&s, "closed", PIO, OWS_BOOL);
	struct config_item *relay = scene_output(&s, "relay", PIO "2", OWS_BOOL);

	item->scale = relay->scale = (struct scale){.linear = true, .factor = -1, .offset = 1};
	scene_put(&s, PIO, "1", 0);
	scene_put(&s, PIO "2", "1", 0);
	start();
	TEST_ASSERT_EQUAL_INT64(0, scene_sample(&s, 1).value);
	scene_put(&s, PIO, "0", 0);
	scene_set(&s, 2, 1);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT64(1, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, PIO "2"));
	TEST_ASSERT_EQUAL_INT64(1, scene_sample(&s, 2).value);
}

static void test_limits_are_of_the_engineering_value(void)
{
	struct config_item *item = level();

	item->limits = (struct config_limits){
		.any = true, .has = {[CONFIG_LIMIT_H] = true}, .limit = {[CONFIG_LIMIT_H] = 80}};
	start();
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_NORMAL, scene_attrs(&s, 1).limit_state);
	measure("4.2");
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, 1).limit_state);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_H, scene_attrs(&s, 1).limit_condition);
	/* in the journal too */
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80, value_number(OWS_DOUBLE, s.image.alarms[0].after));
}

/* --- Filter ---------------------------------------------------------------------------------- */

/* Read once a second; each answer is measured when it comes. */
static struct config_item *filtered(void)
{
	struct config_item *item = level();

	item->filter_s = 4;
	item->per_factor = 10;
	return item;
}

static void test_the_first_good_value_is_not_filtered(void)
{
	filtered();
	start();
	TEST_ASSERT_EQUAL_DOUBLE(50, scene_number(&s, 1));
}

static void test_a_step_is_filtered_by_the_time_that_passed(void)
{
	int64_t begin, last;

	filtered();
	start();
	begin = scene_sample(&s, 1).measured_ns;
	scene_put(&s, VOLT, "5", 0);
	scene_run(&s, 7 * SCENE_S);
	last = scene_sample(&s, 1).measured_ns;
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100 - 50 * exp(-(double)(last - begin) / (4 * SCENE_S)),
	                          scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(5, raw(1));
}

static void test_a_reading_that_failed_leaves_a_longer_time_to_the_next(void)
{
	int64_t begin, last;

	filtered();
	s.config.max_retries = 100;
	start();
	begin = scene_sample(&s, 1).measured_ns;
	scene_put(&s, VOLT, NULL, -EIO);
	scene_run(&s, 1500 * SCENE_MS);
	scene_put(&s, VOLT, "5", 0);
	scene_run(&s, 2 * SCENE_S);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	last = scene_sample(&s, 1).measured_ns;
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100 - 50 * exp(-(double)(last - begin) / (4 * SCENE_S)),
	                          scene_number(&s, 1));
}

static void test_the_filter_begins_anew_after_a_bad_value(void)
{
	filtered();
	start();
	scene_put(&s, VOLT, NULL, -EIO);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_FALSE(ows_good(scene_sample(&s, 1).quality));
	scene_put(&s, VOLT, "5", 0);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
}

static void test_a_value_out_of_range_shows_at_once_and_is_not_filtered(void)
{
	filtered();
	start();
	scene_put(&s, VOLT, "0.1", 0);
	scene_run(&s, 1100 * SCENE_MS);
	TEST_ASSERT_EQUAL_DOUBLE(0, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_LOW, 0);
	scene_put(&s, VOLT, "2", 0);
	scene_run(&s, 1100 * SCENE_MS);
	TEST_ASSERT_EQUAL_DOUBLE(25, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
}

/* --- Writing --------------------------------------------------------------------------------- */

static void test_a_command_is_written_as_its_raw_value(void)
{
	valve();
	start();
	command(1, 100);
	TEST_ASSERT_EQUAL_STRING("255", scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(255, raw(1));
	TEST_ASSERT_EQUAL_UINT8(0, scene_sample(&s, 1).flags & OWS_SAMPLE_PENDING);
	command(1, 50);
	TEST_ASSERT_EQUAL_STRING("127.5", scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL_DOUBLE(50, scene_number(&s, 1));
}

static struct bus_req last_write;

static void keep_the_write(struct scene_bus *bus, const struct bus_req *req)
{
	(void)bus;
	if (req->op == BUS_WRITE)
		last_write = *req;
}

static void goes_out(enum ows_type type, int64_t value, bool number, const char *text)
{
	struct config_item *item = scene_output(&s, "valve", WIPER, type);

	scene_put(&s, WIPER, "0", 0);
	item->scale = (struct scale){0};
	s.on_done = keep_the_write;
	start();
	scene_set(&s, 1, value);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING(text, scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL(number, last_write.number);
	TEST_ASSERT_EQUAL(type == OWS_FLOAT, last_write.single);
	if (number)
		TEST_ASSERT_EQUAL_DOUBLE(value_number(type, value), last_write.value);
	scene_end(&s);
	scene_init(&s);
}

static void test_a_command_goes_to_the_bus_as_the_number_that_it_is(void)
{
	goes_out(OWS_BOOL, 1, true, "1");
	goes_out(OWS_DOUBLE, value_of_double(0.1), true, "0.1");
	goes_out(OWS_FLOAT, value_of_double((double)0.1f), true, "0.1");
	goes_out(OWS_DWORD, UINT32_MAX, true, "4294967295");
	goes_out(OWS_LARGE, INT64_C(-999999999999999), true, "-999999999999999");
	/* a double would round it, or print it with an exponent */
	goes_out(OWS_LARGE, INT64_C(1000000000000000), false, "1000000000000000");
	goes_out(OWS_LARGE, INT64_MAX, false, "9223372036854775807");
}

static void test_a_property_of_whole_numbers_gets_the_nearest(void)
{
	valve()->whole = true;
	start();
	scene_clear_trace(&s);
	command(1, 50);
	TEST_ASSERT_EQUAL_STRING("W " WIPER "=128\n", s.trace);
	TEST_ASSERT_EQUAL_DOUBLE(50, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(128, raw(1));
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_what_the_nearest_raw_value_gives_is_the_command_when_it_is_read_back(void)
{
	struct config_item *item = valve();

	/* the nearest to 99.9 is 255, which is 100 and out of range by itself */
	item->readable = item->scale.has_max = true;
	item->scale.max = 99.9;
	item->whole = true;
	start();
	command(1, 99.9);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(99.9, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(255, raw(1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	scene_put(&s, WIPER, "254", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 25400 / 255.0, scene_number(&s, 1));
}

static void test_a_command_beyond_the_range_is_refused_and_not_written(void)
{
	static const double beyond[] = {-0.001, 100.001, 1e300};

	valve();
	start();
	command(1, 40);
	scene_clear_trace(&s);
	for (size_t i = 0; i < sizeof(beyond) / sizeof(beyond[0]); i++) {
		command(1, beyond[i]);
		TEST_ASSERT_EQUAL_INT(-ERANGE, scene_slot(&s, 1)->err);
		TEST_ASSERT_EQUAL_STRING("102", scene_at(&s, WIPER));
		TEST_ASSERT_EQUAL_DOUBLE(40, scene_number(&s, 1));
	}
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	TEST_ASSERT_EQUAL_UINT64(3, scene_counter(&s, "refused_commands"));
}

static void test_a_command_beyond_min_or_max_is_refused_without_a_scale_too(void)
{
	struct config_item *item = scene_output(&s, "valve", WIPER, OWS_BYTE);

	item->scale = (struct scale){.has_max = true, .max = 200};
	scene_put(&s, WIPER, "0", 0);
	start();
	scene_set(&s, 1, 201);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT(-ERANGE, scene_slot(&s, 1)->err);
	scene_set(&s, 1, 200);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("200", scene_at(&s, WIPER));
}

static void test_init_value_is_an_engineering_value(void)
{
	struct config_item *item = valve();

	item->has_init = true;
	item->init_value = value_of_double(20);
	start();
	TEST_ASSERT_EQUAL_STRING("51", scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL_DOUBLE(20, scene_number(&s, 1));
}

static void test_an_output_is_read_back_as_it_was_written(void)
{
	valve()->readable = true;
	start();
	command(1, 40);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(40, scene_number(&s, 1));
	/* the device says otherwise: that is published, and no reason to write */
	scene_put(&s, WIPER, "51", 0);
	scene_clear_trace(&s);
	s.writes = 0;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(20, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

/* --- Reload ---------------------------------------------------------------------------------- */

static void twice_the_scale(struct config *config)
{
	config->items[0].scale = (struct scale){.linear = true, .factor = 50, .offset = -50};
}

static void test_a_reload_that_changes_the_scale_shows_the_value_in_it_at_once(void)
{
	level();
	start();
	scene_reload(&s, twice_the_scale);
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_DOUBLE(3, raw(1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
}

static void tenths(struct config *config)
{
	config->items[0].scale = (struct scale){.linear = true, .factor = 0.5};
}

static void test_a_reload_that_changes_the_scale_writes_the_command_in_it(void)
{
	valve();
	start();
	command(1, 20);
	TEST_ASSERT_EQUAL_STRING("51", scene_at(&s, WIPER));
	scene_reload(&s, tenths);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("40", scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL_DOUBLE(20, scene_number(&s, 1));
}

/* A set of an input was an event: by then it may stand otherwise at the device. */
static void test_a_reload_that_changes_the_scale_writes_no_set_of_an_input(void)
{
	valve()->output = false;
	start();
	command(1, 20);
	TEST_ASSERT_EQUAL_STRING("51", scene_at(&s, WIPER));
	scene_reload(&s, tenths);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("51", scene_at(&s, WIPER));
	command(1, 20); /* the same number is another set */
	TEST_ASSERT_EQUAL_STRING("40", scene_at(&s, WIPER));
}

static void wider(struct config *config)
{
	config->items[0].scale.has_max = true;
	config->items[0].scale.max = 110;
}

static void test_a_reload_that_changes_the_range_alone_writes_nothing(void)
{
	valve();
	start();
	command(1, 20);
	scene_clear_trace(&s);
	scene_reload(&s, wider);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
}

static void narrow(struct config *config)
{
	config->items[0].scale = (struct scale){
		.linear = true, .factor = 0.5, .has_max = true, .max = 10};
}

static void test_a_command_that_a_reload_puts_out_of_range_is_not_written(void)
{
	valve();
	start();
	command(1, 20);
	scene_clear_trace(&s);
	scene_reload(&s, narrow);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("", s.trace);
	TEST_ASSERT_EQUAL_INT(-ERANGE, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_UINT8(0, scene_sample(&s, 1).flags & OWS_SAMPLE_PENDING);
	command(1, 10);
	TEST_ASSERT_EQUAL_STRING("20", scene_at(&s, WIPER));
	TEST_ASSERT_EQUAL_INT(0, scene_sample(&s, 1).err);
}

static void test_the_filter_goes_on_over_a_reload_that_leaves_it(void)
{
	double before;

	filtered();
	start();
	scene_put(&s, VOLT, "5", 0);
	scene_run(&s, 2 * SCENE_S);
	before = scene_number(&s, 1);
	scene_reload(&s, NULL);
	scene_run(&s, 1500 * SCENE_MS);
	TEST_ASSERT_TRUE(before < scene_number(&s, 1) && scene_number(&s, 1) < 95);
}

static void faster(struct config *config)
{
	config->items[0].filter_s = 3;
}

static void test_the_filter_begins_anew_with_another_time_constant(void)
{
	filtered();
	start();
	scene_put(&s, VOLT, "5", 0);
	scene_run(&s, 2 * SCENE_S);
	scene_reload(&s, faster);
	scene_run(&s, 1500 * SCENE_MS);
	TEST_ASSERT_EQUAL_DOUBLE(100, scene_number(&s, 1));
}

/* --- Metadata -------------------------------------------------------------------------------- */

static struct image_meta meta_of(struct config_item item)
{
	struct image_meta meta;

	item.decimals = -1;
	signal_table_meta(&item, &meta);
	return meta;
}

static void test_a_thermometer_has_unit_and_decimals_without_being_told(void)
{
	static const struct {
		const char *path, *unit;
		int decimals;
	} cases[] = {
		{"/28.000000000001/temperature",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/10.000000000001/temperature9",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/22.000000000001/temperature10",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/3B.000000000001/temperature11",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/42.000000000001/temperature12",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/boiler/temperature",
	         "\xc2\xb0"
	         "C",
	         1},
		{"/26.000000000001/humidity", "%", 1},
		{"/26.000000000001/VAD", "V", 2},
		{"/20.000000000001/volt.A", "V", 3},
		{"/12.000000000001/TAI8570/pressure", "mbar", 1},
		{"/1D.000000000001/counter.A", "", 0},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct image_meta meta = meta_of(
			(struct config_item){.path = cases[i].path, .type = OWS_DOUBLE});

		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].unit, meta.unit, cases[i].path);
		TEST_ASSERT_EQUAL_UINT32(cases[i].decimals, meta.decimals);
	}
}

static void test_what_is_converted_has_the_digits_that_a_person_wants(void)
{
	static const struct {
		const char *path, *unit;
		double factor;
		int decimals;
	} cases[] = {
		{"/28.000000000001/temperature9", "\u00b0F", 1.8, 1},
		{"/26.000000000001/VAD", "mV", 1000, 0},
		{"/12.000000000001/TAI8570/pressure", "kPa", 0.1, 2},
		{"/12.000000000001/TAI8570/pressure", "psi", 0.0145, 2},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct config_item item = {.path = cases[i].path,
		                           .type = OWS_DOUBLE,
		                           .unit = cases[i].unit,
		                           .converted = true};

		item.scale = (struct scale){.linear = true, .factor = cases[i].factor};
		TEST_ASSERT_EQUAL_STRING(cases[i].unit, meta_of(item).unit);
		TEST_ASSERT_EQUAL_UINT32_MESSAGE(cases[i].decimals, meta_of(item).decimals,
		                                 cases[i].unit);
	}
}

static void test_what_is_scaled_has_the_unit_that_the_file_says_and_no_other(void)
{
	struct config_item item = {.path = VOLT, .type = OWS_DOUBLE};
	struct image_meta meta;

	item.scale = (struct scale){.linear = true, .factor = 2};
	meta = meta_of(item);
	TEST_ASSERT_NULL(meta.unit);
	TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, meta.decimals);
	TEST_ASSERT_EQUAL_DOUBLE(2, meta.scale);
	TEST_ASSERT_DOUBLE_IS_NAN(meta.min);
	item.unit = "bar";
	item.scale.has_min = true;
	meta = meta_of(item);
	TEST_ASSERT_EQUAL_STRING("bar", meta.unit);
	TEST_ASSERT_EQUAL_UINT32(3, meta.decimals);
	item.unit = "furlong";
	TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, meta_of(item).decimals);
	item.decimals = 7;
	TEST_ASSERT_EQUAL_DOUBLE(0, meta.min);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_read_is_scaled_and_the_raw_value_is_kept);
	RUN_TEST(test_the_raw_value_of_what_is_not_scaled_is_its_value);
	RUN_TEST(test_beyond_the_points_a_value_is_held_and_out_of_range);
	RUN_TEST(test_a_value_beyond_min_or_max_is_shown_with_quality_out_of_range);
	RUN_TEST(test_the_value_of_an_integer_type_is_rounded);
	RUN_TEST(test_a_scaled_value_that_the_type_cannot_hold_is_held_at_its_end);
	RUN_TEST(test_a_bool_is_inverted);
	RUN_TEST(test_limits_are_of_the_engineering_value);
	RUN_TEST(test_the_first_good_value_is_not_filtered);
	RUN_TEST(test_a_step_is_filtered_by_the_time_that_passed);
	RUN_TEST(test_a_reading_that_failed_leaves_a_longer_time_to_the_next);
	RUN_TEST(test_the_filter_begins_anew_after_a_bad_value);
	RUN_TEST(test_a_value_out_of_range_shows_at_once_and_is_not_filtered);
	RUN_TEST(test_a_command_is_written_as_its_raw_value);
	RUN_TEST(test_a_command_goes_to_the_bus_as_the_number_that_it_is);
	RUN_TEST(test_a_property_of_whole_numbers_gets_the_nearest);
	RUN_TEST(test_what_the_nearest_raw_value_gives_is_the_command_when_it_is_read_back);
	RUN_TEST(test_a_command_beyond_the_range_is_refused_and_not_written);
	RUN_TEST(test_a_command_beyond_min_or_max_is_refused_without_a_scale_too);
	RUN_TEST(test_init_value_is_an_engineering_value);
	RUN_TEST(test_an_output_is_read_back_as_it_was_written);
	RUN_TEST(test_a_reload_that_changes_the_scale_shows_the_value_in_it_at_once);
	RUN_TEST(test_a_reload_that_changes_the_scale_writes_the_command_in_it);
	RUN_TEST(test_a_reload_that_changes_the_scale_writes_no_set_of_an_input);
	RUN_TEST(test_a_reload_that_changes_the_range_alone_writes_nothing);
	RUN_TEST(test_a_command_that_a_reload_puts_out_of_range_is_not_written);
	RUN_TEST(test_the_filter_goes_on_over_a_reload_that_leaves_it);
	RUN_TEST(test_the_filter_begins_anew_with_another_time_constant);
	RUN_TEST(test_a_thermometer_has_unit_and_decimals_without_being_told);
	RUN_TEST(test_what_is_converted_has_the_digits_that_a_person_wants);
	RUN_TEST(test_what_is_scaled_has_the_unit_that_the_file_says_and_no_other);
	return UNITY_END();
}
