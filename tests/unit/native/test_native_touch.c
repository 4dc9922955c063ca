/* SPDX-License-Identifier: MIT */
/* With the option Touch a key that is put on a wire is noticed within 100 ms. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static struct sim_slave *key, *other, *sensors[8];

void setUp(void)
{
	native_begin();
	wire_init(&host, 2, 2);
	key = wire_add(0, "DS2401", 1);
	other = wire_add(1, "DS2401", 2);
	for (unsigned i = 0; i < 8; i++)
		sensors[i] = wire_add(0, "DS18B20", 3 + i);
	key->plugged = other->plugged = false;
}

void tearDown(void)
{
	native_end();
}

static void begin(const char *option)
{
	char why[80] = "";

	start();
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "Touch", option, why, sizeof(why)));
	host_run(&host, bus, host.now + 3 * HOST_S);
	host.events = 0;
}

static void put(struct sim_slave *slave, unsigned channel, bool on)
{
	sim_wire_plug(&wire_net.wire[channel], slave, on, host.now);
}

/* How long until the key is found or lost; the bus meanwhile reads what was asked. */
static int64_t until(enum bus_news news)
{
	int64_t begun = host.now, end = begun + 2 * HOST_S;

	host.events = 0;
	while (!host_events(&host, news) && host.now < end)
		host_run(&host, bus, host.now + HOST_MS);
	return host.now - begun;
}

static void ask_all(void)
{
	forget();
	for (unsigned i = 0; i < 8; i++)
		ask(BUS_READ, BUS_INPUT, true, of(sensors[i], "temperature"), NULL);
}

static void test_a_key_that_touches_is_found_within_100_ms(void)
{
	int64_t longest = 0;

	begin("on");
	for (unsigned round = 0; round < 50; round++) {
		ask_all();
		host_run(&host, bus, host.now + (17 * round % 83) * HOST_MS);
		put(key, 0, true);
		int64_t took = until(BUS_FOUND);
		longest = took > longest ? took : longest;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(key), NULL));
		put(key, 0, false);
		TEST_ASSERT_LESS_THAN_INT64(250 * HOST_MS, until(BUS_LOST));
		host_run(&host, bus, host.now + HOST_S);
	}
	TEST_ASSERT_LESS_THAN_INT64(100 * HOST_MS, longest);
}

static void test_a_touch_is_in_the_log_with_key_alias_and_wire(void)
{
	begin("on");
	put(other, 1, true);
	until(BUS_NOTE);
	TEST_ASSERT_EQUAL_STRING("key 01.02005DDF0300 touches bus.1", host.event[1].text);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "alias"), "Ann"));
	put(other, 1, false);
	until(BUS_LOST);
	put(other, 1, true);
	until(BUS_NOTE);
	TEST_ASSERT_EQUAL_STRING("key 01.02005DDF0300 (Ann) touches bus.1", host.event[1].text);
}

static void test_a_key_that_stays_is_reported_once(void)
{
	begin("on");
	put(key, 0, true);
	until(BUS_NOTE);
	host.events = 0;
	ask_all();
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host.events);
}

static void test_without_the_option_nobody_hurries(void)
{
	begin("off");
	uint64_t before = wire_net.wire[1].resets;
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_LESS_THAN_UINT64(10, wire_net.wire[1].resets - before);
}

static void test_the_option_is_on_or_off(void)
{
	char why[80] = "";

	start();
	TEST_ASSERT_EQUAL_INT(-EINVAL, bus_option(bus, "Touch", "often", why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("expected on or off", why);
}

/* A DS2482 on an I2C bus with 100 kHz, three thermometers that are read all the time, and a key. */
static const char plant[] = "i2c speed 100\n"
			    "chip DS2482-100 0x18\n"
			    "DS18B20 28.0000000000B1\n"
			    "DS18B20 28.0000000000B2\n"
			    "DS18B20 28.0000000000B3\n"
			    "DS2401 01.000000000003 as key unplugged\n"
			    "at 10s every 1013ms plug key\n"
			    "at 10500ms every 1013ms unplug key\n";

static void test_over_a_ds2482_a_touch_is_a_value_within_100_ms(void)
{
	char file[] = "/tmp/owsd-touch-XXXXXX", target[60], why[80] = "";
	int fd = mkstemp(file);
	int64_t longest = 0;

	TEST_ASSERT_EQUAL_INT(sizeof(plant) - 1, write(fd, plant, sizeof(plant) - 1));
	close(fd);
	snprintf(target, sizeof(target), "sim:%s", file);
	int64_t zero = host.now;
	bus = host_bus(&host, target);
	unlink(file);
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "Touch", "on", why, sizeof(why)));
	host_run(&host, bus, zero + 9900 * HOST_MS);
	for (int round = 0; round < 40; round++) {
		int64_t touch = zero + (10000 + 1013 * round) * HOST_MS;
		const char *const paths[] = {"/28.0000000000B1/temperature",
		                             "/28.0000000000B2/temperature",
		                             "/28.0000000000B3/temperature"};

		host_run(&host, bus, touch - 50 * HOST_MS);
		forget();
		for (int i = 0; i < 3; i++)
			ask(BUS_READ, BUS_INPUT, true, paths[i], NULL);
		host.events = 0;
		host_run(&host, bus, touch);
		while (!host_events(&host, BUS_FOUND) && host.now < touch + HOST_S)
			host_run(&host, bus, host.now + HOST_MS);
		expect(true, "/01.000000000003/present", "1");
		int64_t took = host.now - touch;
		longest = took > longest ? took : longest;
	}
	TEST_ASSERT_LESS_THAN_INT64(100 * HOST_MS, longest);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_key_that_touches_is_found_within_100_ms);
	RUN_TEST(test_over_a_ds2482_a_touch_is_a_value_within_100_ms);
	RUN_TEST(test_a_touch_is_in_the_log_with_key_alias_and_wire);
	RUN_TEST(test_a_key_that_stays_is_reported_once);
	RUN_TEST(test_without_the_option_nobody_hurries);
	RUN_TEST(test_the_option_is_on_or_off);
	return UNITY_END();
}
