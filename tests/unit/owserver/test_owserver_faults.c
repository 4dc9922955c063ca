/* SPDX-License-Identifier: MIT */
/* The owserver bus beside a server that answers wrongly: garbage, pieces, too much, too late. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/owserver_scene.h"

void setUp(void)
{
	owserver_begin();
}

void tearDown(void)
{
	owserver_end();
}

static void test_a_reply_in_single_bytes_is_read(void)
{
	serve("ff");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static void test_keep_alives_are_passed_over(void)
{
	serve("kka");
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(6, counted("keepalives"));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
}

static void test_keep_alives_do_not_extend_the_deadline_and_the_target_stays_up(void)
{
	int64_t begun;

	serve("K");
	begun = host_now(&host);
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS,
	                      request_within(BUS_READ, TEMPERATURE, NULL, 64, ENOUGH)->err);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(begun + ENOUGH, host_now(&host));
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT64(1, counted("timeouts"));
}

static void test_half_an_answer_is_a_sign_of_life_too(void)
{
	serve("d");
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS,
	                      request_within(BUS_READ, TEMPERATURE, NULL, 64, ENOUGH)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_refused_persistence_is_no_failure(void)
{
	serve("rrrr");
	for (unsigned i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(4, counted("refused_persistence"));
	TEST_ASSERT_EQUAL_UINT(5, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_HEX32(0x24, peer.flags);
}

static void test_an_answer_that_came_twice_does_not_pass_for_the_next(void)
{
	serve("aD");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	peer_repeat(&peer);
	until_peer_saw(&peer.done, 2);
	TEST_ASSERT_EQUAL_INT(0, request(BUS_READ, "/28.67C6697351FF/type", NULL, 64)->err);
	TEST_ASSERT_EQUAL_MEMORY("DS18B20", room, 7);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void is_garbage(const char *plan)
{
	serve(plan);
	TEST_ASSERT_EQUAL_INT_MESSAGE(-EPROTO, read_temperature(), plan);
	goes_down_with(-EPROTO, peer.target);
	TEST_ASSERT_EQUAL_UINT64(1, counted("garbage"));
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	one_bus_end();
	stop_peer();
	peer_end(&peer);
	host_init_real(&host);
}

static void test_garbage_of_each_kind_takes_the_target_down(void)
{
	is_garbage("g");
	is_garbage("h");
	is_garbage("n");
	is_garbage("v");
	is_garbage("w");
	is_garbage("W");
	is_garbage("l");
	is_garbage("t");
}

static void test_any_mixture_of_faults_ends_in_one_answer_each_and_no_leak(void)
{
	static const char letters[] = "aaaafkrcxRmdshgnvwWlt";
	const unsigned seed = 1963;
	char plan[61];
	unsigned open_before;

	srand(seed);
	for (unsigned i = 0; i < sizeof(plan) - 1; i++)
		plan[i] = letters[(size_t)rand() % (sizeof(letters) - 1)];
	plan[sizeof(plan) - 1] = '\0';
	serve(plan);
	open_before = descriptors();
	for (unsigned i = 0; i < 40; i++) {
		int err = request_within(i % 3 ? BUS_READ : BUS_WRITE, i % 3 ? TEMPERATURE : OUTPUT,
		                         i % 3 ? NULL : "1", i % 3 ? 64 : 1, 60 * HOST_MS)
		                  ->err;

		TEST_ASSERT_TRUE_MESSAGE(err == 0 || err == -EINPROGRESS || err == -ETIMEDOUT ||
		                                 err == -ECONNRESET || err == -EPROTO ||
		                                 err == -ENOTCONN || err == -ETIME,
		                         plan);
		if (err == -ENOTCONN)
			host_run_events(&host, bus, host.events + 1,
			                host_now(&host) + 500 * HOST_MS);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(open_before + 1, descriptors(), plan);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reply_in_single_bytes_is_read);
	RUN_TEST(test_keep_alives_are_passed_over);
	RUN_TEST(test_keep_alives_do_not_extend_the_deadline_and_the_target_stays_up);
	RUN_TEST(test_half_an_answer_is_a_sign_of_life_too);
	RUN_TEST(test_refused_persistence_is_no_failure);
	RUN_TEST(test_an_answer_that_came_twice_does_not_pass_for_the_next);
	RUN_TEST(test_garbage_of_each_kind_takes_the_target_down);
	RUN_TEST(test_any_mixture_of_faults_ends_in_one_answer_each_and_no_leak);
	return UNITY_END();
}
