/* SPDX-License-Identifier: MIT */
/* Tests of the alarm search of the native bus. */
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

static void test_alarms_list_the_devices_in_alarm(void)
{
	wire_init(&host, 2, 2);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1), *other = wire_add(1, "DS18B20", 2);

	wire_set(slave, "temperature", 40);
	wire_set(other, "temperature", 20);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "templow"), "10"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
	host_run(&host, bus, host.now + HOST_S);
	for (int i = 0; i < 20; i++) {
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm", NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("/alarm/28.01005DDF0300\n", (char *)data[id]);
	}
	uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29,28", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/alarm/28.01005DDF0300\n", (char *)data[id]);
	id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("", (char *)data[id]);
}

/* So often that each search in a row is made, whole and not. */
#define SEARCHES 40

static void expect_alarms(const char *where, const char *list)
{
	for (unsigned i = 0; i < SEARCHES; i++) {
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, where, NULL);

		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING(list, (char *)data[id]);
	}
	forget();
}

/* To be in the search is their alarm: no other chip makes it. */
static void test_no_thermometer_is_in_alarm_for_another_chip(void)
{
	static const char *const others[] = {"TMP1826", "DS18B20", "DS18S20", "DS2408"};
	char list[80];

	for (unsigned k = 0; k < 4; k++) {
		wire_init(&host, 1, 1);
		struct sim_slave *calm = wire_add(0, "DS18B20", 1),
				 *other = wire_add(0, others[k], 2);

		wire_set(calm, "temperature", 20);
		if (k < 3)
			wire_set(other, "temperature", 90);
		start();
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "temphigh"), "30"));
		if (k == 0)
			TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "temphigh"), "80"));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "templow"), "10"));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
		host_run(&host, bus, host.now + HOST_S);
		forget();
		snprintf(list, sizeof(list), "/alarm%s\n", name_of(other));
		expect_alarms("/alarm", list);
		expect_alarms("/alarm/28", k == 1 ? list : "");
		tearDown();
		setUp();
	}
}

/* With the limits of the factory, before a search in the background has met it. */
static void test_one_that_is_new_is_in_alarm_itself(void)
{
	char list[80];

	wire_init(&host, 1, 1);
	struct sim_slave *calm = wire_add(0, "DS18B20", 1);

	wire_set(calm, "temperature", 20);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "templow"), "10"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(calm, "temperature"), NULL));
	struct sim_slave *new = wire_add(0, "DS18B20", 3);
	wire_set(new, "temperature", 90);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
	host_run(&host, bus, host.now + 800 * HOST_MS);
	forget();
	snprintf(list, sizeof(list), "/alarm%s\n", name_of(new));
	expect_alarms("/alarm/28", list);
}

/* Of a switch the latch tells, unless the list has to. */
static void test_no_switch_is_listed_for_a_new_one_where_its_id_is_read_whole(void)
{
	char list[80];

	wire_init(&host, 1, 1);
	struct sim_slave *calm = wire_add(0, "DS2408", 1);

	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "por"), "0"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(calm, "latch.BYTE"), "0"));
	struct sim_slave *new = wire_add(0, "DS2408", 2);
	snprintf(list, sizeof(list), "/alarm%s\n", name_of(new));
	list_whole = true;
	expect_alarms("/alarm/29", list);
}

/* Each slot of a search that nobody answers. */
static void test_no_turned_slot_makes_an_alarm(void)
{
	static struct trouble trouble;

	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	wire_add(0, "DS18B20", 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (uint32_t at = 8; at < 12; at++) {
		trouble_none(&trouble);
		trouble.kind = TROUBLE_TURN;
		trouble.at = at;
		trouble.mask = 1;
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/28", NULL);
		(void)answer_to(id);
		TEST_ASSERT_EQUAL_STRING("", (char *)data[id]);
	}
}

static void test_an_alarm_search_goes_no_further_than_its_family(void)
{
	static const char *const chips[] = {"DS18B20", "DS1822", "DS2406", "DS18S20"};
	uint64_t resets, slots;

	for (unsigned n = 0; n < 4; n++) {
		wire_init(&host, 1, 1);
		/* With the limits of the factory it is in alarm once it has converted. */
		struct sim_slave *slave = wire_add(0, chips[n], 1);

		wire_add(0, "DS2408", 2);
		start();
		if (strcmp(chips[n], "DS2406") != 0)
			TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/29.02005DDF0300/por", "0"));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/29.02005DDF0300/latch.BYTE", "0"));
		resets = wire_net.wire[0].resets;
		slots = wire_net.wire[0].slots;
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29", NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("", (char *)data[id]);
		TEST_ASSERT_EQUAL_UINT64(1, wire_net.wire[0].resets - resets);
		TEST_ASSERT_LESS_OR_EQUAL_UINT64(8 + 8 * 3, wire_net.wire[0].slots - slots);
		tearDown();
		setUp();
	}
}

static void test_an_alarm_s_next_request_is_waited_for(void)
{
	struct sim_slave *slave[6], *board;
	int64_t begun;

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 6; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	board = wire_add(0, "DS2408", 9);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 6; i++)
		ask(BUS_READ, BUS_INPUT, true, of(slave[i], "scratchpad"), NULL);
	for (unsigned i = 0; i < 3; i++) {
		uint32_t id = ask(BUS_READ, BUS_ALARM, true, of(board, "sensed.BYTE"), NULL);

		begun = host.now;
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		/*
		 * A thread hears of the answer a little later; the others are not begun meanwhile.
		 */
		TEST_ASSERT_EQUAL_UINT(i + 1, host.answers);
		host_run(&host, bus, host.now + HOST_MS / 5);
		TEST_ASSERT_LESS_THAN_INT64(begun + 18 * HOST_MS, host.now);
	}
	/* Nobody asks: they go on. */
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 9, host.now + 130 * HOST_MS));
}

static void test_one_register_read_serves_por_and_latch_of_a_visit(void)
{
	struct sim_slave *board;
	uint64_t resets;
	uint32_t id;

	wire_init(&host, 1, 1);
	board = wire_add(0, "DS2408", 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 3; i++) {
		wire_set(board, "pin.0", i & 1);
		resets = wire_net.wire[0].resets;
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "por"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "latch.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("           1", (char *)data[id]);
		TEST_ASSERT_EQUAL_UINT64(1, wire_net.wire[0].resets - resets);
		/* The value itself is always read. */
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "sensed.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_UINT64(2, wire_net.wire[0].resets - resets);
		id = ask(BUS_WRITE, BUS_ALARM, true, of(board, "latch.BYTE"), "0");
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "latch.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("           0", (char *)data[id]);
	}
}

static void test_an_alarm_waits_for_one_transaction_and_not_for_a_scan(void)
{
	struct sim_slave *slave[20];

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 20; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 20; i++)
		ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	while (host.answers < 5)
		host_run_answers(&host, bus, 5, host.now + 2 * HOST_S);
	int64_t begun = host.now;
	uint32_t id = ask(BUS_READ, BUS_ALARM, true, of(slave[19], "temphigh"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_LESS_THAN_INT64(begun + 40 * HOST_MS, host.now);
	TEST_ASSERT_LESS_THAN_UINT(10, host.answers);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_alarms_list_the_devices_in_alarm);
	RUN_TEST(test_no_thermometer_is_in_alarm_for_another_chip);
	RUN_TEST(test_one_that_is_new_is_in_alarm_itself);
	RUN_TEST(test_no_switch_is_listed_for_a_new_one_where_its_id_is_read_whole);
	RUN_TEST(test_no_turned_slot_makes_an_alarm);
	RUN_TEST(test_an_alarm_search_goes_no_further_than_its_family);
	RUN_TEST(test_an_alarm_s_next_request_is_waited_for);
	RUN_TEST(test_one_register_read_serves_por_and_latch_of_a_visit);
	RUN_TEST(test_an_alarm_waits_for_one_transaction_and_not_for_a_scan);
	return UNITY_END();
}
