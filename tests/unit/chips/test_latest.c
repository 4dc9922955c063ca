/* SPDX-License-Identifier: MIT */
/*
 * `latesttemp` and its kin convert nothing: their value is of the last conversion that the bus has
 * seen, and has its time. What the chip holds from before has no time that anybody knows: it is
 * refused, or measured anew.
 */
#include <errno.h>
#include <stdio.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static const struct {
	const char *chip, *input, *measured, *latest, *all;
	bool refused; /* it cannot be measured as quickly */
} chips[] = {
	{"DS18B20", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS18S20", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS1822", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS28EA00", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS1825", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31825", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31826", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31850", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS2438", "temperature", "temperature", "latesttemp", NULL, false},
	{"DS2450", "volt.A", "volt.A", "latestvolt.A", "/simultaneous/voltage", false},
	{"IBLSS", "temperature", "TH/temperature", "TH/latesttemp", NULL, true},
	{"IBLSS", "humidity", "TH/humidity", "TH/latesthumidity", NULL, true},
};
#define CHIPS (sizeof(chips) / sizeof(chips[0]))

static struct sim_slave *chip;

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void begin(unsigned i)
{
	native_end();
	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, chips[i].chip, 1);
	wire_set(chip, chips[i].input, 2.5);
	start();
}

static const struct bus_answer *read_fresh(const char *property)
{
	return answer_to(ask(BUS_READ, BUS_INPUT, true, of(chip, property), NULL));
}

static void rest(void)
{
	host_run(&host, bus, host.now + 20 * HOST_S);
	host.events = 0;
}

static void test_it_has_the_time_of_the_conversion(void)
{
	for (unsigned i = 0; i < CHIPS; i++) {
		begin(i);
		int64_t before = host.now;
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_fresh(chips[i].measured)->err, chips[i].chip);
		int64_t after = host.now;
		wire_set(chip, chips[i].input, 3.5);
		rest();
		const struct bus_answer *answer = read_fresh(chips[i].latest);

		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, chips[i].chip);
		TEST_ASSERT_DOUBLE_WITHIN(0.01, 2.5, answer->number);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(before, answer->measured_ns);
		TEST_ASSERT_LESS_OR_EQUAL_INT64(after, answer->measured_ns);
	}
}

static void test_it_has_the_time_of_the_conversion_of_all(void)
{
	for (unsigned i = 0; i < CHIPS; i++) {
		if (!chips[i].all)
			continue;
		begin(i);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_fresh(chips[i].measured)->err, chips[i].chip);
		rest();
		wire_set(chip, chips[i].input, 3.5);
		int64_t before = host.now;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, chips[i].all, "1"));
		rest();
		const struct bus_answer *answer = read_fresh(chips[i].latest);

		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, chips[i].chip);
		TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.5, answer->number);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(before, answer->measured_ns);
		TEST_ASSERT_LESS_THAN_INT64(before + 2 * HOST_S, answer->measured_ns);
	}
}

/* Another program has made it convert, or the owsd before this one. */
static void test_what_it_holds_from_before_is_never_new(void)
{
	for (unsigned i = 0; i < CHIPS; i++) {
		begin(i);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_fresh(chips[i].measured)->err, chips[i].chip);
		rest();
		wire_set(chip, chips[i].input, 3.5);
		bus_destroy(bus);
		forget();
		host.events = 0;
		start();
		int64_t asked = host.now;
		const struct bus_answer *answer = read_fresh(chips[i].latest);

		if (chips[i].refused) {
			TEST_ASSERT_EQUAL_INT_MESSAGE(-EIO, answer->err, chips[i].chip);
			TEST_ASSERT_EQUAL_INT(0, read_fresh(chips[i].measured)->err);
			answer = read_fresh(chips[i].latest);
		}
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, chips[i].chip);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, 3.5, answer->number, chips[i].chip);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(asked, answer->measured_ns);
	}
}

static void test_volts_of_another_range_are_not_taken_for_those_of_this_one(void)
{
	static const char *const properties[] = {"volt.A", "latestvolt2.A", "latestvolt.A",
	                                         "8bit/latestvolt2.A", "8bit/latestvolt.A"};

	wire_init(&host, 1, 1);
	chip = wire_add(0, "DS2450", 1);
	wire_set(chip, "volt.A", 2.0);
	start();
	for (unsigned i = 0; i < sizeof(properties) / sizeof(properties[0]); i++) {
		TEST_ASSERT_EQUAL_INT(0, read_fresh(properties[i])->err);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03, 2.0, read_fresh(properties[i])->number,
		                                  properties[i]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_has_the_time_of_the_conversion);
	RUN_TEST(test_it_has_the_time_of_the_conversion_of_all);
	RUN_TEST(test_what_it_holds_from_before_is_never_new);
	RUN_TEST(test_volts_of_another_range_are_not_taken_for_those_of_this_one);
	return UNITY_END();
}
