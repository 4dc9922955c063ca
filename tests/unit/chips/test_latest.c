/* SPDX-License-Identifier: MIT */
/*
 * `latesttemp` of a thermometer converts nothing: its value is of the last conversion that the bus
 * has seen, and has its time. What the chip holds from before has no time that anybody knows: it is
 * refused. Chips that are measured as quickly are measured anew.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "hal/sim/branch.h"
#include "tests/unit/aid/native_scene.h"

static const struct {
	const char *chip, *input, *measured, *latest, *all;
	bool refused;  /* it cannot be measured as quickly */
	bool converts; /* ... or it always is */
} chips[] = {
	{"DS18B20", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS18S20", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS1822", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS28EA00", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS1825", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31825", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31826", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"MAX31850", "temperature", "temperature", "latesttemp", "/simultaneous/temperature", true},
	{"DS2437", "temperature", "temperature", "latesttemp", NULL, .converts = true},
	{"DS2438", "temperature", "temperature", "latesttemp", NULL, .converts = true},
	{"DS2438-A6", "temperature", "temperature", "latesttemp", NULL, .converts = true},
	{"DS2450", "volt.A", "volt.A", "latestvolt.A", NULL, .converts = true},
	{"DS2450", "volt.A", "volt2.A", "latestvolt2.A", NULL, .converts = true},
	{"DS2450", "volt.A", "8bit/volt.A", "8bit/latestvolt.A", NULL, .converts = true},
	{"DS2450", "volt.A", "8bit/volt2.A", "8bit/latestvolt2.A", NULL, .converts = true},
	{"IBLSS", "temperature", "TH/temperature", "TH/latesttemp", NULL, .converts = true},
	{"IBLSS", "humidity", "TH/humidity", "TH/latesthumidity", NULL, .converts = true},
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
		if (chips[i].converts)
			continue;
		begin(i);
		int64_t before = host.now;
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_fresh(chips[i].measured)->err, chips[i].chip);
		int64_t after = host.now;
		wire_set(chip, chips[i].input, 1.5);
		rest();
		const struct bus_answer *answer = read_fresh(chips[i].latest);

		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, chips[i].chip);
		TEST_ASSERT_DOUBLE_WITHIN(0.03, 2.5, answer->number);
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
		wire_set(chip, chips[i].input, 1.5);
		int64_t before = host.now;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, chips[i].all, "1"));
		rest();
		const struct bus_answer *answer = read_fresh(chips[i].latest);

		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, chips[i].chip);
		TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.5, answer->number);
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
		wire_set(chip, chips[i].input, 1.5);
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
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03, 1.5, answer->number, chips[i].chip);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(asked, answer->measured_ns);
	}
}

/* What happens to the chip before the client asks. */
enum past { FRESH, RETURNED, BROWN_OUT, NOTICED, PASTS };
static const char *const past_names[] = {"fresh", "returned", "brown-out", "noticed brown-out"};

static void befall(enum past past, const char *property)
{
	if (past == FRESH)
		return;
	TEST_ASSERT_EQUAL_INT(0, read_fresh(property)->err);
	if (past == RETURNED) {
		chip->plugged = false;
		TEST_ASSERT_EQUAL_INT(-ENODEV, read_fresh(property)->err);
		sim_slave_power_on(chip, wire_time());
		chip->plugged = true;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(chip), NULL));
	} else {
		sim_slave_brownout(chip, wire_time());
	}
	if (past == NOTICED)
		read_fresh("scratchpad");
}

/* As clients have done for years: all convert, a second later each is read. */
static void ask_as_clients_do(unsigned i, enum past past, bool behind, bool parasite)
{
	char what[160];

	snprintf(what, sizeof(what), "%s %s, %s%s%s", chips[i].chip, chips[i].latest,
	         past_names[past], behind ? ", behind a coupler" : "",
	         parasite ? ", parasitic" : "");
	native_end();
	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, chips[i].chip, 1);
	chip->parasite = parasite;
	if (behind)
		sim_branch_put(chip, wire_add(0, "DS2409", 2), SIM_MAIN);
	wire_set(chip, chips[i].input, 2);
	start();
	host_run(&host, bus, host.now + 3 * HOST_S);
	befall(past, chips[i].measured);
	host_run(&host, bus, host.now + 3 * HOST_S);
	wire_set(chip, chips[i].input, 2.5);
	int64_t asked = host.now;

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_WRITE, "/simultaneous/temperature", "1"), what);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_WRITE, "/simultaneous/voltage", "1"), what);
	host_run(&host, bus, host.now + HOST_S);
	const struct bus_answer *answer = read_fresh(chips[i].latest);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, what);
	TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03, 2.5, answer->number, what);
	/* Under the strong pull-up it may count as of the conversion before. */
	if (!parasite)
		TEST_ASSERT_GREATER_OR_EQUAL_INT64_MESSAGE(asked, answer->measured_ns, what);
}

/* The MAX31825 has no command for that: fed by the wire it is not supported. */
static bool tells_supply(unsigned i)
{
	return strcmp(chips[i].chip, "MAX31825") != 0;
}

static void test_the_first_after_a_conversion_of_all_is_right(void)
{
	for (unsigned i = 0; i < CHIPS; i++)
		for (enum past past = FRESH; past < PASTS; past++)
			for (unsigned place = 0; place < (tells_supply(i) ? 4 : 2); place++)
				ask_as_clients_do(i, past, place & 1, place & 2);
}

static bool is_in_table(const struct property *property, uint8_t code)
{
	size_t n = strlen(property->name);

	for (unsigned i = 0; i < CHIPS; i++)
		if (sim_family_find(chips[i].chip, 0)->code == code &&
		    strncmp(chips[i].latest, property->name, n) == 0 &&
		    (!chips[i].latest[n] || chips[i].latest[n] == '.'))
			return true;
	return false;
}

static void test_the_table_has_all_of_all_families(void)
{
	unsigned found = 0;

	for (unsigned code = 0; code < 256; code++) {
		const struct family *family = family_of((uint8_t)code);

		for (unsigned i = 0; family && i < family->count; i++) {
			if (!strstr(family->properties[i].name, "latest"))
				continue;
			char what[64];

			found++;
			snprintf(what, sizeof(what), "%02X %s", code, family->properties[i].name);
			TEST_ASSERT_TRUE_MESSAGE(is_in_table(&family->properties[i], (uint8_t)code),
			                         what);
		}
	}
	TEST_ASSERT_GREATER_THAN_UINT(10, found);
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
	RUN_TEST(test_the_first_after_a_conversion_of_all_is_right);
	RUN_TEST(test_the_table_has_all_of_all_families);
	RUN_TEST(test_volts_of_another_range_are_not_taken_for_those_of_this_one);
	return UNITY_END();
}
