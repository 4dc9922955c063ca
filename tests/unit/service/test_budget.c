/* SPDX-License-Identifier: MIT */
/* What a connection may cost in the calls that send over it. */
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/ground/service/budget.h"

#define SLOW_NS (3 * NS_PER_MS)
#define WATCHES 40000
#define COPIES 100

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_calls_within_their_allowance_cost_nothing(void)
{
	struct budget b = {0};

	for (int i = 0; i < 100000; i++)
		TEST_ASSERT_TRUE(budget_spend(&b, i, budget_allowance(65536), 65536));
	TEST_ASSERT_EQUAL_INT64(0, b.spent_ns);
}

static void test_slow_calls_use_the_credit_up(void)
{
	struct budget b = {0};
	unsigned calls = 1;

	while (calls < 100 && budget_spend(&b, 0, SLOW_NS, 100))
		calls++;
	TEST_ASSERT_EQUAL(BUDGET_CREDIT_NS / (SLOW_NS - budget_allowance(100)) + 1, calls);
	TEST_ASSERT_TRUE(b.over);
	/* for good */
	TEST_ASSERT_FALSE(budget_spend(&b, 3600 * NS_PER_S, 0, 0));
}

static void test_a_slow_call_now_and_then_is_forgiven(void)
{
	struct budget b = {0};

	for (int64_t i = 0; i < 1000; i++)
		TEST_ASSERT_TRUE(budget_spend(&b, i * BUDGET_PACE * SLOW_NS, SLOW_NS, 100));
	TEST_ASSERT_FALSE(b.over);
}

static void test_a_pause_of_the_machine_in_one_call_ends_no_connection(void)
{
	struct budget b = {0};
	int64_t now_ns = 0;

	for (int i = 0; i < 10; i++, now_ns += BUDGET_PACE * BUDGET_CREDIT_NS)
		TEST_ASSERT_TRUE(budget_spend(&b, now_ns, NS_PER_S, 100));
	/* in three calls it is none */
	TEST_ASSERT_TRUE(budget_spend(&b, now_ns, NS_PER_S, 100));
	TEST_ASSERT_TRUE(budget_spend(&b, now_ns, NS_PER_S, 100));
	TEST_ASSERT_FALSE(budget_spend(&b, now_ns, NS_PER_S, 100));
}

static unsigned watch(int fd, unsigned watches)
{
	struct epoll_event event = {.events = EPOLLIN};
	int copies[COPIES];
	unsigned done = 0;

	for (unsigned i = 0; i < COPIES; i++)
		copies[i] = dup(fd);
	while (done < watches) {
		int epoll = epoll_create1(EPOLL_CLOEXEC);

		for (unsigned i = 0; epoll >= 0 && i < COPIES && done < watches; i++, done++)
			if (epoll_ctl(epoll, EPOLL_CTL_ADD, copies[i], &event))
				return done;
		if (epoll < 0)
			break;
	}
	return done;
}

/* Send and have it received until the budget is over; the times it was not. */
static unsigned send_bytes(const int *ends, struct budget *b, unsigned most)
{
	unsigned times = 0;
	bool goes_on = true;

	while (goes_on && times < most) {
		struct budget_call call;
		char byte = 0;

		budget_begin(b, &call);
		TEST_ASSERT_EQUAL(1, send(ends[0], &byte, 1, 0));
		goes_on = budget_end(b, &call, 1);
		TEST_ASSERT_EQUAL(1, recv(ends[1], &byte, 1, 0));
		times += goes_on;
	}
	return times;
}

static void test_a_peer_without_watches_is_sent_to_for_ever(void)
{
	struct budget b = {0};
	int ends[2];

	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends));
	TEST_ASSERT_EQUAL(20000, send_bytes(ends, &b, 20000));
	close(ends[0]);
	close(ends[1]);
}

static void test_a_peer_that_has_its_end_watched_very_often_is_found(void)
{
	struct budget b = {0};
	struct rlimit files;
	int ends[2];

	getrlimit(RLIMIT_NOFILE, &files);
	files.rlim_cur = files.rlim_max;
	setrlimit(RLIMIT_NOFILE, &files);
	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends));
	if (watch(ends[1], WATCHES) < WATCHES)
		TEST_IGNORE_MESSAGE("this user may have too few descriptors or watches");
	TEST_ASSERT_LESS_THAN(2000, send_bytes(ends, &b, 2000));
	TEST_ASSERT_TRUE(b.over);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_calls_within_their_allowance_cost_nothing);
	RUN_TEST(test_slow_calls_use_the_credit_up);
	RUN_TEST(test_a_slow_call_now_and_then_is_forgiven);
	RUN_TEST(test_a_pause_of_the_machine_in_one_call_ends_no_connection);
	RUN_TEST(test_a_peer_without_watches_is_sent_to_for_ever);
	RUN_TEST(test_a_peer_that_has_its_end_watched_very_often_is_found);
	return UNITY_END();
}
