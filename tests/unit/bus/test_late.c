/* SPDX-License-Identifier: MIT */
/* Tests of the late bus. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/host.h"

#define TEMPERATURE "/28.000000000001/temperature"

static struct host host;
static struct bus *bus;
static struct bus_req req[64];
static uint8_t data[64][32];

void setUp(void)
{
	host_init_virtual(&host);
	bus = NULL;
}

void tearDown(void)
{
	bus_destroy(bus);
}

static int submit(uint32_t id, const char *path)
{
	req[id] = (struct bus_req){.id = id,
	                           .op = BUS_READ,
	                           .path = path,
	                           .data = data[id],
	                           .len = sizeof(data[id]),
	                           .deadline_ns = host.now + 20 * HOST_S};
	return bus_submit(bus, &req[id]);
}

static void start(const char *target)
{
	bus = host_bus(&host, target);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
}

static void test_answers_come_late_and_out_of_order_but_all(void)
{
	bool out_of_order = false;
	int64_t begun;

	start("late:seed=5;late=100");
	begun = host.now;
	TEST_ASSERT_GREATER_THAN_UINT(1, bus_depth(bus));
	for (uint32_t id = 0; id < bus_depth(bus); id++)
		TEST_ASSERT_EQUAL_INT(0, submit(id, TEMPERATURE));
	TEST_ASSERT_EQUAL_INT(-EAGAIN, submit(bus_depth(bus), TEMPERATURE));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, bus_depth(bus), begun + HOST_S));
	TEST_ASSERT_GREATER_THAN_INT64(begun, host.now);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(begun + 100 * HOST_MS, host.now);
	for (uint32_t i = 0; i < host.answers; i++) {
		TEST_ASSERT_EQUAL_INT(0, host.answer[i].err);
		TEST_ASSERT_EQUAL_MEMORY("21.5", data[host.answer[i].id], 4);
		TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, i));
		out_of_order |= i && host.answer[i].id < host.answer[i - 1].id;
	}
	TEST_ASSERT_TRUE(out_of_order);
}

static void test_the_same_seed_gives_the_same_order(void)
{
	uint32_t order[2][16];

	for (unsigned round = 0; round < 2; round++) {
		host_init_virtual(&host);
		start("late:seed=77");
		for (uint32_t id = 0; id < 16; id++)
			submit(id, TEMPERATURE);
		TEST_ASSERT_TRUE(host_run_answers(&host, bus, 16, host.now + HOST_S));
		for (unsigned i = 0; i < 16; i++)
			order[round][i] = host.answer[i].id;
		bus_destroy(bus);
		bus = NULL;
	}
	TEST_ASSERT_EQUAL_UINT32_ARRAY(order[0], order[1], 16);
}

static void test_a_path_says_twice_never_or_late(void)
{
	int64_t begun;

	start("late:");
	begun = host.now;
	submit(1, "/twice" TEMPERATURE);
	submit(2, "/never" TEMPERATURE);
	submit(3, "/late" TEMPERATURE);
	host_run(&host, bus, begun + 999 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(2, host_answers(&host, 1));
	TEST_ASSERT_EQUAL_UINT(0, host_answers(&host, 3));
	host_run(&host, bus, begun + 100 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_answers(&host, 1));
	TEST_ASSERT_EQUAL_UINT(0, host_answers(&host, 2));
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, 3));
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, 3)->err);
}

static void test_shares_of_twice_and_never_are_of_all_requests(void)
{
	start("late:seed=9;late=1;twice=100");
	for (uint32_t id = 0; id < 8; id++)
		submit(id, TEMPERATURE);
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(16, host.answers);
	bus_destroy(bus);
	host_init_virtual(&host);
	start("late:seed=9;late=1;never=100");
	for (uint32_t id = 0; id < 8; id++)
		submit(id, TEMPERATURE);
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host.answers);
}

static void test_the_target_goes_and_comes_in_its_turn(void)
{
	start("late:up=200;down=300;late=0");
	host_run(&host, bus, host.now + 1600 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(4, host_events(&host, BUS_UP));
	TEST_ASSERT_EQUAL_UINT(3, host_events(&host, BUS_DOWN));
	submit(1, TEMPERATURE);
	host_run(&host, bus, host.now + 10 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, 1)->err);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 8, host.now + HOST_S));
	submit(2, TEMPERATURE);
	host_run(&host, bus, host.now + 10 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, host_answer(&host, 2)->err);
}

static void test_a_request_not_begun_by_its_deadline_has_no_effect(void)
{
	start("late:");
	submit(1, "/late" TEMPERATURE);
	req[1].deadline_ns = host.now + 500 * HOST_MS;
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-ETIME, host_answer(&host, 1)->err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_answers_come_late_and_out_of_order_but_all);
	RUN_TEST(test_the_same_seed_gives_the_same_order);
	RUN_TEST(test_a_path_says_twice_never_or_late);
	RUN_TEST(test_shares_of_twice_and_never_are_of_all_requests);
	RUN_TEST(test_the_target_goes_and_comes_in_its_turn);
	RUN_TEST(test_a_request_not_begun_by_its_deadline_has_no_effect);
	return UNITY_END();
}
