/* SPDX-License-Identifier: MIT */
/*
 * Convert T does not reach thermometers that are fed by the wire, which cannot show it: one command
 * is lost, or several in a row, at each place. No value is older than its stamp says. A chip that
 * never converts has no good value.
 */
#include <errno.h>
#include <stdio.h>

#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define CONVERT_T 0x44
#define PLACES 12
#define ROUND_NS (12 * HOST_S)

static struct trouble trouble;
static unsigned converts, from, to; /* Convert T so far; the first and the last that are lost */

void setUp(void)
{
	native_begin();
	fleet_begin();
}

void tearDown(void)
{
	native_end();
}

/* By Skip ROM or Match ROM. Nobody hears the rest of such a transaction. */
static void lose(const uint8_t *bytes, size_t n)
{
	bool convert = (n == 2 && bytes[0] == 0xcc && bytes[1] == CONVERT_T) ||
	               (n == 10 && bytes[9] == CONVERT_T);

	if (!convert)
		return;
	trouble.deaf = converts >= from && converts <= to;
	converts++;
}

static void set_out(const char *chip, unsigned count, double slope)
{
	fleet_again();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	wire_net.sends = lose;
	trouble_none(&trouble);
	fleet_slope = slope;
	fleet_add(chip, count);
	for (unsigned i = 0; i < count; i++)
		fleet.slave[i]->parasite = true;
	converts = 0;
	from = 1;
	to = 0;
	start();
}

struct result {
	unsigned wrong, halves, good;
};

static struct result lose_each(const char *chip, unsigned count, unsigned lost)
{
	struct result all = {0};
	char text[100];

	for (unsigned place = 0; place < PLACES; place++) {
		set_out(chip, count, 0.75);
		from = place;
		to = place + lost - 1;
		fleet_run(host.now + ROUND_NS);
		TEST_ASSERT_GREATER_THAN_UINT(to, converts);
		all.wrong += fleet.wrong;
		all.halves += fleet.halves;
		all.good += fleet.good;
	}
	snprintf(text, sizeof(text), "%u %s, %u lost: %u of %u too old", count, chip, lost,
	         all.wrong, all.good);
	TEST_MESSAGE(text);
	TEST_ASSERT_GREATER_THAN_UINT(PLACES * count * 2, all.good);
	return all;
}

/* Of a chip whose resolution can be changed: but a few of those that 9 bits can show, too. */
static void test_no_temperature_is_older_than_it_says_however_many_are_lost(void)
{
	for (unsigned count = 1; count <= 3; count += 2) {
		for (unsigned lost = 1; lost <= 4; lost++) {
			struct result all = lose_each("DS18B20", count, lost);

			TEST_ASSERT_EQUAL_UINT(all.halves, all.wrong);
			TEST_ASSERT_LESS_THAN_UINT(lost == 1 ? 1 : all.good / 20, all.wrong);
		}
	}
}

/* What its resolution cannot be made to differ in: one that is lost is found. */
static void test_of_a_fixed_resolution_one_lost_command_makes_no_false_value(void)
{
	TEST_ASSERT_EQUAL_UINT(0, lose_each("DS18S20", 1, 1).wrong);
	TEST_ASSERT_EQUAL_UINT(0, lose_each("DS18S20", 3, 1).wrong);
}

static const struct bus_answer *read_fresh(const char *property)
{
	return answer_to(ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[0], property), NULL));
}

/* It was read before, when it still did. */
static void test_a_chip_that_converts_no_more_has_no_good_value(void)
{
	static const char *const properties[] = {"temperature", "temperature11", "temperature10"};

	for (unsigned i = 0; i < sizeof(properties) / sizeof(properties[0]); i++) {
		set_out("DS18B20", 1, 0.75);
		fleet.stopped = true;
		wire_set(fleet.slave[0], "temperature", 21.75 + 1 / 16.0 * (i == 0));
		TEST_ASSERT_EQUAL_INT(0, read_fresh(properties[i])->err);
		from = converts;
		to = converts + 100000;
		for (unsigned n = 0; n < 4; n++) {
			const struct bus_answer *answer = read_fresh(properties[i]);

			TEST_ASSERT_NOT_EQUAL_INT_MESSAGE(0, answer->err, properties[i]);
		}
		from = to + 1;
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_fresh(properties[i])->err, properties[i]);
	}
}

/* ... nor one that has not converted since owsd began. */
static void test_a_chip_that_has_never_converted_has_no_good_value(void)
{
	set_out("DS18B20", 1, 0.75);
	fleet.stopped = true;
	wire_set(fleet.slave[0], "temperature", 21.8125);
	TEST_ASSERT_EQUAL_INT(0, read_fresh("temperature")->err);
	forget();
	host.events = 0;
	bus_destroy(bus);
	from = 0;
	to = 100000;
	converts = 0;
	start();
	TEST_ASSERT_NOT_EQUAL_INT(0, read_fresh("temperature")->err);
}

/*
 * ... also where the bridge is reset at any time between. Two that are lost are not found
 * where 9 bits cannot show it: then it has at most the time of the first.
 */
static void test_no_reset_of_the_bridge_makes_an_unproven_result_look_new(void)
{
	static const struct {
		const char *chip;
		double temperature;
		bool found;
	} rows[] = {{"DS18S20", 21.5, false}, {"DS18B20", 21.5, false}, {"DS18B20", 21.8125, true}};
	char text[60];

	for (unsigned i = 0; i < 3; i++) {
		for (int64_t ms = 0; ms < 4000; ms += 50) {
			set_out(rows[i].chip, 1, 0.75);
			fleet.stopped = true;
			wire_set(fleet.slave[0], "temperature", rows[i].temperature);
			TEST_ASSERT_EQUAL_INT(0, read_fresh("temperature")->err);
			forget();
			host.events = 0;
			bus_destroy(bus);
			from = 0;
			to = 100000;
			converts = 0;
			start();
			ask(BUS_READ, BUS_INPUT, ms % 100, of(fleet.slave[0], "temperature"), NULL);
			host_run(&host, bus, host.now + ms * HOST_MS);
			wire_net.fault = -EIO;
			wire_net.fault_count = 2;
			wire_net.fault_until = LINK_CHIP_RESET;
			bool before = host.answers > 0;
			host_run_answers(&host, bus, 1, host.now + 21 * HOST_S);
			TEST_ASSERT_EQUAL_UINT(1, host.answers);
			if (before)
				continue;
			snprintf(text, sizeof(text), "%s, a fault after %d ms", rows[i].chip,
			         (int)ms);
			if (rows[i].found || host.answer[0].err)
				TEST_ASSERT_NOT_EQUAL_INT_MESSAGE(0, host.answer[0].err, text);
			else
				TEST_ASSERT_LESS_THAN_INT64_MESSAGE(
					host.now - 700 * HOST_MS, host.answer[0].measured_ns, text);
		}
	}
}

/* A temperature that stays is new in each answer that insists, and has its full resolution. */
static void test_a_temperature_that_stays_is_proven_new(void)
{
	set_out("DS18B20", 1, 0.75);
	fleet.stopped = true;
	for (unsigned n = 0; n < 32; n++) {
		double is = 20 + n / 16.0;

		wire_set(fleet.slave[0], "temperature", is);
		for (unsigned again = 0; again < 2; again++) {
			int64_t asked = host.now;
			const struct bus_answer *answer = read_fresh("temperature");

			TEST_ASSERT_EQUAL_INT(0, answer->err);
			TEST_ASSERT_EQUAL_DOUBLE(is, answer->number);
			TEST_ASSERT_GREATER_THAN_INT64(asked, answer->measured_ns);
			TEST_ASSERT_LESS_THAN_INT64(asked + 3 * HOST_S, host.now);
		}
	}
}

/* What is read from the cache's life on is proven every five seconds. */
static void test_a_temperature_that_stays_does_not_become_old(void)
{
	set_out("DS18B20", 1, 0.75);
	fleet.stopped = true;
	wire_set(fleet.slave[0], "temperature", 21.8125);
	for (unsigned n = 0; n < 20; n++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, false, of(fleet.slave[0], "temperature"),
		                  NULL);
		const struct bus_answer *answer = answer_to(id);

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_GREATER_THAN_INT64(host.now - 8 * HOST_S, answer->measured_ns);
		host_run(&host, bus, host.now + HOST_S);
	}
}

/* The limits and the resolution that it keeps are as they were, also after a kill at any time. */
static void test_a_mark_that_is_left_in_a_chip_is_no_resolution(void)
{
	for (int64_t ms = 0; ms < 3000; ms += 50) {
		set_out("DS18B20", 1, 0.75);
		fleet.stopped = true;
		wire_set(fleet.slave[0], "temperature", 21.8125);
		ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[0], "temperature"), NULL);
		host_run(&host, bus, host.now + ms * HOST_MS);
		bus_destroy(bus);
		forget();
		host.events = 0;
		start();
		TEST_ASSERT_EQUAL_DOUBLE(21.8125, read_fresh("temperature")->number);
		TEST_ASSERT_EQUAL_DOUBLE(12, read_fresh("tempres")->number);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_temperature_is_older_than_it_says_however_many_are_lost);
	RUN_TEST(test_of_a_fixed_resolution_one_lost_command_makes_no_false_value);
	RUN_TEST(test_a_chip_that_converts_no_more_has_no_good_value);
	RUN_TEST(test_a_chip_that_has_never_converted_has_no_good_value);
	RUN_TEST(test_no_reset_of_the_bridge_makes_an_unproven_result_look_new);
	RUN_TEST(test_a_temperature_that_stays_is_proven_new);
	RUN_TEST(test_a_temperature_that_stays_does_not_become_old);
	RUN_TEST(test_a_mark_that_is_left_in_a_chip_is_no_resolution);
	return UNITY_END();
}
