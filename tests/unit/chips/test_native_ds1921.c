/* SPDX-License-Identifier: MIT */
/* DS1921 on the native bus: its clock, its missions, and what they have logged. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/owfs/path.h"
#include "tests/unit/aid/native_scene.h"
#include "unity.h"

static struct sim_slave *chip;

void setUp(void)
{
	setenv("TZ", "UTC0", 1);
	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, "DS1921G", 1);
	start();
	wire_set(chip, "temperature", 21.5);
}

void tearDown(void)
{
	native_end();
}

static void put(const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_WRITE, of(chip, property), text), property);
}

static void refuse(int err, const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, result(BUS_WRITE, of(chip, property), text), property);
}

static void is(const char *property, const char *text)
{
	expect(true, of(chip, property), text);
	forget();
}

static void pass(int64_t minutes)
{
	host_run(&host, bus, host.now + minutes * 60 * HOST_S);
}

/* 2026-11-22 10:00:00, and a mission of one sample a minute. */
static void begin_mission(void)
{
	put("clock/date", "Sun Nov 22 10:00:00 2026");
	put("mission/enable", "1");
	put("mission/clear", "1");
	put("mission/frequency", "1");
	is("mission/running", "1");
}

static void test_the_temperature_is_converted(void)
{
	is("temperature", "        21.5");
	wire_set(chip, "temperature", -12);
	is("temperature", "         -12");
	is("about/version", "DS1921G-F5");
	is("about/resolution", "         0.5");
	is("histogram/gap", "           2");
	is("histogram/temperature.2", "         -36");
	is("about/samples", "           2");
}

/* The id says what a degree is: of an unknown one no value can be good, and that is the reason. */
static void test_an_id_of_no_known_version_gives_its_reason(void)
{
	static const char *const properties[] = {"temperature", "about/version", "about/resolution",
	                                         "log/temperature.0"};

	tearDown();
	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, "DS1921G", 1);
	chip->rom[6] = 0x77;
	chip->rom[7] = rom_crc8(chip->rom, 7);
	start();
	for (unsigned i = 0; i < sizeof(properties) / sizeof(properties[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EMEDIUMTYPE,
		                              result(BUS_READ, of(chip, properties[i]), NULL),
		                              properties[i]);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip, "clock/date"), NULL));
}

/* TCB of the status is 0 while it converts. */
static void test_a_conversion_under_way_shows_as_measuring(void)
{
	size_t size;

	is("temperature", "        21.5");
	is("about/measuring", "0");
	sim_slave_memory(chip, &size)[0x214] &= 0x7f;
	is("about/measuring", "1");
}

/* Of all months, the first and the last: owserver is a month late. */
static void test_the_clock_has_the_date_that_was_set(void)
{
	static const char *const dates[] = {"Thu Jan  1 00:00:10 2026", "Sun Nov 22 23:59:30 2026",
	                                    "Thu Dec 31 12:30:00 2026", "Thu Feb 29 13:00:00 2024"};

	for (unsigned i = 0; i < 4; i++) {
		char now[30];

		put("clock/date", dates[i]);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip, "clock/date"), NULL));
		forget();
		expect(false, of(chip, "clock/running"), "1");
		forget();
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "clock/date"), NULL);
		const struct bus_answer *answer = answer_to(id);

		TEST_ASSERT_EQUAL_UINT32(24, answer->len);
		memcpy(now, data[id], 24);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(dates[i], now, 17, "but for the seconds");
		TEST_ASSERT_EQUAL_MEMORY(dates[i] + 19, now + 19, 5);
		forget();
	}
	put("clock/running", "0");
	put("clock/udate", "1000000000");
	is("clock/udate", "  1000000000");
	pass(2);
	is("clock/udate", "  1000000000");
}

static void test_a_mission_logs_a_sample_at_each_interval(void)
{
	begin_mission();
	for (int i = 0; i < 5; i++) {
		wire_set(chip, "temperature", 10 + i);
		pass(1);
	}
	is("mission/samples", "           5");
	is("log/elements", "           5");
	is("log/temperature.0", "          10");
	is("log/temperature.4", "          14");
	is("mission/date", "Sun Nov 22 10:00:00 2026");
	is("log/date.0", "Sun Nov 22 10:00:00 2026");
	is("log/date.4", "Sun Nov 22 10:04:00 2026");
	is("histogram/counts.25", "           2");
	is("histogram/counts.26", "           2");
	put("mission/running", "0");
	is("mission/running", "0");
	pass(3);
	is("mission/samples", "           5");
}

static void test_a_log_that_rolls_over_begins_with_its_oldest_sample(void)
{
	put("mission/rollover", "1");
	wire_set(chip, "temperature", 10);
	begin_mission();
	pass(2048);
	wire_set(chip, "temperature", 30);
	pass(2);
	is("mission/samples", "        2050");
	is("log/elements", "        2048");
	is("log/temperature.0", "          10");
	is("log/temperature.2045", "          10");
	is("log/temperature.2046", "          30");
	is("log/temperature.2047", "          30");
	is("log/date.0", "Sun Nov 22 10:02:00 2026");
}

static void test_a_mission_that_runs_keeps_its_settings(void)
{
	begin_mission();
	refuse(-EBUSY, "clock/date", "Sun Nov 22 10:00:00 2026");
	refuse(-EBUSY, "mission/delay", "3");
	put("mission/delay", "0"); /* it is that already */
	refuse(-EBUSY, "mission/clear", "1");
	refuse(-EBUSY, "mission/frequency", "3");
	refuse(-EBUSY, "overtemp/temperature", "30");
	TEST_ASSERT_EQUAL_INT(-EBUSY, result(BUS_READ, of(chip, "temperature"), NULL));
	is("mission/running", "1");
	is("mission/frequency", "           1");
}

static void test_a_mission_needs_a_cleared_memory(void)
{
	begin_mission();
	pass(1);
	put("mission/running", "0");
	refuse(-EIO, "mission/running", "1");
	is("mission/running", "0");
	put("mission/clear", "1");
	is("mission/samples", "           0");
	refuse(-EINVAL, "mission/running", "1"); /* no interval */
	put("mission/frequency", "2");
	is("mission/running", "1");
}

/* The chip runs in virtual time, a little ahead of the host's clock. */
static void is_present_time(const char *property)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, property), NULL);

	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_DOUBLE_WITHIN(3600, (double)time(NULL), strtod((char *)data[id], NULL));
	forget();
}

static void test_a_date_that_is_written_empty_is_the_present_time(void)
{
	put("clock/udate", "1000000000");
	put("clock/date", "");
	is_present_time("clock/udate");
}

static void test_easystart_does_all_of_it(void)
{
	begin_mission();
	pass(3);
	put("mission/easystart", "5");
	is_present_time("clock/udate");
	is("mission/running", "1");
	is("mission/frequency", "           5");
	is("mission/samples", "           0");
	is("set_alarm/temphigh", "1");
	pass(11);
	is("mission/samples", "           2");
	put("mission/easystart", "0");
	is("mission/running", "0");
}

static void test_times_beyond_the_limits_have_begin_and_end(void)
{
	put("overtemp/temperature", "30");
	put("undertemp/temperature", "0");
	is("overtemp/temperature", "          30");
	is("undertemp/temperature", "           0");
	begin_mission();
	pass(2);
	wire_set(chip, "temperature", 35);
	pass(3);
	wire_set(chip, "temperature", 20);
	pass(1);
	is("overtemp/elements", "           1");
	is("undertemp/elements", "           0");
	is("overtemp/count.0", "           3");
	is("overtemp/date.0", "Sun Nov 22 10:03:00 2026");
	is("overtemp/end.0", "Sun Nov 22 10:06:00 2026");
	is("mission/temphigh", "1");
	is("mission/templow", "0");
	put("mission/temphigh", "0");
	is("mission/temphigh", "0");
	is("mission/running", "1");
	refuse(-EIO, "mission/templow", "1");
}

static void test_settings_are_bits_of_the_registers(void)
{
	static const char *const bits[] = {"set_alarm/date", "set_alarm/temphigh",
	                                   "set_alarm/templow", "mission/rollover"};

	for (unsigned i = 0; i < 4; i++) {
		put(bits[i], "1");
		is(bits[i], "1");
		put(bits[i], "0");
		is(bits[i], "0");
	}
	put("alarm_hour", "18");
	put("alarm_trigger", "3");
	is("alarm_hour", "          18");
	is("alarm_trigger", "           4"); /* the last register whose bit is set, as in OWFS */
	put("alarm_trigger", "0");
	is("alarm_trigger", "           0");
	is("alarm_hour", "          18");
	put("mission/delay", "300");
	is("mission/delay", "         300");
	refuse(-EINVAL, "mission/delay", "65536");
	refuse(-EINVAL, "overtemp/temperature", "200");
}

static void test_its_memory_is_read_and_written(void)
{
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "pages/page.3"), "a logger"));
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);

	TEST_ASSERT_EQUAL_UINT32(512, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY("a logger", data[id] + 96, 8);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_temperature_is_converted);
	RUN_TEST(test_an_id_of_no_known_version_gives_its_reason);
	RUN_TEST(test_a_conversion_under_way_shows_as_measuring);
	RUN_TEST(test_the_clock_has_the_date_that_was_set);
	RUN_TEST(test_a_mission_logs_a_sample_at_each_interval);
	RUN_TEST(test_a_log_that_rolls_over_begins_with_its_oldest_sample);
	RUN_TEST(test_a_mission_that_runs_keeps_its_settings);
	RUN_TEST(test_a_mission_needs_a_cleared_memory);
	RUN_TEST(test_a_date_that_is_written_empty_is_the_present_time);
	RUN_TEST(test_easystart_does_all_of_it);
	RUN_TEST(test_times_beyond_the_limits_have_begin_and_end);
	RUN_TEST(test_settings_are_bits_of_the_registers);
	RUN_TEST(test_its_memory_is_read_and_written);
	return UNITY_END();
}
