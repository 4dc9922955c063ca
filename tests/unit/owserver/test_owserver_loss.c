/* SPDX-License-Identifier: MIT */
/* The owserver bus when its server is silent, lost, not there or not wanted, and back again. */
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "hal/bus/worker.h"
#include "tests/unit/aid/asleep.h"
#include "tests/unit/aid/owserver_scene.h"

void setUp(void)
{
	owserver_begin();
}

void tearDown(void)
{
	owserver_end();
}

static void test_silence_takes_the_target_down_and_it_comes_back(void)
{
	serve("s");
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT,
	                      request_within(BUS_READ, TEMPERATURE, NULL, 64, 100 * HOST_MS)->err);
	goes_down_with(-ETIMEDOUT, peer.target);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(1, counted("reconnects"));
}

static void test_a_connection_closed_while_idle_is_replaced_unseen(void)
{
	serve("caca");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	until_peer_saw(&peer.closed, 1);
	TEST_ASSERT_EQUAL_INT(0, request(BUS_WRITE, OUTPUT, "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(2, counted("stale_connection"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.writes));
}

static void test_a_read_that_met_a_closing_server_is_repeated_once(void)
{
	serve("axaaxx");
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT64(1, counted("stale_connection"));
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, "closed");
}

static void test_a_write_that_was_sent_is_never_repeated(void)
{
	serve("ax");
	TEST_ASSERT_EQUAL_INT(0, request(BUS_WRITE, OUTPUT, "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, request(BUS_WRITE, OUTPUT, "2", 1)->err);
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.writes));
	goes_down_with(-ECONNRESET, peer.target);
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, request(BUS_WRITE, OUTPUT, "2", 1)->err);
	TEST_ASSERT_EQUAL_UINT(3, peer_saw(&peer.writes));
}

static void test_a_server_lost_in_the_middle_of_an_answer_is_down(void)
{
	serve("am");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, "closed");
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static void test_the_answer_comes_before_the_news_of_the_loss(void)
{
	struct bus_req req = {.id = 9,
	                      .op = BUS_READ,
	                      .path = TEMPERATURE,
	                      .data = room,
	                      .len = 64,
	                      .deadline_ns = host_now(&host) + PATIENCE};

	serve("m");
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	while (host.answers == 0) {
		TEST_ASSERT_EQUAL_UINT(1, host.events);
		bus_step(bus, host_now(&host));
	}
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	bus_step(bus, host_now(&host));
	TEST_ASSERT_EQUAL_UINT(2, host.events);
}

static void test_a_reset_is_a_loss(void)
{
	serve("RR");
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, peer.target);
}

static void test_a_target_that_is_not_there_is_tried_for_ever_and_told_once(void)
{
	unsigned open_before;

	peer_start(&peer, AF_INET, "");
	peer_stop(&peer);
	bus = host_bus(&host, peer.target);
	open_before = descriptors();
	goes_down_with(-ECONNREFUSED, "refused");
	host_run(&host, bus, host_now(&host) + 700 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT(open_before, descriptors());
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	peer_restart(&peer, "");
	is_peer_up = true;
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(0, counted("reconnects"));
}

/* As of a port that another program has taken: "connection refused" is no longer true. */
static void test_what_answers_in_the_place_of_one_that_was_not_there_is_told(void)
{
	struct pollfd there = {.events = POLLIN};
	int64_t until = host_now(&host) + PATIENCE;
	int fd = -1;

	peer_start(&peer, AF_INET, "");
	peer_stop(&peer);
	bus = host_bus(&host, peer.target);
	goes_down_with(-ECONNREFUSED, "refused");
	there.fd = peer.hold_fd;
	TEST_ASSERT_EQUAL_INT(0, listen(peer.hold_fd, 8));
	while (host.events < 2 && host_now(&host) < until) {
		host_run(&host, bus, host_now(&host) + 10 * HOST_MS);
		if (poll(&there, 1, 0) <= 0)
			continue;
		if (fd >= 0)
			close(fd);
		fd = accept(peer.hold_fd, NULL, NULL);
		TEST_ASSERT_EQUAL_INT(24, send(fd, "HTTP/1.1 400 Bad Request", 24, MSG_NOSIGNAL));
	}
	if (fd >= 0)
		close(fd);
	TEST_ASSERT_EQUAL_UINT(2, host.events);
	TEST_ASSERT_EQUAL_UINT8(BUS_DOWN, host.event[1].news);
	TEST_ASSERT_EQUAL_INT32_MESSAGE(-EPROTO, host.event[1].err, host.event[1].text);
	/* and it goes in turn */
	peer_end(&peer);
	goes_down_with(-ECONNREFUSED, "refused");
}

static void test_a_server_that_goes_while_idle_is_noticed(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	stop_peer();
	goes_down_with(-ECONNRESET, "refused");
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
}

/* Nobody serves the connection: such a one the kernel makes, too, while a server goes. */
static void test_a_server_that_closes_and_then_only_listens_is_noticed(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	peer_leave(&peer);
	goes_down_with(-ETIMEDOUT, peer.target);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
}

static void test_an_idle_bus_has_nothing_to_do_until_its_server_closes(void)
{
	struct pollfd watched = {.events = POLLIN};

	serve("ac");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, bus_step(bus, host_now(&host)));
	watched.fd = bus_watch(bus);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, watched.fd);
	TEST_ASSERT_EQUAL_INT(0, poll(&watched, 1, 0));
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	/* the host watches the descriptor meanwhile */
	until_peer_saw(&peer.closed, 1);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, bus_step(bus, host_now(&host)));
	TEST_ASSERT_EQUAL_UINT64(1, counted("stale_connection"));
	TEST_ASSERT_EQUAL_UINT64(2, counted("connections"));
	/* it is connected again, and waits */
	watched.fd = bus_watch(bus);
	TEST_ASSERT_EQUAL_INT(0, poll(&watched, 1, 0));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_INT(-1, bus_watch(bus));
}

static bool worker_says(struct worker *worker, enum bus_news news)
{
	const struct worker_message *message;

	for (int64_t until = host_now(&host) + PATIENCE; host_now(&host) < until;
	     usleep(1000)) /* pace */
		while ((message = worker_next(worker)))
			if (message->is_event && message->event.news == news)
				return true;
	return false;
}

static void test_a_worker_that_sleeps_notices_that_the_server_goes(void)
{
	struct worker *worker;
	char why[200] = "";
	bool up, down;

	peer_start(&peer, AF_INET, "");
	is_peer_up = true;
	TEST_ASSERT_EQUAL_INT(0, worker_create(peer.target, "bus-under-test", NULL, NULL, &worker,
	                                       why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, worker_start(worker));
	up = worker_says(worker, BUS_UP);
	until_asleep("bus-under-test");
	stop_peer();
	down = worker_says(worker, BUS_DOWN);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker, PATIENCE));
	worker_destroy(worker);
	TEST_ASSERT_TRUE(up);
	TEST_ASSERT_TRUE(down);
}

static void test_an_unknown_name_says_so(void)
{
	bus = host_bus(&host, "no-such-host.invalid:4304");
	goes_down_with(-ENOTCONN, "no-such-host.invalid");
}

static void test_shutdown_ends_a_request_at_once(void)
{
	struct bus_req req = {.id = 9,
	                      .op = BUS_READ,
	                      .path = TEMPERATURE,
	                      .data = room,
	                      .len = 64,
	                      .deadline_ns = INT64_MAX};

	serve("s");
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	host.shutdown = true;
	bus_step(bus, host_now(&host));
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, host_answer(&host, 9)->err);
}

static void test_a_suspended_bus_lets_go_of_the_connection(void)
{
	unsigned open_before;

	serve("");
	open_before = descriptors();
	bus_suspend(bus, true);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(open_before - 1, descriptors());
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	bus_suspend(bus, false);
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static unsigned backs_within(int64_t time_ns)
{
	host_run(&host, bus, host_now(&host) + time_ns);
	return host_events(&host, BUS_BACK);
}

static void test_a_suspended_bus_sees_when_the_server_is_back(void)
{
	unsigned open_before;

	serve("");
	stop_peer();
	bus_suspend(bus, true);
	open_before = descriptors();
	TEST_ASSERT_EQUAL_UINT(0, backs_within(300 * HOST_MS));
	peer_restart(&peer, "");
	is_peer_up = true;
	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_BACK));
	TEST_ASSERT_EQUAL_UINT(0, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	stop_peer();
	TEST_ASSERT_EQUAL_UINT(open_before, descriptors());
}

static void test_a_server_that_hangs_is_not_back(void)
{
	int fd = socket(AF_INET, SOCK_STREAM, 0);
	struct sockaddr_in address = {.sin_family = AF_INET,
	                              .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t len = sizeof(address);
	char target[32];

	TEST_ASSERT_EQUAL_INT(0, bind(fd, (struct sockaddr *)&address, len));
	TEST_ASSERT_EQUAL_INT(0, listen(fd, 4));
	TEST_ASSERT_EQUAL_INT(0, getsockname(fd, (struct sockaddr *)&address, &len));
	snprintf(target, sizeof(target), "127.0.0.1:%d", ntohs(address.sin_port));
	bus = host_bus(&host, target);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(0, backs_within(400 * HOST_MS));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	close(fd);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_silence_takes_the_target_down_and_it_comes_back);
	RUN_TEST(test_a_connection_closed_while_idle_is_replaced_unseen);
	RUN_TEST(test_a_read_that_met_a_closing_server_is_repeated_once);
	RUN_TEST(test_a_write_that_was_sent_is_never_repeated);
	RUN_TEST(test_a_server_lost_in_the_middle_of_an_answer_is_down);
	RUN_TEST(test_the_answer_comes_before_the_news_of_the_loss);
	RUN_TEST(test_a_reset_is_a_loss);
	RUN_TEST(test_a_target_that_is_not_there_is_tried_for_ever_and_told_once);
	RUN_TEST(test_what_answers_in_the_place_of_one_that_was_not_there_is_told);
	RUN_TEST(test_a_server_that_goes_while_idle_is_noticed);
	RUN_TEST(test_a_server_that_closes_and_then_only_listens_is_noticed);
	RUN_TEST(test_an_idle_bus_has_nothing_to_do_until_its_server_closes);
	RUN_TEST(test_a_worker_that_sleeps_notices_that_the_server_goes);
	RUN_TEST(test_an_unknown_name_says_so);
	RUN_TEST(test_shutdown_ends_a_request_at_once);
	RUN_TEST(test_a_suspended_bus_lets_go_of_the_connection);
	RUN_TEST(test_a_suspended_bus_sees_when_the_server_is_back);
	RUN_TEST(test_a_server_that_hangs_is_not_back);
	return UNITY_END();
}
