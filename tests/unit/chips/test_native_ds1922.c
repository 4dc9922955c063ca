/* SPDX-License-Identifier: MIT */
/* DS1922, DS1923 and DS2422 on the native bus: clock, missions, and what they have logged. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/aid/native_scene.h"
#include "unity.h"

static struct sim_slave *chip;

void setUp(void)
{
	setenv("TZ", "UTC0", 1);
	native_begin();
	wire_init(&host, 1, 1);
}

void tearDown(void)
{
	native_end();
}

static void plug(const char *part)
{
	chip = wire_add(0, part, 1);
	start();
	wire_set(chip, "temperature", 21.5);
}

static void put(const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_WRITE, of(chip, property), text), property);
}

static void refuse(int err, const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, result(BUS_WRITE, of(chip, property), text), property);
}

static void fails(int err, const char *property)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, result(BUS_READ, of(chip, property), NULL), property);
}

static void is(const char *property, const char *text)
{
	expect(true, of(chip, property), text);
	forget();
}

static double number(const char *property)
{
	const struct bus_answer *answer = answer_to(
		ask(BUS_READ, BUS_INPUT, true, of(chip, property), NULL));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	return answer->number;
}

static void pass(int64_t seconds)
{
	host_run(&host, bus, host.now + seconds * HOST_S);
}

static void begin_mission(const char *interval)
{
	put("clock/date", "Sun Nov 22 10:00:00 2026");
	put("mission/interval", interval);
	put("mission/running", "1");
	is("mission/running", "1");
}

static void test_temperature_and_humidity_are_converted(void)
{
	plug("DS1923");
	wire_set(chip, "humidity", 40);
	is("temperature", "        21.5");
	TEST_ASSERT_DOUBLE_WITHIN(0.05, 40, number("humidity"));
	wire_set(chip, "temperature", -12.25);
	is("temperature", "      -12.25");
}

static void test_each_part_has_a_scale_of_its_own(void)
{
	plug("DS1922T");
	wire_set(chip, "temperature", 110.0625);
	is("temperature", "     110.062");
	fails(-ENOENT, "humidity");
}

static void test_it_does_not_convert_without_its_clock(void)
{
	plug("DS1922L");
	put("clock/running", "0");
	is("clock/running", "0");
	fails(-EIO, "temperature");
	put("clock/running", "1");
	is("temperature", "        21.5");
}

static void test_the_clock_has_the_date_that_was_set(void)
{
	plug("DS1923");
	put("clock/running", "0");
	put("clock/udate", "1798761599");
	is("clock/date", "Thu Dec 31 23:59:59 2026");
	put("clock/date", "Thu Feb 29 13:00:00 2024");
	is("clock/running", "1");
	TEST_ASSERT_DOUBLE_WITHIN(2, 1709211601, number("clock/udate"));
}

static void test_a_mission_logs_both_quantities(void)
{
	plug("DS1923");
	begin_mission("10");
	for (int i = 0; i < 5; i++) {
		wire_set(chip, "temperature", 10 + i);
		wire_set(chip, "humidity", 30 + 5 * i);
		pass(10);
	}
	put("mission/running", "0");
	is("mission/running", "0");
	double n = number("log/elements");

	TEST_ASSERT_DOUBLE_WITHIN(1, 6, n);
	is("mission/samplingtemp", "1");
	is("mission/samplinghumidity", "1");
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 14, number("log/temperature.5"));
	TEST_ASSERT_DOUBLE_WITHIN(0.05, 50, number("log/humidity.5"));
	TEST_ASSERT_EQUAL_DOUBLE(number("mission/udate"), number("log/udate.0"));
	TEST_ASSERT_EQUAL_DOUBLE(number("log/udate.0") + 50, number("log/udate.5"));
}

static void test_a_log_that_rolls_over_begins_with_its_oldest_sample(void)
{
	plug("DS1922L");
	put("mission/rollover", "1");
	wire_set(chip, "temperature", 10);
	begin_mission("1");
	pass(4200);
	put("mission/running", "0");
	unsigned samples = (unsigned)number("mission/samples");

	TEST_ASSERT_GREATER_THAN_UINT(4096, samples);
	is("log/elements", "        4096");
	TEST_ASSERT_EQUAL_DOUBLE(number("mission/udate") + samples - 4096, number("log/udate.0"));
	is("log/temperature.4095", "          10");
	fails(-ENODATA, "log/temperature.4096");
	fails(-ENODATA, "log/humidity.0");
}

static void test_a_mission_that_runs_keeps_its_settings(void)
{
	plug("DS1923");
	begin_mission("60");
	refuse(-EBUSY, "clock/date", "Sun Nov 22 10:00:00 2026");
	refuse(-EBUSY, "mission/delay", "3");
	put("mission/delay", "0"); /* it is that already */
	refuse(-EBUSY, "mission/interval", "3");
	refuse(-EBUSY, "mission/running", "1");
	fails(-EBUSY, "temperature");
	is("mission/interval", "          60");
}

static void test_an_interval_has_seconds_or_whole_minutes(void)
{
	plug("DS1922L");
	refuse(-EINVAL, "mission/running", "1");
	put("mission/interval", "16383");
	is("mission/interval", "       16383");
	put("mission/interval", "36000");
	is("mission/interval", "       36000");
	refuse(-EINVAL, "mission/interval", "36001");
	refuse(-EINVAL, "mission/interval", "0");
	put("mission/delay", "70000");
	is("mission/delay", "       70000");
}

static void test_its_memory_is_read_and_written_and_its_registers_are_read(void)
{
	plug("DS2422");
	put("pages/page.15", "a logger");
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "pages/page.15"), NULL);

	TEST_ASSERT_EQUAL_UINT32(32, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY("a logger", data[id], 8);
	refuse(-EOPNOTSUPP, "pages/page.16", "no");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip, "pages/page.17"), NULL));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_temperature_and_humidity_are_converted);
	RUN_TEST(test_each_part_has_a_scale_of_its_own);
	RUN_TEST(test_it_does_not_convert_without_its_clock);
	RUN_TEST(test_the_clock_has_the_date_that_was_set);
	RUN_TEST(test_a_mission_logs_both_quantities);
	RUN_TEST(test_a_log_that_rolls_over_begins_with_its_oldest_sample);
	RUN_TEST(test_a_mission_that_runs_keeps_its_settings);
	RUN_TEST(test_an_interval_has_seconds_or_whole_minutes);
	RUN_TEST(test_its_memory_is_read_and_written_and_its_registers_are_read);
	return UNITY_END();
}
