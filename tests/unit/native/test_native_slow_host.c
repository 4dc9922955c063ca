/* SPDX-License-Identifier: MIT */
/* A host that keeps the thread of the bus from the processor: its answers are late, not lost. */
#include <errno.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

#define ALL 30
#define PATIENCE_NS (10 * HOST_S)

static int64_t slower_ns; /* each reset and slot takes so much longer */

static void keep_it(int64_t now)
{
	(void)now;
	host.now += slower_ns;
}

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	slower_ns = 0;
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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_that_was_measured_is_read_late_and_has_its_time);
	RUN_TEST(test_all_are_read_though_each_transaction_takes_too_long);
	RUN_TEST(test_no_request_waits_for_ever);
	RUN_TEST(test_a_late_command_is_done_or_an_error);
	return UNITY_END();
}
