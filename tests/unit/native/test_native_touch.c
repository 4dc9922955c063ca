/* SPDX-License-Identifier: MIT */
/* With the option Touch a key that is put on a wire, or on a branch of it, is noticed soon. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/branch.h"
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
	int64_t begun = host.now, end = begun + 4 * HOST_S;

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
			    "at 10s every 3039ms plug key\n"
			    "at 10500ms every 3039ms unplug key\n";

static const char branch_plant[] = "i2c speed 100\n"
				   "chip DS2482-100 0x18\n"
				   "DS18B20 28.0000000000B1\n"
				   "DS2409 1F.000000000001 as coupler\n"
				   "branch coupler main\n"
				   "DS18B20 28.0000000000B2\n"
				   "branch coupler aux\n"
				   "DS18B20 28.0000000000B3\n"
				   "DS2401 01.000000000003 as key unplugged\n"
				   "at 10s every 3039ms plug key\n"
				   "at 11500ms every 3039ms unplug key\n";

/* How long until the key is a value, at most. */
static int64_t longest_over_a_ds2482(const char *scenario)
{
	char file[] = "/tmp/owsd-touch-XXXXXX", target[60], why[80] = "";
	int fd = mkstemp(file);
	int64_t longest = 0;

	TEST_ASSERT_EQUAL_INT(strlen(scenario), write(fd, scenario, strlen(scenario)));
	close(fd);
	snprintf(target, sizeof(target), "sim:%s", file);
	int64_t zero = host.now;
	bus = host_bus(&host, target);
	unlink(file);
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "Touch", "on", why, sizeof(why)));
	host_run(&host, bus, zero + 9900 * HOST_MS);
	for (int round = 0; round < 40; round++) {
		int64_t touch = zero + (10000 + 3039 * round) * HOST_MS;
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
	return longest;
}

static void test_over_a_ds2482_a_touch_is_a_value_within_100_ms(void)
{
	TEST_ASSERT_LESS_THAN_INT64(100 * HOST_MS, longest_over_a_ds2482(plant));
}

static void test_over_a_ds2482_a_touch_on_a_branch_is_a_value_within_400_ms(void)
{
	TEST_ASSERT_LESS_THAN_INT64(400 * HOST_MS, longest_over_a_ds2482(branch_plant));
}

/* --- Behind a coupler: keys on both branches, and behind a coupler on its main branch -------- */

static struct sim_slave *coupler, *inner, *on_main, *on_aux, *deep;

static void add_branches(void)
{
	coupler = wire_add(0, "DS2409", 20);
	inner = wire_add(0, "DS2409", 21);
	on_main = wire_add(0, "DS2401", 22);
	on_aux = wire_add(0, "DS2401", 23);
	deep = wire_add(0, "DS2401", 24);
	sim_branch_put(inner, coupler, SIM_MAIN);
	sim_branch_put(on_main, coupler, SIM_MAIN);
	sim_branch_put(on_aux, coupler, SIM_AUX);
	sim_branch_put(deep, inner, SIM_AUX);
	on_main->plugged = on_aux->plugged = deep->plugged = false;
}

/*
 * The longest time until a key is found, and lost, in many rounds; the bus is busy meanwhile. Some
 * of the keys may come just while their branch is searched: then they wait for its next turn.
 */
static void found_and_lost(struct sim_slave *slave, int64_t found_ns, unsigned late_most,
                           int64_t late_ns)
{
	int64_t longest = 0, gone = 0;
	unsigned late = 0;

	for (unsigned round = 0; round < 30; round++) {
		ask_all();
		host_run(&host, bus, host.now + (17 * round % 83) * HOST_MS);
		put(slave, 0, true);
		int64_t took = until(BUS_FOUND);
		longest = took > longest ? took : longest;
		late += took > found_ns;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(slave), NULL));
		put(slave, 0, false);
		took = until(BUS_LOST);
		gone = took > gone ? took : gone;
		host_run(&host, bus, host.now + HOST_S);
	}
	TEST_ASSERT_LESS_THAN_INT64(late_ns, longest);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(late_most, late);
	TEST_ASSERT_LESS_THAN_INT64(HOST_S, gone);
}

static void test_a_key_on_a_branch_is_found_within_300_ms(void)
{
	add_branches();
	begin("on");
	found_and_lost(on_main, 300 * HOST_MS, 5, 1500 * HOST_MS);
	found_and_lost(on_aux, 300 * HOST_MS, 5, 1500 * HOST_MS);
	/* A key on the wire itself waits for a visit of a branch at the most. */
	found_and_lost(key, 200 * HOST_MS, 0, 200 * HOST_MS);
}

static void test_a_touch_on_a_branch_names_the_branch(void)
{
	add_branches();
	begin("on");
	put(on_aux, 0, true);
	until(BUS_NOTE);
	TEST_ASSERT_EQUAL_STRING("key 01.17005DDF0300 touches 1F.14005DDF0300/aux",
	                         host.event[1].text);
}

static const char *text_of_touch(void)
{
	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == BUS_NOTE && strstr(host.event[i].text, " touches "))
			return host.event[i].text;
	return "";
}

/* The key touches a branch: on the main branch of so many couplers, each on that of another. */
static const char *touched_behind(unsigned couplers, const char *alias)
{
	struct sim_slave *before = NULL, *inner_key;

	native_end();
	setUp();
	for (unsigned i = 0; i < couplers; i++) {
		struct sim_slave *next = wire_add(0, "DS2409", 30 + i);

		if (before)
			sim_branch_put(next, before, SIM_MAIN);
		before = next;
	}
	inner_key = wire_add(0, "DS2401", 60);
	sim_branch_put(inner_key, before, SIM_MAIN);
	begin("on");
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(inner_key, "alias"), alias));
	/* The search in the background may be the first to find it. */
	for (unsigned round = 0; round < 20 && !*text_of_touch(); round++) {
		put(inner_key, 0, false);
		host_run(&host, bus, host.now + 60 * HOST_S);
		host.events = 0;
		put(inner_key, 0, true);
		host_run(&host, bus, host.now + (60000 + 77 * round) * HOST_MS);
	}
	return text_of_touch();
}

static void test_a_long_way_is_named_whole_or_says_that_it_is_cut(void)
{
	static const char alias[] = "the key of somebody with a long name, and where he has to be "
				    "found when it is lost";

	TEST_ASSERT_EQUAL_STRING(
		"key 01.3C005DDF0300 touches 1F.1E005DDF0300/main/1F.1F005DDF0300/main",
		touched_behind(2, ""));
	TEST_ASSERT_EQUAL_STRING("key 01.3C005DDF0300 (the key of somebody with a long name, and "
	                         "where he has to be...) touches .../1F.1F005DDF0300/main/"
	                         "1F.20005DDF0300/main/1F.21005DDF0300/main/"
	                         "1F.22005DDF0300/main",
	                         touched_behind(5, alias));
}

/* A short makes edges, but no key: the branch stays off, and all else goes on. */
static void test_a_short_of_a_branch_does_not_stop_keys(void)
{
	add_branches();
	begin("on");
	wire_set(coupler, "main", 0);
	host_run(&host, bus, host.now + 10 * HOST_S);
	found_and_lost(on_aux, 300 * HOST_MS, 5, 1500 * HOST_MS);
	wire_set(coupler, "main", 1);
	host_run(&host, bus, host.now + 10 * HOST_S);
	found_and_lost(on_main, 300 * HOST_MS, 5, 1500 * HOST_MS);
}

/* With keys held on both branches the bus still reads and searches. */
static void test_keys_that_stay_on_branches_leave_time(void)
{
	add_branches();
	begin("on");
	put(on_main, 0, true);
	put(on_aux, 0, true);
	host_run(&host, bus, host.now + 5 * HOST_S);
	host.events = 0;
	for (unsigned round = 0; round < 5; round++) {
		ask_all();
		host_run(&host, bus, host.now + 3 * HOST_S);
		for (unsigned i = 0; i < 8; i++)
			TEST_ASSERT_EQUAL_INT(0, answer_to(i)->err);
	}
	TEST_ASSERT_EQUAL_UINT(0, host.events);
}

static void test_a_key_behind_two_couplers_is_found_in_turn(void)
{
	add_branches();
	begin("on");
	found_and_lost(deep, 2500 * HOST_MS, 0, 2500 * HOST_MS);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_key_that_touches_is_found_within_100_ms);
	RUN_TEST(test_over_a_ds2482_a_touch_is_a_value_within_100_ms);
	RUN_TEST(test_over_a_ds2482_a_touch_on_a_branch_is_a_value_within_400_ms);
	RUN_TEST(test_a_key_on_a_branch_is_found_within_300_ms);
	RUN_TEST(test_a_key_behind_two_couplers_is_found_in_turn);
	RUN_TEST(test_a_touch_on_a_branch_names_the_branch);
	RUN_TEST(test_a_long_way_is_named_whole_or_says_that_it_is_cut);
	RUN_TEST(test_a_short_of_a_branch_does_not_stop_keys);
	RUN_TEST(test_keys_that_stay_on_branches_leave_time);
	RUN_TEST(test_a_touch_is_in_the_log_with_key_alias_and_wire);
	RUN_TEST(test_a_key_that_stays_is_reported_once);
	RUN_TEST(test_without_the_option_nobody_hurries);
	RUN_TEST(test_the_option_is_on_or_off);
	return UNITY_END();
}
