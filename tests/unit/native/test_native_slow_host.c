/* SPDX-License-Identifier: MIT */
/* A host that keeps the thread of the bus from the processor: its answers are late, not lost. */
#include <errno.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

#define ALL 30
#define PATIENCE_NS (10 * HOST_S)

#define SLEEP_NS (3600 * HOST_S)
#define SOON_NS (60 * HOST_S)

static int64_t slower_ns; /* each reset and slot takes so much longer */
static unsigned sleeps;   /* the host sleeps at the reset or slot that counts it to zero */

static void keep_it(int64_t now)
{
	(void)now;
	host.now += slower_ns;
	if (sleeps && !--sleeps)
		host.now += SLEEP_NS;
}

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	slower_ns = sleeps = 0;
	wire_net.used = keep_it;
}

void tearDown(void)
{
	native_end();
}

static uint32_t ask_within(int64_t patience_ns, enum bus_op op, const char *what, const char *text)
{
	uint32_t id = ask(op, op == BUS_WRITE ? BUS_OUTPUT : BUS_INPUT, true, what, text);

	req[id].deadline_ns = host.now + patience_ns;
	return id;
}

static void test_a_value_that_was_measured_is_read_late_and_has_its_time(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21.5);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	int64_t begun = host.now;
	uint32_t id = ask_within(PATIENCE_NS, BUS_READ, of(slave, "temperature12"), NULL);
	host_run(&host, bus, begun + 300 * HOST_MS);
	uint64_t conversions = counted("conversions");
	host.now += 40 * HOST_S;
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT64(conversions, counted("conversions"));
	TEST_ASSERT_EQUAL_DOUBLE(21.5, answer_to(id)->number);
	TEST_ASSERT_INT64_WITHIN(HOST_S, begun, answer_to(id)->measured_ns);
}

static void test_all_are_read_though_each_transaction_takes_too_long(void)
{
	struct sim_slave *slave[ALL];

	for (unsigned i = 0; i < ALL; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	start();
	host_run(&host, bus, host.now + 3 * HOST_S);
	slower_ns = 5 * HOST_MS;
	uint32_t id[ALL];
	for (unsigned i = 0; i < ALL; i++)
		id[i] = ask_within(PATIENCE_NS, BUS_READ, of(slave[i], "temperature12"), NULL);
	int64_t begun = host.now;
	for (unsigned i = 0; i < ALL; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
	TEST_ASSERT_GREATER_THAN_INT64(PATIENCE_NS, host.now - begun);
}

/* The thread is kept for ever longer: what was begun ends all the same. */
static void test_no_request_waits_for_ever(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	uint32_t id = ask_within(PATIENCE_NS, BUS_READ, of(slave, "temperature12"), NULL);
	host_run(&host, bus, host.now + 300 * HOST_MS);
	host.now += 3600 * HOST_S;
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, answer_to(id)->err);
}

/* However long the thread is kept, and wherever: a command that was not carried out is not done. */
static void test_a_late_command_is_done_or_an_error(void)
{
	struct sim_slave *slave = wire_add(0, "DS2408", 1);
	unsigned errors = 0;

	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 60; i++) {
		const char *want = i % 2 ? "1" : "0";

		slower_ns = 0;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "PIO.0"), i % 2 ? "0" : "1"));
		slower_ns = i * HOST_MS;
		uint32_t id = ask_within(500 * HOST_MS, BUS_WRITE, of(slave, "PIO.0"), want);
		int err = answer_to(id)->err;
		slower_ns = 0;
		forget();
		if (!err)
			expect(true, of(slave, "PIO.0"), want);
		errors += err != 0;
		forget();
	}
	TEST_ASSERT_GREATER_THAN_UINT(0, errors);
	TEST_ASSERT_LESS_THAN_UINT(60, errors);
}

/* Runs until the host has slept in a search, at its slot `at`. */
static void sleep_in_a_search(unsigned at)
{
	int64_t slept = host.now + SLEEP_NS;

	sleeps = at;
	while (host.now < slept)
		host_run(&host, bus, host.now + 100 * HOST_MS);
}

/* Sleep is no use of the wire, of which searches leave others their share. */
static void test_what_is_plugged_in_after_a_sleep_in_a_search_is_found(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_add(0, "DS18B20", 2);
	start();
	for (unsigned at = 1; at < 400; at += 57) {
		slave->plugged = false;
		host_run(&host, bus, host.now + SOON_NS);
		uint64_t found = counted("devices_found");
		sleep_in_a_search(at);
		slave->plugged = true;
		host_run(&host, bus, host.now + SOON_NS);
		TEST_ASSERT_EQUAL_UINT64(found + 1, counted("devices_found"));
	}
}

static void test_a_key_is_noticed_after_a_sleep_in_the_search_for_keys(void)
{
	struct sim_slave *key = wire_add(0, "DS2401", 1);
	char why[80] = "";

	start();
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "Touch", "on", why, sizeof(why)));
	for (unsigned at = 1; at < 100; at += 9) {
		key->plugged = false;
		host_run(&host, bus, host.now + SOON_NS);
		uint64_t found = counted("devices_found");
		sleep_in_a_search(at);
		key->plugged = true;
		host_run(&host, bus, host.now + 5 * HOST_S);
		TEST_ASSERT_EQUAL_UINT64(found + 1, counted("devices_found"));
	}
}

static void test_what_was_looked_for_in_a_sleep_is_read_after_it(void)
{
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_add(0, "DS18B20", 2);
	start();
	for (unsigned at = 1; at < 400; at += 57) {
		slave->plugged = false;
		host_run(&host, bus, host.now + SOON_NS);
		ask_within(PATIENCE_NS, BUS_READ, of(slave, "temperature12"), NULL);
		sleep_in_a_search(at);
		slave->plugged = true;
		uint32_t id = ask_within(PATIENCE_NS, BUS_READ, of(slave, "temperature12"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		forget();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_that_was_measured_is_read_late_and_has_its_time);
	RUN_TEST(test_all_are_read_though_each_transaction_takes_too_long);
	RUN_TEST(test_no_request_waits_for_ever);
	RUN_TEST(test_a_late_command_is_done_or_an_error);
	RUN_TEST(test_what_is_plugged_in_after_a_sleep_in_a_search_is_found);
	RUN_TEST(test_a_key_is_noticed_after_a_sleep_in_the_search_for_keys);
	RUN_TEST(test_what_was_looked_for_in_a_sleep_is_read_after_it);
	return UNITY_END();
}
