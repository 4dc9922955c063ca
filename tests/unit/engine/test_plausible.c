/* SPDX-License-Identifier: MIT */
/* Answers that cannot be true: refused by their bus, or no value of the signal's type. */
#include <errno.h>

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

static void test_a_reading_that_its_bus_refuses_is_never_published(void)
{
	static const struct {
		int err;
		uint8_t quality;
		const char *counter;
	} rows[] = {{-EDOM, OWS_Q_DEVICE, "out_of_range"}, {-ERANGE, OWS_Q_SENSOR, "power_faults"}};

	two_thermometers();
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		scene_put(&s, T1, "-999.9", rows[i].err);
		for (int k = 0; k < 50; k++) {
			scene_run(&s, 100 * SCENE_MS);
			TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
		}
		TEST_ASSERT_EQUAL_HEX8(rows[i].quality, scene_sample(&s, 1).quality);
		TEST_ASSERT_EQUAL_INT(rows[i].err, scene_sample(&s, 1).err);
		TEST_ASSERT_GREATER_THAN(3, scene_counter(&s, rows[i].counter));
		scene_expect(&s, 2, OWS_Q_GOOD, 0);
		scene_put(&s, T1, "21.5", 0);
		scene_run(&s, 61 * SCENE_S);
		scene_expect(&s, 1, OWS_Q_GOOD, 0);
	}
}

static void test_one_reading_that_is_refused_is_a_retry(void)
{
	two_thermometers();
	scene_put(&s, T1, "-999.9", -EDOM);
	scene_run(&s, 50 * SCENE_MS);
	scene_put(&s, T1, "22.5", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	TEST_ASSERT_EQUAL_INT(0, scene_sample(&s, 1).err);
}

static void test_a_fraction_for_an_integer_is_an_error_of_the_item(void)
{
	scene_input(&s, "in", SENSED, OWS_BYTE);
	scene_put(&s, SENSED, "21", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 50 * SCENE_MS);
	scene_expect(&s, 1, OWS_Q_GOOD, 0);
	scene_put(&s, SENSED, "21.5", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_INT64(21, scene_sample(&s, 1).value);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TYPE, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_INT(-EILSEQ, scene_sample(&s, 1).err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reading_that_its_bus_refuses_is_never_published);
	RUN_TEST(test_one_reading_that_is_refused_is_a_retry);
	RUN_TEST(test_a_fraction_for_an_integer_is_an_error_of_the_item);
	return UNITY_END();
}
