/* SPDX-License-Identifier: MIT */
/* The sensors of Embedded Data Systems: each kind has its own properties, alarms, relay and LED. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/one_slave.h"

void setUp(void)
{
	one_slave_begin();
}

void tearDown(void)
{
	one_slave_end();
}

static void start(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	wire_add(0, "DS18B20", 2);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static void set(const char *input, double value)
{
	wire_set(slave, input, value);
	host_run(&host, bus, host.now + HOST_S);
}

/* A number, whatever blanks stand before it. */
static void number(const char *property, double value)
{
	const struct bus_answer *answer = go(BUS_READ, property, NULL);
	double read;

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	slave_data[answer->len] = '\0';
	TEST_ASSERT_EQUAL_INT_MESSAGE(1, sscanf((char *)slave_data, "%lf", &read), property);
	TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.001, value, read, property);
}

static bool lists(const char *name)
{
	char path[64];

	snprintf(path, sizeof(path), "%s", slave_path(""));
	path[strlen(path) - 1] = '\0';
	const struct bus_answer *answer = exchange(BUS_DIR, BUS_OUTPUT, path, NULL);

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	slave_data[answer->len] = '\0';
	return strstr((char *)slave_data, name) != NULL;
}

static void test_each_kind_says_what_it_is_and_has_its_own_properties_only(void)
{
	static const char *const kinds[] = {"EDS0064", "EDS0065", "EDS0066", "EDS0067", "EDS0068",
	                                    "EDS0070", "EDS0071", "EDS0072", "EDS0080", "EDS0082",
	                                    "EDS0083", "EDS0085", "EDS0090"};
	char name[60];

	for (unsigned i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		const char *other = kinds[(i + 1) % 13];

		if (i)
			setUp();
		start(kinds[i]);
		snprintf(name, sizeof(name), "%s/counter/seconds", other);
		refuses(-ENOENT, BUS_READ, name, NULL);
		reads("device_type", kinds[i]);
		reads("type", "EDS");
		snprintf(name, sizeof(name), "%s/counter/seconds", kinds[i]);
		refuses(0, BUS_READ, name, NULL);
		TEST_ASSERT_TRUE_MESSAGE(lists(kinds[i]), kinds[i]);
		TEST_ASSERT_FALSE_MESSAGE(lists(other), other);
		tearDown();
	}
	setUp();
}

static void test_the_tag_ends_where_its_text_ends(void)
{
	start("EDS0068");
	reads("tag", "OW-ENV-THPL");
	number("device_id", 0x68);
}

static void test_an_eds0068_measures_all_that_stands_in_its_table(void)
{
	start("EDS0068");
	set("temperature", -12.5);
	set("humidity", 41.5);
	set("pressure", 987.25);
	set("light", 70000);
	number("EDS0068/temperature", -12.5);
	number("EDS0068/humidity", 41.5);
	number("EDS0068/pressure", 987.25);
	number("EDS0068/inHg", 29.1533);
	number("EDS0068/light", 70000);
	number("EDS0068/dew_point", -22.9375);
	refuses(-EACCES, BUS_WRITE, "EDS0068/light", "1");
}

/* OWFS writes two bytes of a light's limit, and reads temp_hi from the register of an EDS0071. */
static void test_limits_keep_what_is_written_and_leave_their_neighbours(void)
{
	start("EDS0068");
	writes("EDS0068/threshold/light_hi", "80000");
	writes("EDS0068/threshold/light_low", "70000");
	writes("EDS0068/threshold/temp_hi", "30");
	writes("EDS0068/threshold/temp_low", "-20");
	writes("EDS0068/threshold/pressure_low", "900.5");
	number("EDS0068/threshold/light_hi", 80000);
	number("EDS0068/threshold/light_low", 70000);
	number("EDS0068/threshold/temp_hi", 30);
	number("EDS0068/threshold/temp_low", -20);
	number("EDS0068/threshold/pressure_low", 900.5);
	number("EDS0068/threshold/humidity_hi", 0);
	refuses(-EINVAL, BUS_WRITE, "EDS0068/threshold/temp_hi", "128");
	refuses(-EINVAL, BUS_WRITE, "EDS0068/threshold/light_hi", "16777216");
}

static void test_an_alarm_is_seen_in_the_search_and_stays_until_it_is_cleared(void)
{
	start("EDS0065");
	writes("EDS0065/threshold/temp_hi", "30");
	writes("EDS0065/threshold/temp_low", "-20");
	writes("EDS0065/set_alarm/temp_hi", "1");
	reads("EDS0065/alarm/temp_hi", "0");
	set("temperature", 31);
	reads("EDS0065/alarm/temp_hi", "1");
	reads("EDS0065/alarm/temp_low", "0");
	set("temperature", 25);
	reads("EDS0065/alarm/temp_hi", "1");
	TEST_ASSERT_EQUAL_INT(0, exchange(BUS_DIR, BUS_ALARM, "/alarm", NULL)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)slave_data, "/7E."));
	writes("EDS0065/alarm/clear", "1");
	reads("EDS0065/alarm/temp_hi", "0");
	number("EDS0065/set_alarm/alarm_function", 1);
}

static void test_relay_and_led_are_switched_when_no_alarm_controls_them(void)
{
	start("EDS0064");
	refuses(-EOPNOTSUPP, BUS_WRITE, "EDS0064/relay/state", "1");
	writes("EDS0064/relay/control", "2");
	writes("EDS0064/relay/state", "1");
	reads("EDS0064/relay/state", "1");
	refuses(-EOPNOTSUPP, BUS_WRITE, "EDS0064/LED/state", "1");
	writes("EDS0064/LED/control", "2");
	writes("EDS0064/LED/state", "1");
	number("EDS0064/relay_state", 3);
	number("EDS0064/relay_function", 10);
	writes("EDS0064/relay/state", "0");
	number("EDS0064/relay_state", 2);
	refuses(-EINVAL, BUS_WRITE, "EDS0064/relay/control", "4");
}

static void test_a_restart_is_noticed_by_the_seconds(void)
{
	start("EDS0064");
	host_run(&host, bus, host.now + 20 * HOST_S);
	refuses(0, BUS_READ, "EDS0064/counter/seconds", NULL);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
	sim_slave_brownout(slave, wire_time());
	refuses(0, BUS_READ, "EDS0064/temperature", NULL);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
}

static void test_an_eds0070_measures_vibration(void)
{
	start("EDS0070");
	set("vibration", 700);
	set("vibration", 300);
	number("EDS0070/vib_level", 300);
	number("EDS0070/vib_max", 700);
	writes("EDS0070/threshold/vib_hi", "600");
	writes("EDS0070/threshold/vib_low", "10");
	number("EDS0070/threshold/vib_hi", 600);
	number("EDS0070/threshold/vib_low", 10);
}

static void test_an_eds0071_has_a_fine_temperature_and_a_resistance(void)
{
	start("EDS0071");
	set("temperature", 100);
	number("EDS0071/temperature", 100);
	number("EDS0071/resistance", 138.5055);
	writes("EDS0071/threshold/resistance_hi", "120.5");
	writes("EDS0071/threshold/resistance_low", "80");
	writes("EDS0071/set_alarm/resistance_hi", "1");
	number("EDS0071/threshold/resistance_hi", 120.5);
	host_run(&host, bus, host.now + HOST_S);
	reads("EDS0071/alarm/resistance_hi", "1");
	writes("EDS0071/user_byte", "77");
	number("EDS0071/user_byte", 77);
	writes("EDS0071/delay", "3");
	number("EDS0071/delay", 3);
}

static void test_channels_have_limits_and_alarms_of_their_own(void)
{
	start("EDS0082");
	set("volt.5", 7.25);
	number("EDS0082/volts.5", 7.25);
	number("EDS0082/volts.4", 0);
	for (unsigned i = 0; i < 8; i++) {
		char name[40];

		snprintf(name, sizeof(name), "EDS0082/threshold/volts_hi.%u", i);
		writes(name, "5");
	}
	writes("EDS0082/set_alarm/volts_hi.BYTE", "224");
	number("EDS0082/set_alarm/volts_hi.BYTE", 224);
	number("EDS0082/set_alarm/volts_low.BYTE", 0);
	number("EDS0082/alarm/volts_hi.BYTE", 32);
	writes("EDS0082/set_alarm/volts_low.1", "1");
	number("EDS0082/set_alarm/volts_hi.BYTE", 224);
	number("EDS0082/set_alarm/volts_low.BYTE", 2);
	writes("EDS0082/set_alarm/volts_hi.6", "0");
	number("EDS0082/set_alarm/volts_hi.BYTE", 160);
	set("volt.5", 1.5);
	number("EDS0082/max_volts.5", 7.25);
	writes("EDS0082/alarm/clear", "1");
	number("EDS0082/max_volts.5", 1.5);
	number("EDS0082/alarm/volts_hi.BYTE", 0);
}

static void test_currents_are_in_amperes(void)
{
	start("EDS0083");
	set("current.3", 12.5);
	number("EDS0083/current.3", 0.0125);
	writes("EDS0083/threshold/current_low.3", "0.004");
	number("EDS0083/threshold/current_low.3", 0.004);
	refuses(-ENOENT, BUS_READ, "EDS0083/current.4", NULL);
}

static void test_an_eds0090_switches_counts_and_latches(void)
{
	start("EDS0090");
	number("EDS0090/input.BYTE", 255);
	set("pin.1", 0);
	set("pin.1", 1);
	set("pin.1", 0);
	number("EDS0090/counter/pulses.1", 2);
	number("EDS0090/latch/state.BYTE", 2);
	number("EDS0090/input.BYTE", 253);
	writes("EDS0090/latch/reset.1", "1");
	number("EDS0090/latch/state.BYTE", 0);
	number("EDS0090/counter/pulses.1", 2);
	writes("EDS0090/counter/reset.1", "1");
	number("EDS0090/counter/pulses.1", 0);
	writes("EDS0090/output/set.BYTE", "17");
	number("EDS0090/output/set.BYTE", 17);
	host_run(&host, bus, host.now + HOST_S);
	number("EDS0090/input.BYTE", 236);
	writes("EDS0090/relay/control", "2");
	writes("EDS0090/relay/state", "1");
	reads("EDS0090/relay/state", "1");
	number("EDS0090/output/set.BYTE", 17);
}

static void test_memory_is_read_whole_and_written_where_settings_are(void)
{
	start("EDS0064");
	TEST_ASSERT_EQUAL_UINT(96, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_INT(0, put_at(0x42, "memory", "+")->err);
	number("EDS0064/threshold/temp_hi", '+');
	TEST_ASSERT_EQUAL_INT(0, put_at(3, "pages/page.2", "!")->err);
	number("EDS0064/threshold/temp_low", '!');
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, put_at(0, "memory", "tag")->err);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, put_at(0, "pages/page.1", "x")->err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_kind_says_what_it_is_and_has_its_own_properties_only);
	RUN_TEST(test_the_tag_ends_where_its_text_ends);
	RUN_TEST(test_an_eds0068_measures_all_that_stands_in_its_table);
	RUN_TEST(test_limits_keep_what_is_written_and_leave_their_neighbours);
	RUN_TEST(test_an_alarm_is_seen_in_the_search_and_stays_until_it_is_cleared);
	RUN_TEST(test_relay_and_led_are_switched_when_no_alarm_controls_them);
	RUN_TEST(test_a_restart_is_noticed_by_the_seconds);
	RUN_TEST(test_an_eds0070_measures_vibration);
	RUN_TEST(test_an_eds0071_has_a_fine_temperature_and_a_resistance);
	RUN_TEST(test_channels_have_limits_and_alarms_of_their_own);
	RUN_TEST(test_currents_are_in_amperes);
	RUN_TEST(test_an_eds0090_switches_counts_and_latches);
	RUN_TEST(test_memory_is_read_whole_and_written_where_settings_are);
	return UNITY_END();
}
