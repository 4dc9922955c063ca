/* SPDX-License-Identifier: MIT */
/* MAX31888: its temperature is the truth or an error, and takes as long as the chip takes. */
#include <errno.h>
#include <stdlib.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static struct sim_slave *chip;
static struct trouble trouble;

void setUp(void)
{
}

void tearDown(void)
{
	native_end();
	wire_net.trouble = NULL;
}

static void begin(const char *part, bool parasite)
{
	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	chip = wire_add(0, part, 1);
	chip->parasite = parasite;
	wire_set(chip, "temperature", 21.5);
	start();
	forget();
}

static const struct bus_answer *measure(void)
{
	return answer_to(ask(BUS_READ, BUS_INPUT, true, of(chip, "temperature"), NULL));
}

static void expect_temperature(double celsius)
{
	const struct bus_answer *answer = measure();

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_DOUBLE_WITHIN(0.0001, celsius, answer->number);
}

static void test_it_measures_with_200_steps_a_degree(void)
{
	static const double celsius[] = {21.5, 0, -0.005, -40, 25.125, 84.995};
	static const char *const parts[] = {"MAX31888", "MAX30207"};

	for (unsigned part = 0; part < 4; part++) {
		begin(parts[part % 2], part > 1);
		for (unsigned i = 0; i < sizeof(celsius) / sizeof(celsius[0]); i++) {
			wire_set(chip, "temperature", celsius[i]);
			expect_temperature(celsius[i]);
		}
		tearDown();
	}
	begin("MAX31888", false);
}

/* Two maps were published. */
static void test_the_count_of_results_may_stand_in_another_register(void)
{
	begin("MAX31888", false);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(chip, "count", 4));
	for (unsigned i = 0; i < 40; i++) {
		wire_set(chip, "temperature", 20 + i);
		expect_temperature(20 + i);
	}
}

static void test_a_measurement_takes_little_more_than_the_chip(void)
{
	int64_t before;

	begin("MAX31888", false);
	expect_temperature(21.5);
	before = host.now;
	expect_temperature(21.5);
	TEST_ASSERT_LESS_THAN_INT64(50 * HOST_MS, host.now - before);
	before = (int64_t)chip->conversions;
	expect_temperature(21.5);
	TEST_ASSERT_EQUAL_INT64(before + 1, (int64_t)chip->conversions);
}

static void test_limits_are_read(void)
{
	begin("MAX31888", false);
	expect(true, of(chip, "temphigh"), "     163.835");
	expect(true, of(chip, "templow"), "     -163.84");
	TEST_ASSERT_EQUAL_INT(-EACCES, result(BUS_WRITE, of(chip, "temphigh"), "30.5"));
}

/* A result of before, which the FIFO still holds, is not taken for a new one. */
static void test_what_the_fifo_held_before_is_not_taken(void)
{
	begin("MAX31888", false);
	for (unsigned left = 0; left < 3; left++) {
		sim_slave_advance(chip, wire_time());
		for (unsigned i = 0; i < left; i++)
			chip->family->worked(chip);
		wire_set(chip, "temperature", 30 + left);
		expect_temperature(30 + left);
	}
}

static unsigned wrong, again;
static uint32_t slots;

static double count; /* where the count of results stands */

static void once(struct trouble what, bool parasite)
{
	const struct bus_answer *answer;

	begin("MAX31888", parasite);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(chip, "count", count));
	measure();
	wire_set(chip, "temperature", 60);
	host_run(&host, bus, host.now + HOST_S);
	forget();
	trouble_none(&trouble);
	trouble.kind = what.kind;
	trouble.at = what.at;
	trouble.mask = what.mask;
	trouble.restart_ns = what.restart_ns ? wire_time() + what.restart_ns : 0;
	answer = measure();
	wrong += !answer->err && (answer->number < 59.99 || answer->number > 60.01);
	again += !answer->err && trouble.slots > slots;
}

static void test_no_trouble_gives_a_false_value(void)
{
	for (unsigned i = 0; i < 3; i++) {
		bool parasite = i == 1;

		count = i == 2 ? 4 : 7;
		wrong = again = 0;
		slots = UINT32_MAX;
		once((struct trouble){.kind = TROUBLE_NONE}, parasite);
		slots = trouble.slots;
		tearDown();
		for (uint32_t at = 0; at < slots; at++) {
			once((struct trouble){.kind = TROUBLE_TURN, .at = at, .mask = 1}, parasite);
			tearDown();
			once((struct trouble){.kind = TROUBLE_DEAF, .at = at}, parasite);
			tearDown();
		}
		for (int64_t us = 500; us < 60000; us += 500) {
			once((struct trouble){.kind = TROUBLE_RESTART, .restart_ns = us * 1000},
			     parasite);
			tearDown();
		}
		TEST_ASSERT_EQUAL_UINT(0, wrong);
		TEST_ASSERT_GREATER_THAN_UINT(100, again);
	}
	begin("MAX31888", false);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_measures_with_200_steps_a_degree);
	RUN_TEST(test_the_count_of_results_may_stand_in_another_register);
	RUN_TEST(test_a_measurement_takes_little_more_than_the_chip);
	RUN_TEST(test_limits_are_read);
	RUN_TEST(test_what_the_fifo_held_before_is_not_taken);
	RUN_TEST(test_no_trouble_gives_a_false_value);
	return UNITY_END();
}
