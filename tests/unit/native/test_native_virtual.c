/* SPDX-License-Identifier: MIT */
/* Tests of the properties that the native bus itself has: settings, statistics, system. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void test_settings_and_system_have_their_names(void)
{
	wire_init(&host, 1, 1);
	start();
	expect(true, "/settings/units/temperature_scale", "C");
	expect(true, "/settings/units/pressure_scale", "mbar");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/units/temperature_scale", "F"));
	expect(true, "/settings/units/temperature_scale", "F");
	expect(true, "/settings/timeout/volatile", "           2");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, "/settings/units/pressure_scale", "x"));
	expect(true, "/settings/timeout/stable", "         300");
	expect(true, "/settings/timeout/presence", "           2");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/timeout/presence", "7"));
	expect(true, "/settings/timeout/presence", "           7");
	expect(true, "/settings/timeout/usb", "           5");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/timeout/usb", "8"));
	expect(true, "/settings/timeout/usb", "           8");
	expect(true, "/settings/timeout/w1", "          30");
	expect(true, "/system/configuration/i2c", "           1");
	expect(true, "/system/configuration/USB", "           0");
	expect(true, "/system/configuration/version", OWSD_VERSION);
	expect(true, "/system/connections/count_current_buses", "           1");
	expect(true, "/system/process/pidfile", "");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, "/system/process/pid", NULL));
	expect(true, "/bus.0/interface/settings/name", "Simulated-test wire");
	expect(true, "/bus.0/interface/settings/overdrive", "0");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, "/interface/settings/name", NULL));
}

static double number(const char *what)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, what, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, what);
	TEST_ASSERT_EQUAL_INT_MESSAGE(BUS_NUMBER, answer_to(id)->kind, what);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(12, answer_to(id)->len, what);
	return answer_to(id)->number;
}

static void test_every_virtual_property_that_is_listed_can_be_read(void)
{
	static const char *const roots[] = {"/settings",        "/statistics",
	                                    "/system",          "/simultaneous",
	                                    "/bus.0/interface", "/bus.0/simultaneous"};
	char todo[60][100];
	unsigned left = 0, properties = 0;

	wire_init(&host, 1, 1);
	wire_add(0, "DS18B20", 1);
	start();
	for (size_t i = 0; i < sizeof(roots) / sizeof(roots[0]); i++)
		snprintf(todo[left++], sizeof(todo[0]), "%s", roots[i]);
	while (left) {
		char at[100], *line, *rest;

		forget();
		snprintf(at, sizeof(at), "%s", todo[--left]);
		uint32_t id = ask(BUS_DIR, BUS_INPUT, true, at, NULL);
		if (answer_to(id)->err == -ENOTDIR) {
			properties++;
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_READ, at, NULL), at);
			continue;
		}
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, at);
		for (line = strtok_r((char *)data[id], "\n", &rest); line;
		     line = strtok_r(NULL, "\n", &rest)) {
			TEST_ASSERT_LESS_THAN(60, left);
			snprintf(todo[left++], sizeof(todo[0]), "%s", line);
		}
	}
	TEST_ASSERT_GREATER_THAN(50, properties);
}

static void test_statistics_count_what_was_asked(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	double calls = number("/statistics/read/calls");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "nonsense"), NULL));
	/* what is no property is not read */
	TEST_ASSERT_EQUAL_DOUBLE(calls + 2, number("/statistics/read/calls"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "templow"), "12"));
	TEST_ASSERT_EQUAL_DOUBLE(1, number("/statistics/write/calls"));
	expect(true, of(slave, "templow"), "          12");
	expect(false, of(slave, "templow"), "          12");
	TEST_ASSERT_EQUAL_DOUBLE(1, number("/statistics/read/cachesuccess"));
	TEST_ASSERT_EQUAL_DOUBLE(0, number("/statistics/errors/CRC8_errors"));
	TEST_ASSERT_TRUE(number("/statistics/errors/CRC8_tries") > 0);
	TEST_ASSERT_TRUE(number("/bus.0/interface/statistics/locks") > 0);
	TEST_ASSERT_TRUE(number("/bus.0/interface/statistics/resets") > 0);
}

static void test_the_cache_can_be_switched_off(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21);
	start();
	expect(false, of(slave, "temperature"), "          21");
	wire_set(slave, "temperature", 22);
	expect(false, of(slave, "temperature"), "          21");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/timeout/uncached", "1"));
	expect(false, of(slave, "temperature"), "          22");
}

static void test_aliases_are_listed_and_can_be_left_out(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, "/settings/alias/list", "");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "alias"), "boiler"));
	expect(true, "/settings/alias/list", "2801005DDF03007F=boiler\r\n");
	uint32_t id = ask(BUS_DIR, BUS_INPUT, false, "/bus.0", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING_LEN("/bus.0/boiler\n", (char *)data[id], 14);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/settings/alias/unaliased", "1"));
	id = ask(BUS_DIR, BUS_INPUT, false, "/bus.0", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING_LEN("/bus.0/28.01005DDF0300\n", (char *)data[id], 23);
}

static void test_one_device_alone_tells_its_id(void)
{
	wire_init(&host, 3, 3);
	wire_add(1, "DS18B20", 1);
	wire_add(2, "DS18B20", 2);
	wire_add(2, "DS2401", 3);
	start();
	expect(true, "/bus.0/simultaneous/present", "0");
	expect(true, "/bus.1/simultaneous/present", "1");
	expect(true, "/bus.2/simultaneous/present", "1");
	expect(true, "/bus.0/simultaneous/single", "");
	expect(true, "/bus.1/simultaneous/single", "28.01005DDF0300.7F");
	expect(true, "/bus.2/simultaneous/single", "");
	TEST_ASSERT_EQUAL_INT(-EACCES, result(BUS_WRITE, "/simultaneous/single", "1"));
}

static void test_voltages_are_new_after_all_were_told_to_convert(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *a = wire_add(0, "DS2450", 1), *b = wire_add(0, "DS2450", 2);

	wire_set(a, "volt.A", 1);
	wire_set(b, "volt.A", 2);
	start();
	expect(true, "/simultaneous/voltage", "0");
	TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01, 1, number(of(a, "latestvolt.A")),
	                                  "nothing was converted since it has power");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(a, "volt.A"), NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(b, "volt.A"), NULL));
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 1, number(of(a, "latestvolt.A")));
	wire_set(a, "volt.A", 3);
	wire_set(b, "volt.A", 4);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/voltage", "1"));
	expect(true, "/simultaneous/voltage", "1");
	expect(true, "/simultaneous/temperature", "0");
	TEST_ASSERT_DOUBLE_WITHIN(0.02, 3, number(of(a, "latestvolt.A")));
	TEST_ASSERT_DOUBLE_WITHIN(0.02, 4, number(of(b, "latestvolt.A")));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_settings_and_system_have_their_names);
	RUN_TEST(test_every_virtual_property_that_is_listed_can_be_read);
	RUN_TEST(test_statistics_count_what_was_asked);
	RUN_TEST(test_the_cache_can_be_switched_off);
	RUN_TEST(test_aliases_are_listed_and_can_be_left_out);
	RUN_TEST(test_one_device_alone_tells_its_id);
	RUN_TEST(test_voltages_are_new_after_all_were_told_to_convert);
	return UNITY_END();
}
