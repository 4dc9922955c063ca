/* SPDX-License-Identifier: MIT */
/* The porter is killed, and started again. */
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/memory/shm/porter.h"

#define TRIES 20000

static struct porter *porter;
static int64_t now_ns;
static int ends[2];

void setUp(void)
{
	now_ns = 100 * NS_PER_S;
	TEST_ASSERT_EQUAL(0, porter_start(&porter));
}

void tearDown(void)
{
	porter_end(porter);
	porter = NULL;
}

static void pause_ms(long ms)
{
	nanosleep(&(struct timespec){.tv_nsec = ms * NS_PER_MS}, NULL); /* the pace of a loop */
}

/* The time of the porter goes on by so much in each round, until it reports something. */
static enum porter_event tend(int64_t step_ns)
{
	enum porter_event event = PORTER_GOES_ON;

	for (int i = 0; i < TRIES && event == PORTER_GOES_ON; i++) {
		event = porter_tend(porter, now_ns);
		now_ns += step_ns;
		pause_ms(1);
	}
	return event;
}

static void kill_porter(void)
{
	TEST_ASSERT_EQUAL(0, kill(porter_process(porter), SIGKILL));
}

/* Send a byte over a connection; return the porter_give(). */
static int order(uint32_t slot)
{
	static char byte = 'x';
	struct porter_order order = {.what = PORTER_SEND | PORTER_HANG_UP,
	                             .count = 1,
	                             .slot = slot,
	                             .bytes = {&byte, 1}};

	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends));
	order.fds[0] = ends[0];
	return porter_give(porter, PORTER_IN, &order);
}

static void arrives(void)
{
	char byte = 0;

	TEST_ASSERT_EQUAL(1, recv(ends[1], &byte, 1, 0));
	TEST_ASSERT_EQUAL('x', byte);
	/* and no other process has it open */
	TEST_ASSERT_EQUAL(0, recv(ends[1], &byte, 1, 0));
	close(ends[1]);
}

static void a_killed_porter_is_started_again(void)
{
	int before = porter_process(porter);

	TEST_ASSERT_EQUAL(0, order(1));
	arrives();
	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	TEST_ASSERT_EQUAL(0, porter_process(porter));
	TEST_ASSERT_EQUAL(PORTER_IS_BACK, tend(NS_PER_MS));
	TEST_ASSERT_NOT_EQUAL(before, porter_process(porter));
	for (int i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL(0, order(1));
		arrives();
	}
	for (int i = 0; i < TRIES && !porter_carried(porter, 1); i++)
		pause_ms(1);
	TEST_ASSERT_TRUE(porter_carried(porter, 1));
}

static void meanwhile_the_caller_carries_out_its_orders(void)
{
	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	TEST_ASSERT_EQUAL(0, order(2));
	arrives();
	TEST_ASSERT_TRUE(porter_carried(porter, 2));
}

static void what_it_had_not_done_when_it_was_killed_is_not_waited_for(void)
{
	TEST_ASSERT_EQUAL(0, kill(porter_process(porter), SIGSTOP));
	TEST_ASSERT_EQUAL(0, order(3));
	close(ends[1]);
	TEST_ASSERT_FALSE(porter_carried(porter, 3));
	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	TEST_ASSERT_TRUE(porter_carried(porter, 3));
	TEST_ASSERT_EQUAL(PORTER_IS_BACK, tend(NS_PER_MS));
	TEST_ASSERT_TRUE(porter_carried(porter, 3));
}

/* The pause before another is forked, in milliseconds. */
static int64_t pause_after_a_kill(void)
{
	int64_t begun_ns;

	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	begun_ns = now_ns;
	while (!porter_process(porter)) {
		now_ns += 100 * NS_PER_MS;
		porter_tend(porter, now_ns);
	}
	return (now_ns - begun_ns) / NS_PER_MS;
}

static void one_that_is_killed_again_and_again_is_started_less_and_less_often(void)
{
	static const int64_t pauses_ms[] = {1000, 2000, 4000, 8000, 16000, 32000, 60000, 60000};

	for (unsigned i = 0; i < sizeof(pauses_ms) / sizeof(*pauses_ms); i++) {
		TEST_ASSERT_EQUAL_INT64(pauses_ms[i], pause_after_a_kill());
		TEST_ASSERT_EQUAL(PORTER_IS_BACK, tend(0));
	}
	now_ns += 61 * NS_PER_S; /* it lived */
	TEST_ASSERT_EQUAL_INT64(1000, pause_after_a_kill());
}

static void one_that_does_not_get_ready_is_killed(void)
{
	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	now_ns += NS_PER_S;
	TEST_ASSERT_EQUAL(PORTER_GOES_ON, porter_tend(porter, now_ns)); /* forks it */
	kill(porter_process(porter), SIGSTOP);
	if (porter_tend(porter, now_ns) == PORTER_IS_BACK)
		TEST_IGNORE_MESSAGE("it was ready sooner than it could be stopped");
	now_ns += 3 * NS_PER_S;
	TEST_ASSERT_EQUAL(PORTER_FAILED, tend(0));
	TEST_ASSERT_EQUAL(PORTER_IS_BACK, tend(100 * NS_PER_MS));
}

static void the_new_one_has_nothing_open_that_it_does_not_need(void)
{
	char byte;
	int pair[2];

	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair));
	kill_porter();
	TEST_ASSERT_EQUAL(PORTER_ENDED, tend(0));
	TEST_ASSERT_EQUAL(PORTER_IS_BACK, tend(NS_PER_MS));
	close(pair[0]);
	TEST_ASSERT_EQUAL(0, recv(pair[1], &byte, 1, MSG_DONTWAIT));
	close(pair[1]);
}

static void it_ends_with_owsd_whoever_has_a_copy_of_its_lanes(void)
{
	pid_t ours = porter_process(porter), other = fork();

	if (other == 0) {
		pause();
		_exit(0);
	}
	porter_end(porter);
	porter = NULL;
	kill(other, SIGKILL);
	waitpid(other, NULL, 0);
	TEST_ASSERT_EQUAL_MESSAGE(-1, waitpid(ours, NULL, WNOHANG), "porter_end() has not had it");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(a_killed_porter_is_started_again);
	RUN_TEST(meanwhile_the_caller_carries_out_its_orders);
	RUN_TEST(what_it_had_not_done_when_it_was_killed_is_not_waited_for);
	RUN_TEST(one_that_is_killed_again_and_again_is_started_less_and_less_often);
	RUN_TEST(one_that_does_not_get_ready_is_killed);
	RUN_TEST(the_new_one_has_nothing_open_that_it_does_not_need);
	RUN_TEST(it_ends_with_owsd_whoever_has_a_copy_of_its_lanes);
	return UNITY_END();
}
