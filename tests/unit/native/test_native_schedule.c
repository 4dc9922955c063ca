/* SPDX-License-Identifier: MIT */
/*
 * Thermometers that are asked for without pause: how often each value is new, what others wait, and
 * that no trouble makes an old result look new.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/native/state.h"
#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define CONVERT_NS (750 * HOST_MS)
/* The wire's time without a bridge chip (wire_link.c): reset and 19 bytes, reset and 11 bytes. */
#define READ_NS (1184000 + 19 * 8 * INT64_C(69250))
#define START_NS (1184000 + 11 * 8 * INT64_C(69250))

static struct trouble trouble;
static unsigned starts; /* Convert T behind Match ROM */

void setUp(void)
{
	native_begin();
	fleet_begin();
}

void tearDown(void)
{
	native_end();
}

static void count_starts(const uint8_t *bytes, size_t n)
{
	starts += n == 10 && bytes[0] == 0x55 && bytes[9] == 0x44;
}

static void set_out(unsigned count, const char *chip)
{
	wire_init(&host, 1, 1);
	fleet_add(chip, count);
	starts = 0;
	wire_net.sent = count_starts;
}

/* A minute of it. Returns the mean time in which each value is new, in ms. */
static double minute(void)
{
	fleet_run(host.now + 5 * HOST_S);
	fleet_forget();
	starts = wire_net.convert_count = 0;
	fleet_run(host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_EQUAL_UINT(0, fleet.failed);
	TEST_ASSERT_EQUAL_UINT(0, fleet.older + fleet.newer);
	for (unsigned i = 0; i < fleet.count; i++)
		TEST_ASSERT_GREATER_OR_EQUAL_UINT(fleet.good / fleet.count - 1, fleet.each[i]);
	/* Six of the seconds are not judged, nor counted. */
	return 54000.0 * fleet.count / fleet.good;
}

static void check_minute(unsigned count, const char *chip, double most_ms)
{
	char text[100];

	set_out(count, chip);
	start();
	double ms = minute();
	snprintf(text, sizeof(text), "%u %s: %.0f ms, %u starts, %u for all", count, chip, ms,
	         starts, wire_net.convert_count);
	TEST_MESSAGE(text);
	TEST_ASSERT_TRUE_MESSAGE(ms < most_ms, text);
}

static void test_one_is_new_after_each_conversion(void)
{
	check_minute(1, "DS18B20", 790);
	TEST_ASSERT_LESS_THAN_UINT(3, starts);
}

static void test_few_are_new_after_each_conversion_though_others_are_read(void)
{
	check_minute(10, "DS18B20", 800);
	TEST_ASSERT_GREATER_THAN_UINT(600, starts);
}

/* Reading and starting 50 takes 950 ms; one conversion and then 50 readings would take 1335. */
static void test_fifty_are_new_as_fast_as_the_wire_can_read_and_start_them(void)
{
	check_minute(50, "DS18B20", 1.04 * 50 * (double)(READ_NS + START_NS) / 1e6);
}

/* 100 times reading and starting takes 1.90 s, one conversion and 100 readings 1.92: as before. */
static void test_a_hundred_are_not_slower_than_all_at_once(void)
{
	check_minute(100, "DS18B20", 1.04 * (double)(CONVERT_NS + 100 * READ_NS) / 1e6);
}

/* All are asked for in one go, with pauses: once a minute one by one, and else all at once. */
static void test_what_is_asked_for_in_one_go_converts_at_once(void)
{
	uint32_t id[10];

	set_out(10, "DS18B20");
	start();
	for (unsigned scan = 0; scan < 170; scan++) {
		for (unsigned i = 0; i < 10; i++)
			id[i] = ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[i], "temperature"),
			            NULL);
		for (unsigned i = 0; i < 10; i++)
			TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
		forget();
		host_run(&host, bus, host.now + 137 * HOST_MS);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT(3 * 10, starts);
	TEST_ASSERT_GREATER_THAN_UINT(160, wire_net.convert_count);
}

/* A conversion of 9 bits is as long as ten readings; a clone may take 110 ms, and looks genuine. */
static void test_short_conversions_are_not_slower_than_all_at_once(void)
{
	fleet.property = "temperature9";
	fleet.step = 0.5;
	set_out(20, "DS18B20");
	start();
	fleet_run(host.now + 5 * HOST_S);
	fleet_forget();
	fleet_run(host.now + 40 * HOST_S);
	TEST_ASSERT_GREATER_THAN_UINT(
		20 * (unsigned)(34 * HOST_S / (110 * HOST_MS + 20 * READ_NS)) * 96 / 100,
		fleet.good);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
}

static void test_those_fed_by_the_wire_do_not_convert_in_turn(void)
{
	set_out(4, "DS18B20");
	fleet.slave[0]->parasite = true;
	start();
	fleet_run(host.now + 10 * HOST_S);
	fleet_forget();
	wire_net.strong_count = 0;
	fleet_run(host.now + 30 * HOST_S);
	TEST_ASSERT_GREATER_THAN_UINT(10, wire_net.strong_count);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(750 * HOST_MS, wire_net.strong_ns);
}

/* A clone that cannot show that it converts is converted with all. */
static void test_a_clone_that_shows_nothing_leaves_all_to_convert_at_once(void)
{
	set_out(9, "DS18B20");
	fleet_add("DS18B20-F", 1);
	start();
	fleet_run(host.now + 5 * HOST_S);
	fleet_forget();
	starts = wire_net.convert_count = 0;
	fleet_run(host.now + 50 * HOST_S);
	TEST_ASSERT_GREATER_THAN_UINT(40, wire_net.convert_count);
	for (unsigned i = 0; i < 9; i++)
		TEST_ASSERT_GREATER_THAN_UINT(40, fleet.each[i]);
	/* Its conversion of 27 ms ends long before its stamp: values are not judged. */
	TEST_ASSERT_GREATER_THAN_UINT(20, fleet.each[9]);
}

/* --- What others wait ------------------------------------------------------------------------- */

static int64_t longest_wait(enum bus_prio prio, enum bus_op op, const char *path)
{
	int64_t longest = 0;
	char kept[100];

	snprintf(kept, sizeof(kept), "%s", path);
	for (unsigned i = 0; i < 60; i++) {
		int err;

		fleet_run(host.now + (37 + 13 * i) * HOST_MS);
		int64_t took = fleet_answered(fleet_ask(prio, op, kept), &err);
		TEST_ASSERT_EQUAL_INT(0, err);
		longest = took > longest ? took : longest;
	}
	return longest;
}

static void test_alarms_and_guests_wait_for_one_reading(void)
{
	set_out(50, "DS18B20");
	struct sim_slave *board = wire_add(0, "DS2408", 200);

	start();
	fleet_run(host.now + 5 * HOST_S);
	/* What goes on, then a search that finds nothing: a reset, a byte and some triplets. */
	TEST_ASSERT_LESS_THAN_INT64(READ_NS + 6 * HOST_MS,
	                            longest_wait(BUS_ALARM, BUS_DIR, "/alarm/29"));
	/* One reading and one start, then its own transactions: 18 ms each in their turn. */
	TEST_ASSERT_LESS_THAN_INT64(4 * (READ_NS + START_NS + 18 * HOST_MS),
	                            longest_wait(BUS_INPUT, BUS_READ, of(board, "sensed.BYTE")));
	TEST_ASSERT_LESS_THAN_INT64(4 * (READ_NS + START_NS + 18 * HOST_MS),
	                            longest_wait(BUS_GUEST, BUS_READ, of(board, "sensed.BYTE")));
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
}

/* After a minute it is asked by itself: it waits until other work with it is done. */
static void test_no_chip_is_asked_to_convert_while_it_is_at_work(void)
{
	set_out(1, "DS18B20");
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(fleet.slave[0], "temperature"), NULL));
	host_run(&host, bus, host.now + 61 * HOST_S);
	struct device *device = device_find(&((struct native *)bus)->table, fleet.slave[0]->rom);

	starts = wire_net.convert_count = 0;
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[0], "temperature"), NULL);
	host_run(&host, bus, host.now + HOST_MS);
	device->locked = true;
	host_run(&host, bus, host.now + 50 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(0, starts + wire_net.convert_count);
	device->locked = false;
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(1, starts);
}

/* --- Trouble ---------------------------------------------------------------------------------- */

static void three(void)
{
	fleet_again();
	set_out(3, "DS18B20");
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	start();
	fleet_run(host.now + 4 * HOST_S);
	fleet_forget();
	trouble_none(&trouble);
}

static void run_for(int64_t ns)
{
	fleet_run(host.now + ns);
}

/* Of one round of three that convert in turn, each slot and each reset. */
static void test_no_trouble_in_any_slot_makes_an_old_result_look_new(void)
{
	uint32_t slots;
	unsigned good = fleet_troubles(&trouble, three, run_for, 1000 * HOST_MS, &slots);

	TEST_ASSERT_GREATER_OR_EQUAL_UINT32(3 * 240, slots);
	TEST_ASSERT_GREATER_THAN_UINT(3 * 4 * slots, good);
}

static void test_no_restart_at_any_moment_makes_an_old_result_look_new(void)
{
	static const char *const chips[] = {"DS18B20", "DS18S20", "DS18B20-B1"};
	unsigned good = 0;

	for (unsigned c = 0; c < 3; c++)
		good += fleet_restarts(set_out, 3, chips[c], 6 * HOST_S, 1600, 7);
	TEST_ASSERT_GREATER_THAN_UINT(3000, good);
}

static void turn_supply(const uint8_t *bytes, size_t n)
{
	bool asks = n == 10 && memcmp(bytes + 1, fleet.slave[4]->rom, 8) == 0 && bytes[9] == 0xb4;

	trouble.kind = asks ? TROUBLE_TURN : TROUBLE_NONE;
	trouble.mask = 1;
	trouble.at = trouble.slots + 3;
}

/* It is tried again and again, also without pause: the results of the others are read meanwhile. */
static void test_one_that_shows_nothing_and_tells_no_supply_does_not_stop_the_others(void)
{
	static const int64_t pauses_ms[] = {0, 10, 100, 5000};

	for (unsigned k = 0; k < sizeof(pauses_ms) / sizeof(pauses_ms[0]); k++) {
		fleet_again();
		set_out(4, "DS18B20");
		fleet_add("DS18B20-F", 1);
		fleet.pause_ns[4] = pauses_ms[k] * HOST_MS;
		wire_net.trouble = &trouble;
		trouble_none(&trouble);
		wire_net.sent = turn_supply;
		start();
		fleet_run(host.now + 5 * HOST_S);
		fleet_forget();
		fleet_run(host.now + 50 * HOST_S);
		for (unsigned i = 0; i < 4; i++)
			TEST_ASSERT_GREATER_THAN_UINT(50 * HOST_S / (910 * HOST_MS) - 7,
			                              fleet.each[i]);
		TEST_ASSERT_GREATER_THAN_UINT(8, fleet.failed);
	}
}

/* From some moment on one of them is fed by the wire alone, and cannot convert as before. */
static void test_one_that_loses_its_supply_gives_no_old_result(void)
{
	unsigned wrong = 0;

	for (int64_t at = 1; at < 800; at += 23) {
		fleet_again();
		set_out(5, "DS18B20");
		start();
		fleet_run(host.now + 4 * HOST_S + at * HOST_MS);
		fleet_forget();
		fleet.slave[2]->parasite = true;
		fleet_run(host.now + 20 * HOST_S);
		wrong += fleet.wrong;
		TEST_ASSERT_GREATER_THAN_UINT(10, fleet.each[0]);
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
}

static void test_noise_makes_no_old_result_look_new(void)
{
	set_out(20, "DS18B20");
	wire_net.trouble = &trouble;
	trouble.random = 20251;
	trouble_none(&trouble);
	start();
	fleet_run(host.now + 5 * HOST_S);
	fleet_forget();
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.001;
	for (unsigned i = 0; i < 60; i++) {
		fleet_run(host.now + 20 * HOST_S);
		host.events = 0;
	}
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_GREATER_THAN_UINT(10000, fleet.good);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_one_is_new_after_each_conversion);
	RUN_TEST(test_few_are_new_after_each_conversion_though_others_are_read);
	RUN_TEST(test_fifty_are_new_as_fast_as_the_wire_can_read_and_start_them);
	RUN_TEST(test_a_hundred_are_not_slower_than_all_at_once);
	RUN_TEST(test_what_is_asked_for_in_one_go_converts_at_once);
	RUN_TEST(test_short_conversions_are_not_slower_than_all_at_once);
	RUN_TEST(test_those_fed_by_the_wire_do_not_convert_in_turn);
	RUN_TEST(test_a_clone_that_shows_nothing_leaves_all_to_convert_at_once);
	RUN_TEST(test_alarms_and_guests_wait_for_one_reading);
	RUN_TEST(test_no_chip_is_asked_to_convert_while_it_is_at_work);
	RUN_TEST(test_no_trouble_in_any_slot_makes_an_old_result_look_new);
	RUN_TEST(test_no_restart_at_any_moment_makes_an_old_result_look_new);
	RUN_TEST(test_one_that_loses_its_supply_gives_no_old_result);
	RUN_TEST(test_one_that_shows_nothing_and_tells_no_supply_does_not_stop_the_others);
	RUN_TEST(test_noise_makes_no_old_result_look_new);
	return UNITY_END();
}
