/* SPDX-License-Identifier: MIT */
/*
 * While nobody runs (a suspend, a stopped process) what was measured before must not become young.
 */
#include <stdlib.h>

#include "unity.h"

#include "hal/wire/link.h"
#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.551DDF030000/temperature12"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
	scene_input(&s, "t1", T1, OWS_DOUBLE);
	scene_put(&s, T1, "        21.5", 0);
	s.bus[0].latency_ns = 50 * SCENE_MS;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 20 * SCENE_MS);
}

void tearDown(void)
{
	scene_end(&s);
}

/* Nobody runs for so long, then the answer that waited meanwhile is taken. */
static void gap(int64_t ns)
{
	struct bus_req *req = s.bus[0].pending[0].req;

	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].pending_count);
	s.bus[0].pending_count = 0;
	s.now_ns += ns;
	scene_answer(&s, req->id, 0, "        21.5", req);
}

static void test_an_answer_that_was_on_its_way_is_as_old_as_its_request(void)
{
	int64_t begun = s.now_ns - 20 * SCENE_MS;

	gap(100 * SCENE_S);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_INT64(begun, scene_sample(&s, 1).measured_ns);
}

static void test_the_next_value_is_of_now(void)
{
	gap(100 * SCENE_S);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_GREATER_THAN_INT64(s.now_ns - SCENE_S, scene_sample(&s, 1).measured_ns);
}

static void test_a_step_that_is_a_little_late_is_no_gap(void)
{
	gap(SCENE_S);
	TEST_ASSERT_EQUAL_INT64(s.now_ns, scene_sample(&s, 1).measured_ns);
}

/* Nobody runs for so long, and the bus has not answered when the engine runs again. */
static struct bus_req *silent_gap(int64_t ns)
{
	s.bus[0].mute = true;
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	s.now_ns += ns;
	scene_run(&s, 100 * SCENE_MS);
	return s.bus[0].swallowed[0];
}

static void test_a_bus_that_did_not_run_either_was_not_silent(void)
{
	struct bus_req *req = silent_gap(100 * SCENE_S);

	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_answer(&s, req->id, 0, "        22.5", req);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "given_up"));
}

static void test_nor_was_it_in_a_stop_that_is_short_but_longer_than_timeout(void)
{
	struct bus_req *req;

	s.config.timeout_ns = 300 * SCENE_MS;
	req = silent_gap(SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	scene_answer(&s, req->id, 0, "        22.5", req);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, scene_number(&s, 1));
	TEST_ASSERT_EQUAL_UINT64(0, scene_counter(&s, "given_up"));
}

static void test_one_that_stays_silent_after_it_is(void)
{
	silent_gap(100 * SCENE_S);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "given_up"));
}

/* A chip that holds what it converted, and a cache that keeps it. */
static void test_a_conversion_is_as_old_as_its_command(void)
{
	static const char wire[] =
		"chip DS2482-100 0x18\nDS2438 26.A0B1C2000026 temperature ramp 20 30 10s\n";
	char data[32];
	struct bus_req req = {.id = 1,
	                      .op = BUS_READ,
	                      .prio = BUS_INPUT,
	                      .data = (uint8_t *)data,
	                      .path = "/26.A0B1C2000026/temperature",
	                      .len = sizeof(data)};
	int64_t gap = 0;

	simulate(wire);
	host_run(&host, bus, host.now + HOST_S);
	/* stopped at any moment of the reading, for longer than the curve lasts */
	for (int64_t ms = 1; ms < 60; ms++) {
		int64_t stopped;

		host.answers = 0;
		req.deadline_ns = host.now + 10000 * HOST_S;
		TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
		host_run(&host, bus, host.now + ms * HOST_MS);
		stopped = host.now;
		gap += host.answers == 0;
		host.now += 100 * HOST_S;
		TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + HOST_S));
		data[host.answer[0].len] = '\0';
		if (strtod(data, NULL) < 29.9)
			TEST_ASSERT_LESS_OR_EQUAL_INT64(stopped, host.answer[0].measured_ns);
		one_bus_end();
		simulate(wire);
		host_run(&host, bus, host.now + HOST_S);
	}
	TEST_ASSERT_GREATER_THAN_INT64(5, gap);
	one_bus_end();
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_answer_that_was_on_its_way_is_as_old_as_its_request);
	RUN_TEST(test_the_next_value_is_of_now);
	RUN_TEST(test_a_step_that_is_a_little_late_is_no_gap);
	RUN_TEST(test_a_bus_that_did_not_run_either_was_not_silent);
	RUN_TEST(test_nor_was_it_in_a_stop_that_is_short_but_longer_than_timeout);
	RUN_TEST(test_one_that_stays_silent_after_it_is);
	RUN_TEST(test_a_conversion_is_as_old_as_its_command);
	return UNITY_END();
}
