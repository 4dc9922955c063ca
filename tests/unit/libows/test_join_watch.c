/* SPDX-License-Identifier: MIT */
/* The descriptor of ows_fd(): what wakes it, and what does not any more. */
#include <poll.h>
#include <stdint.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/libows/join.h"

static struct join join;
static int owsd;

void setUp(void)
{
	int ends[2];

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends));
	join_none(&join);
	join.news = ends[0];
	owsd = ends[1];
	TEST_ASSERT_EQUAL_INT(0, join_watch(&join));
}

void tearDown(void)
{
	join_leave(&join);
	if (owsd >= 0)
		close(owsd);
}

static bool wakes(int ms)
{
	struct pollfd fd = {.fd = join.epoll, .events = POLLIN};

	return poll(&fd, 1, ms) == 1;
}

static void take_tick(void)
{
	uint64_t ticks;

	if (read(join.timer, &ticks, sizeof(ticks)) < 0)
		TEST_ASSERT_FALSE(wakes(0));
}

static void test_news_wake_it_until_they_are_taken(void)
{
	char byte;

	take_tick();
	TEST_ASSERT_EQUAL_INT(1, write(owsd, "x", 1));
	TEST_ASSERT_TRUE(wakes(0));
	TEST_ASSERT_EQUAL_INT(1, read(join.news, &byte, 1));
	take_tick();
	TEST_ASSERT_FALSE(wakes(0));
}

/* A program sleeps on it for as long as it likes, and has to find an owsd that is back. */
static void test_it_wakes_by_itself_when_nothing_comes(void)
{
	TEST_ASSERT_TRUE(wakes(5000));
}

/* A hang-up is readable for ever: whoever polls would not sleep any more. */
static void test_an_owsd_that_has_hung_up_leaves_it_silent(void)
{
	close(owsd);
	owsd = -1;
	TEST_ASSERT_TRUE(wakes(0));
	join_hush(&join);
	TEST_ASSERT_EQUAL_INT(-1, join.news);
	take_tick();
	TEST_ASSERT_FALSE(wakes(0));
	TEST_ASSERT_TRUE(wakes(5000));
}

static void test_the_descriptor_stays_the_same_over_connections(void)
{
	int before = join.epoll;

	join_end(&join);
	TEST_ASSERT_EQUAL_INT(0, join_watch(&join));
	TEST_ASSERT_EQUAL_INT(before, join.epoll);
	join_leave(&join);
	TEST_ASSERT_EQUAL_INT(-1, join.epoll);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_news_wake_it_until_they_are_taken);
	RUN_TEST(test_it_wakes_by_itself_when_nothing_comes);
	RUN_TEST(test_an_owsd_that_has_hung_up_leaves_it_silent);
	RUN_TEST(test_the_descriptor_stays_the_same_over_connections);
	return UNITY_END();
}
