/* SPDX-License-Identifier: MIT */
/* Tests of devices, wires and chips that are lost and come back. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/native/state.h"
#include "tests/unit/aid/native_scene.h"

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void test_a_short_is_told_and_gone_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "power"), "1");
	wire_net.wire[0].shorted = true;
	TEST_ASSERT_EQUAL_INT(-ECOMM, result(BUS_READ, of(slave, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-ECOMM, result(BUS_READ, of(slave, "power"), NULL));
	wire_net.wire[0].shorted = false;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
}

static void test_a_device_that_leaves_is_lost_and_found_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_add(0, "DS2401", 9);
	start();
	expect(true, of(slave, "power"), "1");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	sim_wire_plug(&wire_net.wire[0], slave, true, wire_time());
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(3, host_events(&host, BUS_FOUND));
	expect(true, of(slave, "power"), "1");
}

static void test_the_background_search_sees_devices_come_and_go(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS2401", 1);

	wire_add(0, "DS2401", 2);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_FOUND));
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	host_run(&host, bus, host.now + 15 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	wire_add(0, "DS2401", 3);
	host_run(&host, bus, host.now + 15 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(3, host_events(&host, BUS_FOUND));
}

static unsigned resets_until_lost(struct sim_slave *slave, unsigned wire)
{
	unsigned before = wire_net.resets[wire], lost = host_events(&host, BUS_LOST);

	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(lost + 1, host_events(&host, BUS_LOST));
	return wire_net.resets[wire] - before;
}

/* A branch that was unplugged costs its wire less; that tells nothing of another wire. */
static void test_the_next_one_of_a_wire_that_lost_several_is_looked_for_once(void)
{
	struct sim_slave *slave[6];
	unsigned first, next;

	wire_init(&host, 2, 1);
	for (unsigned i = 0; i < 6; i++)
		slave[i] = wire_add(i == 5, "DS18B20", i + 1);
	wire_add(0, "DS2401", 1);
	wire_add(1, "DS2401", 2);
	start();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 9, host.now + 5 * HOST_S));
	for (unsigned i = 0; i < 6; i++)
		sim_wire_plug(&wire_net.wire[i == 5], slave[i], false, wire_time());
	first = resets_until_lost(slave[0], 0);
	resets_until_lost(slave[1], 0);
	resets_until_lost(slave[2], 0);
	next = resets_until_lost(slave[3], 0);
	TEST_ASSERT_EQUAL_UINT(first - 2, next);
	TEST_ASSERT_EQUAL_UINT(first, resets_until_lost(slave[5], 1));
	TEST_ASSERT_EQUAL_UINT(next, resets_until_lost(slave[4], 0));
}

static unsigned found_again(const struct sim_slave *slave)
{
	unsigned n = 0;

	for (unsigned i = 0; i < host.events; i++)
		n += host.event[i].news == BUS_FOUND &&
		     memcmp(host.event[i].rom, slave->rom, sizeof(slave->rom)) == 0;
	return n;
}

/* What came back is looked for by the first bits of its id: its answer shows whether it is that. */
static void test_a_stranger_whose_id_begins_the_same_passes_for_a_lost_device_once(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 0x0001), *stranger;

	wire_add(0, "DS2401", 9);
	start();
	expect(true, of(slave, "power"), "1");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, found_again(slave));
	stranger = wire_add(0, "DS18B20", 0x8001);
	for (unsigned i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
		TEST_ASSERT_EQUAL_UINT(2, found_again(slave));
	}
	TEST_ASSERT_EQUAL_UINT(0, found_again(stranger));
	sim_wire_plug(&wire_net.wire[0], slave, true, wire_time());
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(3, found_again(slave));
}

/* Nobody waits for the answer that would show it: the search does, though it begins the same. */
static void test_a_lost_device_for_which_a_stranger_passes_is_lost_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 0x0001);
	unsigned lost;
	uint32_t id;

	wire_add(0, "DS2401", 9);
	start();
	expect(true, of(slave, "power"), "1");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
	wire_add(0, "DS18B20", 0x8001);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "power"), NULL);
	while (found_again(slave) < 2)
		TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host.now + HOST_S));
	req[id].deadline_ns = host.now;
	TEST_ASSERT_NOT_EQUAL_INT(0, answer_to(id)->err);
	lost = host_events(&host, BUS_LOST);
	host_run(&host, bus, host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(lost + 1, host_events(&host, BUS_LOST));
}

static unsigned count_twins(const char **text)
{
	unsigned n = 0;

	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == BUS_NOTE && strstr(host.event[i].text, " answers on ")) {
			*text = host.event[i].text;
			n++;
		}
	return n;
}

/* Of ids that were there once: the next new one takes the place of a device that is lost. */
static void fill_table(void)
{
	struct device_table *table = &((struct native *)bus)->table;
	const struct device *first = &table->devices[0];
	uint8_t rom[8] = {0x01};

	while (table->count < DEVICE_MAX) {
		rom[1] = (uint8_t)table->count;
		rom[2] = (uint8_t)(table->count >> 8);
		TEST_ASSERT_NOT_NULL(device_add(table, rom, first->family, 0));
	}
}

/* Others wait for a device while one request finds that it is lost, and a new one takes a place. */
static void test_no_request_gets_another_device_than_it_names(void)
{
	static const struct {
		const char *chip, *property, *next;
	} rows[] = {{"DS18B20", "temperature", "DS18B20"},
	            {"DS18B20", "scratchpad", "DS18B20"},
	            {"DS2408", "sensed.BYTE", "DS2401"}};

	for (unsigned row = 0; row < 3; row++) {
		uint32_t id[20];

		wire_init(&host, 1, 1);
		struct sim_slave *lost = wire_add(0, rows[row].chip, 1);
		start();
		host_run(&host, bus, host.now + 2 * HOST_S);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(lost, rows[row].property), NULL));
		fill_table();
		sim_wire_plug(&wire_net.wire[0], lost, false, wire_time());
		for (unsigned i = 0; i < 20; i++)
			id[i] = ask(BUS_READ, BUS_INPUT, true, of(lost, rows[row].property), NULL);
		for (unsigned ms = 0; ms < 2000 && !host_events(&host, BUS_LOST); ms++)
			host_run(&host, bus, host.now + HOST_MS);
		TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
		wire_add(0, rows[row].next, 2);
		answer_to(ask(BUS_DIR, BUS_ALARM, true, "/uncached", NULL));
		for (unsigned i = 0; i < 20; i++)
			TEST_ASSERT_EQUAL_INT(-ENODEV, answer_to(id[i])->err);
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

static void test_an_id_on_two_wires_is_reported_once(void)
{
	const char *text = "";

	wire_init(&host, 2, 1);
	wire_add(0, "DS2401", 1);
	wire_add(1, "DS2401", 1);
	start();
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, count_twins(&text));
	TEST_ASSERT_EQUAL_STRING("01.01005DDF0300 answers on bus.0 and on bus.1: of two chips with "
	                         "one id only one is served at a time",
	                         text);
}

static void test_a_device_that_is_moved_and_moved_back_is_no_twin(void)
{
	const char *text = "";

	wire_init(&host, 2, 1);
	struct sim_slave *here = wire_add(0, "DS2401", 1), *there = wire_add(1, "DS2401", 1);

	sim_wire_plug(&wire_net.wire[1], there, false, wire_time());
	start();
	for (int i = 0; i < 4; i++) {
		host_run(&host, bus, host.now + 90 * HOST_S);
		sim_wire_plug(&wire_net.wire[0], here, i % 2, wire_time());
		sim_wire_plug(&wire_net.wire[1], there, !(i % 2), wire_time());
	}
	host_run(&host, bus, host.now + 30 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, count_twins(&text));
}

static void test_the_ladder_is_climbed_until_the_chip_answers(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "power"), "1");
	wire_net.fault = -ETIMEDOUT;
	wire_net.fault_count = 1000;
	wire_net.fault_until = LINK_CHIP_RESET;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_BUS_RESET]);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_CHIP_RESET]);
	wire_net.fault = -ETIMEDOUT;
	wire_net.fault_count = 100000;
	wire_net.fault_until = LINK_RUNGS;
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	wire_net.fault_count = 0;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	expect(true, of(slave, "power"), "1");
}

/* As the contract of recover() has it (hal/wire/link.h). */
static void test_what_a_rung_returns_decides_what_follows(void)
{
	static const struct {
		int err;
		unsigned counted, chip_resets, opens;
	} rungs[] = {{0, 1, 0, 1},
	             {-ECOMM, 1, 0, 1},
	             {-EOPNOTSUPP, 0, 1, 1},
	             {-EIO, 1, 1, 1},
	             {-EBUSY, 1, 0, 2}};

	for (unsigned i = 0; i < sizeof(rungs) / sizeof(rungs[0]); i++) {
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, "DS18B20", 1);

		start();
		expect(true, of(slave, "power"), "1");
		wire_net.rung_err[LINK_BUS_RESET] = rungs[i].err;
		wire_net.fault = -EIO;
		wire_net.fault_count = 2;
		expect(true, of(slave, "power"), "1");
		TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_BUS_RESET]);
		TEST_ASSERT_EQUAL_UINT64(rungs[i].counted, counted("recover_bus_reset"));
		TEST_ASSERT_EQUAL_UINT(rungs[i].chip_resets, wire_net.recovered[LINK_CHIP_RESET]);
		TEST_ASSERT_EQUAL_UINT64(rungs[i].chip_resets, counted("recover_chip_reset"));
		TEST_ASSERT_EQUAL_UINT(0, wire_net.recovered[LINK_POWER_CYCLE]);
		TEST_ASSERT_EQUAL_UINT(rungs[i].opens, wire_net.opens);
		native_end();
		native_begin();
	}
}

static void test_a_chip_that_was_reset_is_set_up_at_once(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "power"), "1");
	wire_net.fault = -ENXIO;
	wire_net.fault_count = 1;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(0, wire_net.recovered[LINK_BUS_RESET]);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_CHIP_RESET]);
}

static void test_a_transaction_that_succeeds_leads_down_to_the_ground(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	for (unsigned i = 0; i < 5; i++) {
		expect(true, of(slave, "power"), "1");
		wire_net.fault = -EIO;
		wire_net.fault_count = 1;
	}
	TEST_ASSERT_EQUAL_UINT64(4, counted("retries"));
	TEST_ASSERT_EQUAL_UINT(0, wire_net.recovered[LINK_BUS_RESET]);
}

/* It may have lost its strong pull-up. */
static void test_after_a_reset_of_the_chip_a_conversion_begins_anew(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20.5);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
	wire_set(slave, "temperature", 21.5);
	uint64_t before = counted("conversions");
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);

	while (counted("conversions") == before)
		host_run(&host, bus, host.now + HOST_MS);
	wire_net.fault = -ENXIO;
	wire_net.fault_count = 1;
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_CHIP_RESET]);
	TEST_ASSERT_EQUAL_UINT64(before + 2, counted("conversions"));
}

/* Nothing was done to its devices: none has restarted. */
static void test_a_wire_without_rungs_is_tried_again_and_then_opened_anew(void)
{
	static struct link_ops without;

	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);
	start();
	expect(true, of(slave, "power"), "1");
	struct link *link = ((struct native *)bus)->channel[0].link;
	without = *link->ops;
	without.recover = NULL;
	link->ops = &without;
	wire_net.fault = -ETIMEDOUT;
	wire_net.fault_count = 1;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(1, wire_net.opens);
	wire_net.fault_count = 2;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(2, wire_net.opens);
	TEST_ASSERT_EQUAL_UINT64(0, counted("devices_restarted"));
}

/* At any moment of a measurement of many transactions, and of conversions. */
static void test_the_chips_that_are_left_go_on_when_one_dies(void)
{
	for (unsigned ms = 0; ms < 300; ms += 3) {
		uint32_t id[4];

		wire_init(&host, 2, 2);
		struct sim_slave *left = wire_add(0, "DS18B20", 1);
		const char *const lost[] = {"DS2438", "DS18B20", "DS18B20"};

		start();
		for (unsigned i = 0; i < 3; i++)
			wire_add(1, lost[i], i + 2);
		host_run(&host, bus, host.now + 2 * HOST_S);
		id[0] = ask(BUS_READ, BUS_INPUT, true, "/26.02005DDF0300/humidity", NULL);
		id[1] = ask(BUS_READ, BUS_INPUT, true, "/28.03005DDF0300/temperature", NULL);
		id[2] = ask(BUS_READ, BUS_INPUT, true, "/28.04005DDF0300/temperature", NULL);
		id[3] = ask(BUS_DIR, BUS_ALARM, true, "/alarm", NULL);
		host_run(&host, bus, host.now + ms * HOST_MS);
		wire_net.channels = 1;
		for (unsigned i = 0; i < 4; i++)
			answer_to(id[i]);
		TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[3])->err);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(left, "temperature"), NULL));
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

/* A wire is opened anew because of another one's errors: what waits for its Convert T. */
static void test_a_reading_goes_on_after_all_wires_were_opened_anew(void)
{
	unsigned anew = 0;

	for (unsigned step = 0; step < 60; step++) {
		wire_init(&host, 2, 2);
		struct sim_slave *slave = wire_add(0, "DS18B20", 1),
				 *other = wire_add(1, "DS2438", 2);

		start();
		host_run(&host, bus, host.now + 2 * HOST_S);
		expect(true, of(slave, "power"), "1");
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);

		ask(BUS_READ, BUS_INPUT, true, of(other, "humidity"), NULL);
		host_run(&host, bus, host.now + step * HOST_MS / 2);
		wire_net.rung_err[LINK_BUS_RESET] = -EBUSY;
		wire_net.fault = -EIO;
		wire_net.fault_count = 2;
		int64_t begun = host.now;
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_LESS_THAN_INT64(begun + 3 * HOST_S, host.now);
		anew += wire_net.opens > 1;
		native_end();
		native_begin();
	}
	TEST_ASSERT_GREATER_THAN_UINT(20, anew);
	wire_init(&host, 1, 1);
	start();
}

static void test_a_suspended_bus_lets_go_and_comes_back(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + HOST_S);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.closes);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(BUS_READ, of(slave, "power"), NULL));
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	expect(true, of(slave, "power"), "1");
}

static void test_a_target_that_does_not_open_is_tried_again_for_ever(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_net.open_error = -ENXIO;
	bus = wire_open();
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_STRING("no such chip", host.event[0].text);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_GREATER_THAN_UINT(10, wire_net.opens);
	TEST_ASSERT_LESS_THAN_UINT(30, wire_net.opens);
	wire_net.open_error = 0;
	host_run(&host, bus, host.now + 6 * HOST_S);
	expect(true, of(slave, "power"), "1");
}

/* What a master advises for a start, to switch it on or to load a module, is no help then. */
static void test_a_target_that_was_there_is_looked_for_more_often_and_its_plug_is_named(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + HOST_S);
	bus_suspend(bus, true);
	wire_net.open_error = -ENODEV;
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_NOT_NULL(strstr(host.event[host.events - 1].text, "look at its plug"));
	wire_net.open_error = 0;
	host_run(&host, bus, host.now + 600 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	expect(true, of(slave, "power"), "1");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_short_is_told_and_gone_again);
	RUN_TEST(test_a_target_that_was_there_is_looked_for_more_often_and_its_plug_is_named);
	RUN_TEST(test_a_device_that_leaves_is_lost_and_found_again);
	RUN_TEST(test_the_background_search_sees_devices_come_and_go);
	RUN_TEST(test_the_next_one_of_a_wire_that_lost_several_is_looked_for_once);
	RUN_TEST(test_a_stranger_whose_id_begins_the_same_passes_for_a_lost_device_once);
	RUN_TEST(test_a_lost_device_for_which_a_stranger_passes_is_lost_again);
	RUN_TEST(test_no_request_gets_another_device_than_it_names);
	RUN_TEST(test_an_id_on_two_wires_is_reported_once);
	RUN_TEST(test_a_device_that_is_moved_and_moved_back_is_no_twin);
	RUN_TEST(test_the_ladder_is_climbed_until_the_chip_answers);
	RUN_TEST(test_what_a_rung_returns_decides_what_follows);
	RUN_TEST(test_a_chip_that_was_reset_is_set_up_at_once);
	RUN_TEST(test_a_transaction_that_succeeds_leads_down_to_the_ground);
	RUN_TEST(test_after_a_reset_of_the_chip_a_conversion_begins_anew);
	RUN_TEST(test_a_wire_without_rungs_is_tried_again_and_then_opened_anew);
	RUN_TEST(test_the_chips_that_are_left_go_on_when_one_dies);
	RUN_TEST(test_a_reading_goes_on_after_all_wires_were_opened_anew);
	RUN_TEST(test_a_suspended_bus_lets_go_and_comes_back);
	RUN_TEST(test_a_target_that_does_not_open_is_tried_again_for_ever);
	return UNITY_END();
}
