/* SPDX-License-Identifier: MIT */
/* No clock of a chip is set to the time of a host that does not know the time. */
#include <errno.h>
#include <time.h>

#include "unity.h"

#include "hal/chips/loggers/host_clock.h"
#include "tests/unit/aid/native_scene.h"

static time_t host_says;

/* In place of the C library's. */
time_t time(time_t *out)
{
	if (out)
		*out = host_says;
	return host_says;
}

void setUp(void)
{
	host_says = 1800000000;
	native_begin();
	wire_init(&host, 1, 1);
}

void tearDown(void)
{
	native_end();
}

static void test_a_time_before_2026_is_none(void)
{
	double seconds = -1;

	host_says = 0;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, host_clock(&seconds));
	host_says = 1767225599;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, host_clock(&seconds));
	TEST_ASSERT_TRUE(seconds == -1);
	host_says++;
	TEST_ASSERT_EQUAL_INT(0, host_clock(&seconds));
	TEST_ASSERT_TRUE(seconds == 1767225600);
}

/* Is the chip's clock within a minute of this? */
static void is_about(const struct sim_slave *chip, const char *property, double expected)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, property), NULL);

	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_TRUE(answer_to(id)->number >= expected);
	TEST_ASSERT_TRUE(answer_to(id)->number < expected + 60);
	forget();
}

static void refuses(const char *name, const char *clock, const char *property, const char *text)
{
	struct sim_slave *chip = wire_add(0, name, 1);

	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, clock), "1790000000"));
	host_says = 86400;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, result(BUS_WRITE, of(chip, property), text));
	is_about(chip, clock, 1790000000);
	host_says = 1800000000;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, property), text));
	is_about(chip, clock, 1800000000);
}

static void test_an_empty_date_is_refused(void)
{
	refuses("DS2438", "udate", "date", "");
}

static void test_an_empty_date_of_a_logger_is_refused(void)
{
	refuses("DS1921G", "clock/udate", "clock/date", "");
}

static void test_a_mission_that_sets_the_clock_is_refused(void)
{
	refuses("DS1921G", "clock/udate", "mission/easystart", "5");
}

/* A mission of a minute's interval starts the clock where it stands. */
static void starts_a_clock(const char *name, const char *property, const char *first)
{
	struct sim_slave *chip = wire_add(0, name, 1);

	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, first), "1"));
	if (name[5] == '1') /* a DS1922 clears at each start */
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "mission/clear"), "1"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, "clock/running"), "0"));
	host_says = 86400;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, result(BUS_WRITE, of(chip, property), "1"));
	host_says = 1800000000;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(chip, property), "1"));
	is_about(chip, "clock/udate", 1800000000);
}

static void test_a_mission_that_starts_the_clock_is_refused(void)
{
	starts_a_clock("DS1921G", "mission/frequency", "mission/enable");
}

static void test_a_mission_of_seconds_that_starts_the_clock_is_refused(void)
{
	starts_a_clock("DS1922L", "mission/running", "mission/interval");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_time_before_2026_is_none);
	RUN_TEST(test_an_empty_date_is_refused);
	RUN_TEST(test_an_empty_date_of_a_logger_is_refused);
	RUN_TEST(test_a_mission_that_sets_the_clock_is_refused);
	RUN_TEST(test_a_mission_that_starts_the_clock_is_refused);
	RUN_TEST(test_a_mission_of_seconds_that_starts_the_clock_is_refused);
	return UNITY_END();
}
