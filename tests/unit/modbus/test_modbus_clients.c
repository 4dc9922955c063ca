/* SPDX-License-Identifier: MIT */
/* Tests of connections, over loopback, on a clock of their own where time counts. */
#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/modbus/clients.h"

static struct face face;
static struct clients clients;
static struct config_modbus options;
static int64_t now_ns, came_ns;

#define WIDE 4 /* a function with the longest answer */

/* Each request is answered by itself. */
static size_t answer(void *ctx, const struct client *client, const uint8_t *request,
                     uint8_t bytes[FRAME_MOST])
{
	size_t len = 6u + request[5], more = request[7] == WIDE ? FRAME_MOST - len : 0;

	(void)ctx;
	TEST_ASSERT_TRUE(client->used && client->came_ns <= ows_now());
	came_ns = client->came_ns;
	memcpy(bytes, request, len);
	memset(bytes + len, 0, more);
	return len + more;
}

void setUp(void)
{
	const char *why;

	face = (struct face){.log = log_create(LOG_LEVEL_ERR)};
	clients = (struct clients){.face = &face, .answer = answer};
	options = (struct config_modbus){.given = true, .clients = 4, .address_count = 1};
	TEST_ASSERT_EQUAL_INT(1, listen_parse("127.0.0.1:0", 11, options.addresses, &why));
	now_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(0, clients_open(&clients));
	clients_follow(&clients, &options, now_ns);
}

void tearDown(void)
{
	clients_close(&clients);
	log_destroy(face.log);
}

static void run_clients(void)
{
	struct pollfd ready = {.fd = clients.epoll, .events = POLLIN};

	while (poll(&ready, 1, 20) > 0)
		clients_take(&clients);
}

static void connect_to(int fd)
{
	struct sockaddr_in at;
	socklen_t len = sizeof(at);

	TEST_ASSERT_EQUAL_INT(0,
	                      getsockname(clients.listeners.fds[0], (struct sockaddr *)&at, &len));
	TEST_ASSERT_EQUAL_INT(0, connect(fd, (struct sockaddr *)&at, sizeof(at)));
}

static int join(void)
{
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	connect_to(fd);
	run_clients();
	return fd;
}

static const uint8_t request[] = {0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1};

static void sends(int fd, const void *bytes, size_t n)
{
	TEST_ASSERT_EQUAL_INT((int)n, (int)send(fd, bytes, n, MSG_NOSIGNAL));
	run_clients();
}

/* How many bytes have come; -1: it was closed. */
static int got(int fd)
{
	uint8_t bytes[1024];
	ssize_t n = recv(fd, bytes, sizeof(bytes), MSG_DONTWAIT);

	return n > 0 ? (int)n : n < 0 && errno == EAGAIN ? 0 : -1;
}

static void test_a_request_is_answered_when_it_is_whole(void)
{
	int fd = join();

	TEST_ASSERT_EQUAL_UINT(1, clients.count);
	sends(fd, request, 7);
	TEST_ASSERT_EQUAL_INT(0, got(fd));
	sends(fd, request + 7, 5);
	TEST_ASSERT_EQUAL_INT(sizeof(request), got(fd));
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(sizeof(request), (int)send(fd, request, sizeof(request), 0));
	run_clients();
	TEST_ASSERT_EQUAL_INT(3 * sizeof(request), got(fd));
	TEST_ASSERT_EQUAL_UINT64(4, clients.requests);
	close(fd);
	run_clients();
	TEST_ASSERT_EQUAL_UINT(0, clients.count);
}

static void test_one_that_owes_the_rest_of_a_request_is_closed_and_a_silent_one_is_not(void)
{
	int half = join(), silent = join();
	int64_t due_ns;

	TEST_ASSERT_EQUAL_INT64(INT64_MAX, clients_tick(&clients, now_ns));
	sends(half, request, 7);
	due_ns = clients_tick(&clients, now_ns);
	TEST_ASSERT_INT64_WITHIN(NS_PER_S, now_ns + CLIENTS_LATE_NS, due_ns);
	sends(half, request + 7, 2); /* a little more is no reason to wait longer */
	TEST_ASSERT_EQUAL_INT64(due_ns, clients_tick(&clients, due_ns - 1));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, clients_tick(&clients, due_ns));
	TEST_ASSERT_EQUAL_INT(-1, got(half));
	TEST_ASSERT_EQUAL_INT(0, got(silent));
	clients_tick(&clients, due_ns + 1000 * NS_PER_S);
	TEST_ASSERT_EQUAL_INT(0, got(silent));
	close(half);
	close(silent);
}

static void test_what_is_no_request_closes_the_connection(void)
{
	int fd = join();

	sends(fd, "GET / HTTP/1.0\r\n", 16);
	TEST_ASSERT_EQUAL_INT(-1, got(fd));
	TEST_ASSERT_EQUAL_UINT64(1, clients.refused);
	close(fd);
}

static void test_what_waits_behind_answers_that_are_not_taken_grows_old(void)
{
	static const uint8_t wide[12] = {[5] = 6, [6] = 1, [7] = WIDE};
	const int few = 4096;
	uint8_t many[64 * sizeof(wide)];
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	const struct client *client = clients.places;
	uint64_t sent = 64;
	int64_t sent_ns;

	for (size_t i = 0; i < sizeof(many); i++)
		many[i] = wide[i % sizeof(wide)];
	TEST_ASSERT_EQUAL_INT(0, setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &few, sizeof(few)));
	connect_to(fd);
	run_clients();
	TEST_ASSERT_EQUAL_INT(0, setsockopt(client->fd, SOL_SOCKET, SO_SNDBUF, &few, sizeof(few)));
	for (; !client->out_len && sent < 100000; sent += 64)
		sends(fd, many, sizeof(many));
	TEST_ASSERT_NOT_EQUAL_size_t(0, client->out_len);
	sends(fd, many, sizeof(many));
	sent_ns = ows_now();
	/* the face sees nothing ready as long as the client takes nothing */
	face.came_ns[0] = sent_ns + 1;
	while (got(fd) > 0)
		run_clients();
	TEST_ASSERT_EQUAL_UINT64(sent, clients.requests);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(sent_ns, came_ns);
	close(fd);
}

static void test_a_request_is_as_old_as_its_first_byte(void)
{
	int fd = join();
	int64_t at_ns = ows_now();

	sends(fd, request, 7);
	sends(fd, request + 7, 5);
	TEST_ASSERT_EQUAL_INT(sizeof(request), got(fd));
	TEST_ASSERT_LESS_OR_EQUAL_INT64(at_ns, came_ns);
	/* and one that begins behind another as old as what has brought it */
	sends(fd, request, 7);
	at_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(5, (int)send(fd, request + 7, 5, MSG_NOSIGNAL));
	sends(fd, request, 7);
	sends(fd, request + 7, 5);
	TEST_ASSERT_EQUAL_INT(2 * sizeof(request), got(fd));
	TEST_ASSERT_LESS_OR_EQUAL_INT64(at_ns, came_ns);
	sends(fd, request, sizeof(request));
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(at_ns, came_ns);
	close(fd);
}

static void test_who_waited_behind_many_is_no_younger_for_it(void)
{
	int fds[70];
	int64_t at_ns;

	run_clients();
	at_ns = ows_now();
	for (unsigned i = 0; i < 70; i++) {
		fds[i] = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
		connect_to(fds[i]);
		TEST_ASSERT_EQUAL_INT(sizeof(request),
		                      (int)send(fds[i], request, sizeof(request), 0));
	}
	run_clients();
	TEST_ASSERT_EQUAL_INT(sizeof(request), got(fds[69]));
	TEST_ASSERT_LESS_OR_EQUAL_INT64(at_ns, came_ns);
	for (unsigned i = 0; i < 70; i++)
		close(fds[i]);
}

static void test_of_one_address_the_most_silent_gives_way(void)
{
	int first = join(), second = join(), third;

	sends(first, request, sizeof(request));
	TEST_ASSERT_EQUAL_INT(sizeof(request), got(first));
	third = join();
	TEST_ASSERT_EQUAL_INT(-1, got(second));
	TEST_ASSERT_EQUAL_INT(0, got(first));
	TEST_ASSERT_EQUAL_INT(0, got(third));
	TEST_ASSERT_EQUAL_UINT(2, clients.count);
	close(first);
	close(second);
	close(third);
}

/* No descriptor is left, until RLIMIT_NOFILE is again what is returned. */
static struct rlimit take_descriptors(void)
{
	struct rlimit had, none;
	int fds[2];

	TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &had));
	TEST_ASSERT_EQUAL_INT(0, pipe(fds));
	none = had;
	none.rlim_cur = (rlim_t)fds[0]; /* the numbers below are taken */
	close(fds[0]);
	close(fds[1]);
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &none));
	return had;
}

static void test_without_a_descriptor_the_most_silent_gives_way_too(void)
{
	int first = join(), second = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	struct rlimit had = take_descriptors();

	connect_to(second);
	run_clients();
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &had));
	TEST_ASSERT_EQUAL_INT(-1, got(first));
	TEST_ASSERT_EQUAL_INT(0, got(second));
	TEST_ASSERT_EQUAL_UINT(1, clients.count);
	close(first);
	close(second);
}

static void test_who_waits_for_a_descriptor_is_not_looked_at_without_end(void)
{
	struct pollfd ready = {.fd = clients.epoll, .events = POLLIN};
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	struct rlimit had = take_descriptors();
	int64_t due_ns, sent_ns;

	connect_to(fd);
	TEST_ASSERT_EQUAL_INT(sizeof(request), (int)send(fd, request, sizeof(request), 0));
	sent_ns = ows_now();
	for (unsigned i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL_INT(1, poll(&ready, 1, 1000));
		clients_take(&clients);
		TEST_ASSERT_EQUAL_INT(0, poll(&ready, 1, 20));
		/* nobody is ready, which says nothing of who waits */
		clients_take(&clients);
		face.came_ns[0] = ows_now();
		due_ns = clients_tick(&clients, ows_now());
		TEST_ASSERT_INT64_WITHIN(NS_PER_S, ows_now(), due_ns);
		if (i)
			TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &had));
		TEST_ASSERT_EQUAL_INT64(INT64_MAX, clients_tick(&clients, due_ns));
	}
	run_clients();
	TEST_ASSERT_EQUAL_INT(sizeof(request), got(fd));
	TEST_ASSERT_LESS_OR_EQUAL_INT64(sent_ns, came_ns);
	close(fd);
}

static void test_without_the_block_all_are_closed(void)
{
	int fd = join();

	options = (struct config_modbus){.clients = 4};
	clients_follow(&clients, &options, now_ns);
	TEST_ASSERT_EQUAL_INT(-1, clients.listeners.fds[0]);
	TEST_ASSERT_EQUAL_INT(-1, got(fd));
	close(fd);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_request_is_answered_when_it_is_whole);
	RUN_TEST(test_one_that_owes_the_rest_of_a_request_is_closed_and_a_silent_one_is_not);
	RUN_TEST(test_what_is_no_request_closes_the_connection);
	RUN_TEST(test_what_waits_behind_answers_that_are_not_taken_grows_old);
	RUN_TEST(test_a_request_is_as_old_as_its_first_byte);
	RUN_TEST(test_who_waited_behind_many_is_no_younger_for_it);
	RUN_TEST(test_of_one_address_the_most_silent_gives_way);
	RUN_TEST(test_without_a_descriptor_the_most_silent_gives_way_too);
	RUN_TEST(test_who_waits_for_a_descriptor_is_not_looked_at_without_end);
	RUN_TEST(test_without_the_block_all_are_closed);
	return UNITY_END();
}
