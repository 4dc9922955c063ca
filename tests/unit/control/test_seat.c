/* SPDX-License-Identifier: MIT */
/* The end of a seat: what its state makes of it, and that it counts once. */
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/control/hello.h"
#include "src/memory/control/seat.h"

static struct control control;
static struct control_seat *const seat = control.seats;
static unsigned rung;

static void ring(void *ctx)
{
	(void)ctx;
	rung++;
}

void setUp(void)
{
	rung = 0;
	control = (struct control){.now_ns = 1, .ring = ring};
	*seat = (struct control_seat){
		.fd = -1, .death = -1, .bell = -1, .news = -1, .news_end = -1};
	seat->now = seat->next = (struct control_grant){.memfd = -1, .own = -1};
	control_tally(&control, CONTROL_connections);
}

void tearDown(void)
{
}

static uint64_t counted(enum control_counter what)
{
	return bus_counted(&control.counters[what]);
}

static void test_a_program_that_has_not_joined_leaves_its_seat_free(void)
{
	control_enter(seat, CONTROL_HALF);
	seat_drop(&control, seat, CONTROL_hung_up);
	TEST_ASSERT_EQUAL_INT(CONTROL_FREE, control_state_of(seat));
	TEST_ASSERT_EQUAL_UINT64(0, counted(CONTROL_connections));
	seat_drop(&control, seat, CONTROL_hung_up);
	TEST_ASSERT_EQUAL_UINT64(1, counted(CONTROL_hung_up));
	TEST_ASSERT_EQUAL_UINT(0, rung);
}

static void test_one_that_the_engine_has_leaves_by_the_engine(void)
{
	control_enter(seat, CONTROL_IN);
	seat_died(&control, seat);
	TEST_ASSERT_EQUAL_INT(CONTROL_LEAVING, control_state_of(seat));
	TEST_ASSERT_EQUAL_UINT64(1, counted(CONTROL_died));
	TEST_ASSERT_EQUAL_UINT64(1, counted(CONTROL_connections));
	TEST_ASSERT_EQUAL_UINT(1, rung);
	TEST_ASSERT_EQUAL_UINT32(1, control.changes);
	seat_died(&control, seat);
	TEST_ASSERT_EQUAL_UINT64(1, counted(CONTROL_died));
}

/* As long as the engine's thread takes it nobody else touches what it has. */
static void test_one_that_the_engine_takes_this_moment_goes_later(void)
{
	control_enter(seat, CONTROL_TAKEN);
	seat_drop(&control, seat, CONTROL_hung_up);
	TEST_ASSERT_EQUAL_INT(CONTROL_TAKEN, control_state_of(seat));
	TEST_ASSERT_TRUE(seat->leaves);
}

/* A porter that owsd starts has copies of all that owsd has, until it closes them. */
static void test_the_death_of_who_has_left_is_reported_of_nobody(void)
{
	struct epoll_event event;
	int copy;

	control.epoll = epoll_create1(EPOLL_CLOEXEC);
	control_enter(seat, CONTROL_HALF);
	seat->death = eventfd(0, EFD_CLOEXEC);
	copy = dup(seat->death);
	TEST_ASSERT_EQUAL_INT(0, seat_watch(&control, seat, seat->death, 1));
	TEST_ASSERT_EQUAL_INT(1, epoll_wait(control.epoll, &event, 1, 0));
	seat_drop(&control, seat, CONTROL_hung_up);
	TEST_ASSERT_EQUAL_INT(CONTROL_FREE, control_state_of(seat));
	TEST_ASSERT_EQUAL_INT(0, eventfd_write(copy, 1));
	TEST_ASSERT_EQUAL_INT(0, epoll_wait(control.epoll, &event, 1, 0));
	close(copy);
	close(control.epoll);
}

static void test_a_program_without_a_word_waits_and_one_that_has_gone_does_not(void)
{
	int ends[2];

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends));
	control_enter(seat, CONTROL_HALF);
	seat->fd = ends[0];
	hello_take(&control, seat);
	TEST_ASSERT_EQUAL_INT(CONTROL_HALF, control_state_of(seat));
	seat->fd = -1;
	hello_take(&control, seat);
	TEST_ASSERT_EQUAL_INT(CONTROL_FREE, control_state_of(seat));
	TEST_ASSERT_EQUAL_UINT64(1, counted(CONTROL_hung_up));
	close(ends[0]);
	close(ends[1]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_program_that_has_not_joined_leaves_its_seat_free);
	RUN_TEST(test_one_that_the_engine_has_leaves_by_the_engine);
	RUN_TEST(test_one_that_the_engine_takes_this_moment_goes_later);
	RUN_TEST(test_the_death_of_who_has_left_is_reported_of_nobody);
	RUN_TEST(test_a_program_without_a_word_waits_and_one_that_has_gone_does_not);
	return UNITY_END();
}
