/* SPDX-License-Identifier: MIT */
/*
 * A list of the properties of a chip whose family code does not decide what it is: the chip says so
 * first, and the list has its own. One that does not say it gets what all have that it may be.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/native/state.h"
#include "tests/unit/aid/native_scene.h"

static struct sim_slave *slave;

static void plug(const char *chip)
{
	native_begin();
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	start();
}

void setUp(void)
{
}

void tearDown(void)
{
	wire_net.sent = NULL;
	native_end();
}

/* What stands below the path, each name between line ends: "\ntype\n..." */
static const char *list(const char *path)
{
	static char names[4096];
	uint32_t id = ask(BUS_DIR, BUS_INPUT, false, path, NULL);
	const struct bus_answer *answer = answer_to(id);
	size_t used = 1, at = 0;

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, path);
	names[0] = '\n';
	while (at < answer->len) {
		const char *line = (const char *)data[id] + at;
		size_t n = (size_t)((const char *)memchr(line, '\n', answer->len - at) - line);

		TEST_ASSERT_EQUAL_STRING_LEN(path, line, strlen(path));
		used += (size_t)snprintf(names + used, sizeof(names) - used, "%.*s\n",
		                         (int)(n - strlen(path) - 1), line + strlen(path) + 1);
		at += n + 1;
	}
	return names;
}

static void has(const char *names, const char *name, bool yes)
{
	char line[48];

	snprintf(line, sizeof(line), "\n%s\n", name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(yes, strstr(names, line) != NULL, name);
}

static void test_the_first_list_of_a_chip_has_what_that_chip_has(void)
{
	static const struct {
		const char *chip, *own, *other;
	} rows[] = {
		{"TMP1826", "temphigh", "VDD"},
		{"DS2438", "VDD", "temphigh"},
		{"DS1825", "temperature9", "thermocouple"},
		{"MAX31850", "thermocouple", "temperature9"},
		{"MAX31826", "memory", "thermocouple"},
		{"HB_BAROMETER", "barometer", "moisture"},
		{"HB_HUB", "hub", "barometer"},
		{"BAE0911", "eeprom", "generic"},
		{"EDS0068", "EDS0068", "EDS0064"},
		{"IE_SWITCH_MASTER", "switch_ports", "rgbw_channels"},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const char *names;

		plug(rows[i].chip);
		names = list(name_of(slave));
		has(names, rows[i].own, true);
		has(names, rows[i].other, false);
		has(names, "type", true);
		tearDown();
	}
	plug("TMP1826");
}

static unsigned selected;

static void count_selections(const uint8_t *bytes, size_t n)
{
	selected += n > 9 && bytes[0] == 0x55 && memcmp(bytes + 1, slave->rom, 8) == 0;
}

/* Nothing goes over the wire for what is known, and for families of one chip. */
static void test_a_list_asks_once_and_only_where_it_matters(void)
{
	plug("TMP1826");
	selected = 0;
	wire_net.sent = count_selections;
	has(list(name_of(slave)), "temphigh", true);
	TEST_ASSERT_EQUAL_UINT(3, selected);
	has(list(name_of(slave)), "temphigh", true);
	TEST_ASSERT_EQUAL_UINT(3, selected);
	tearDown();
	plug("DS18B20");
	wire_net.sent = count_selections;
	has(list(name_of(slave)), "temperature", true);
	TEST_ASSERT_EQUAL_UINT(3, selected);
}

/* Home Assistant, FHEM and openHAB ask for it first, once, and keep it. */
static void test_a_type_is_that_of_the_chip_from_the_first_request_on(void)
{
	static const char *const chips[] = {"TMP1826",  "DS2438",   "DS1825",
	                                    "MAX31850", "MAX31826", "MAX31825"};

	for (unsigned i = 0; i < sizeof(chips) / sizeof(chips[0]); i++) {
		plug(chips[i]);
		selected = 0;
		wire_net.sent = count_selections;
		expect(false, of(slave, "type"), chips[i]);
		TEST_ASSERT_GREATER_THAN_UINT(0, selected);
		selected = 0;
		expect(false, of(slave, "type"), chips[i]);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, selected, chips[i]);
		tearDown();
	}
	plug("DS18B20");
	selected = 0;
	wire_net.sent = count_selections;
	expect(true, of(slave, "type"), "DS18B20");
	TEST_ASSERT_EQUAL_UINT(0, selected);
}

static void test_a_chip_that_does_not_say_what_it_is_has_no_type(void)
{
	static const char *const chips[] = {"DS2438", "MAX31850"};

	for (unsigned i = 0; i < sizeof(chips) / sizeof(chips[0]); i++) {
		plug(chips[i]);
		slave->corrupt_probability = 1;
		slave->corrupt_random = 3;
		TEST_ASSERT_EQUAL_INT(-EBADMSG, result(BUS_READ, of(slave, "type"), NULL));
		slave->corrupt_probability = 0;
		expect(false, of(slave, "type"), chips[i]);
		tearDown();
		plug(chips[i]);
		sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
		TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "type"), NULL));
		sim_wire_plug(&wire_net.wire[0], slave, true, wire_time());
		expect(false, of(slave, "type"), chips[i]);
		tearDown();
	}
	plug("DS2438");
}

static void test_a_directory_below_a_chip_is_there_if_that_chip_has_it(void)
{
	plug("DS2438");
	has(list(of(slave, "HIH4000")), "humidity", true);
	tearDown();
	plug("TMP1826");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_DIR, of(slave, "HIH4000"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_DIR, of(slave, "nothing"), NULL));
	has(list(name_of(slave)), "temphigh", true);
}

/* It is there, but each thing that it says is disturbed. */
static void test_a_chip_that_does_not_say_what_it_is_has_what_all_have(void)
{
	const char *names;

	plug("DS2438");
	slave->corrupt_probability = 1;
	slave->corrupt_random = 3;
	names = list(name_of(slave));
	has(names, "temperature", true);
	has(names, "type", true);
	has(names, "VDD", false);
	has(names, "temphigh", false);
	has(names, "HIH4000", false);
	slave->corrupt_probability = 0;
	has(list(name_of(slave)), "VDD", true);
}

static void test_a_chip_that_is_gone_has_no_list(void)
{
	plug("TMP1826");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_DIR, name_of(slave), NULL));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_list_of_a_chip_has_what_that_chip_has);
	RUN_TEST(test_a_list_asks_once_and_only_where_it_matters);
	RUN_TEST(test_a_type_is_that_of_the_chip_from_the_first_request_on);
	RUN_TEST(test_a_chip_that_does_not_say_what_it_is_has_no_type);
	RUN_TEST(test_a_directory_below_a_chip_is_there_if_that_chip_has_it);
	RUN_TEST(test_a_chip_that_does_not_say_what_it_is_has_what_all_have);
	RUN_TEST(test_a_chip_that_is_gone_has_no_list);
	return UNITY_END();
}
