/* SPDX-License-Identifier: MIT */
/* Tests of where a face listens: what is wrong with it is in its status until it is mended. */
#include <arpa/inet.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/kit/listeners.h"
#include "src/faces/kit/loop.h"
#include "src/ground/service/listen.h"

/* 192.0.2.0/24 is for documentation */
static const struct listen_address elsewhere = {.bytes = {192, 0, 2, 7}};
static const struct listen_address anywhere = {.bytes = {127, 0, 0, 1}};
static struct listeners listeners;
static struct face face;
static unsigned served, ended;
static uint16_t port;

static void tell(struct face *of, const struct listen_address *at, bool is_served)
{
	TEST_ASSERT_EQUAL_PTR(&face, of);
	served += is_served;
	ended += !is_served;
	port = at->port;
}

void setUp(void)
{
	face = (struct face){.notify.fd = -1, .log = log_create(LOG_LEVEL_ERR)};
	listeners = (struct listeners){
		.face = &face, .epoll = epoll_create1(EPOLL_CLOEXEC), .tell = tell};
	served = ended = 0;
}

void tearDown(void)
{
	listeners_follow(&listeners, NULL, 0, 0);
	close(listeners.epoll);
	log_destroy(face.log);
}

/* A socket that has the port of *at, which it gets. */
static int take_port(struct listen_address *at)
{
	struct sockaddr_storage to;
	socklen_t len = sizeof(to);
	int fd;

	*at = anywhere;
	listen_sockaddr(at, &to);
	fd = listen_at_address(&to, true, false);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(0, getsockname(fd, (struct sockaddr *)&to, &len));
	at->port = ntohs(((struct sockaddr_in *)&to)->sin_port);
	return fd;
}

static void holds(const char *words)
{
	face_status(&face, "2 clients");
	TEST_ASSERT_EQUAL_STRING_LEN("2 clients", face.status, 9);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(face.status, words), face.status);
}

static void test_a_port_that_is_taken_is_in_the_status_until_it_is_had(void)
{
	struct listen_address at;
	int other = take_port(&at);
	int64_t due_ns;

	listeners_follow(&listeners, &at, 1, 1000);
	TEST_ASSERT_EQUAL_UINT(0, served);
	holds("; cannot listen at 127.0.0.1:");
	TEST_ASSERT_NOT_NULL(strstr(face.shut_remedy, "ss -ltnp"));
	due_ns = listeners_tick(&listeners, 1001);
	TEST_ASSERT_INT64_WITHIN(10 * NS_PER_S, 1000, due_ns);
	listeners_tick(&listeners, due_ns);
	holds("; cannot listen at 127.0.0.1:");
	close(other);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, listeners_tick(&listeners, 3 * due_ns));
	TEST_ASSERT_EQUAL_UINT(1, served);
	TEST_ASSERT_EQUAL_UINT16(at.port, port);
	face_status(&face, "2 clients");
	TEST_ASSERT_EQUAL_STRING("2 clients", face.status);
}

static void test_an_address_that_no_interface_has_is_in_the_status_and_looked_for(void)
{
	const struct listen_address both[] = {anywhere, elsewhere};

	listeners_follow(&listeners, both, 2, 1000);
	TEST_ASSERT_EQUAL_UINT(1, served);
	TEST_ASSERT_NOT_EQUAL(0, port); /* the kernel has chosen it */
	TEST_ASSERT_GREATER_OR_EQUAL(0, listeners.fds[1]);
	holds("; no interface of this machine has 192.0.2.7");
	TEST_ASSERT_NOT_NULL(strstr(face.shut_remedy, "ip addr"));
	TEST_ASSERT_LESS_THAN_INT64(INT64_MAX, listeners_tick(&listeners, 1001));
	/* what the file no longer names is no trouble */
	listeners_follow(&listeners, both, 1, 2000);
	TEST_ASSERT_EQUAL_STRING("", face.shut);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, listeners_tick(&listeners, 2001));
}

static void test_what_stays_in_the_file_stays_open(void)
{
	struct listen_address at[2];
	int first;

	close(take_port(&at[0]));
	close(take_port(&at[1]));
	listeners_follow(&listeners, at, 1, 0);
	first = listeners.fds[0];
	listeners_follow(&listeners, at, 2, 0);
	TEST_ASSERT_EQUAL_INT(first, listeners.fds[0]);
	TEST_ASSERT_EQUAL_UINT(2, served);
	listeners_tell(&listeners);
	TEST_ASSERT_EQUAL_UINT(4, served);
	listeners_follow(&listeners, at + 1, 1, 0);
	TEST_ASSERT_EQUAL_UINT(1, ended);
	TEST_ASSERT_EQUAL_INT(-1, listeners.fds[0]);
	listeners_follow(&listeners, at, 2, 0);
	TEST_ASSERT_GREATER_OR_EQUAL(0, listeners.fds[0]);
}

static void test_a_socket_of_somebody_else_is_kept_whatever_the_file_names(void)
{
	struct listen_address at;
	int fd = take_port(&at);

	TEST_ASSERT_EQUAL(0, listeners_add(&listeners, fd));
	listeners_follow(&listeners, NULL, 0, 0);
	TEST_ASSERT_EQUAL_INT(fd, listeners.fds[0]);
	for (unsigned i = 1; i < LISTENERS; i++)
		TEST_ASSERT_EQUAL(0, listeners_add(&listeners, take_port(&at)));
	TEST_ASSERT_LESS_THAN(0, listeners_add(&listeners, take_port(&at)));
	for (unsigned i = 0; i < LISTENERS; i++)
		close(listeners.fds[i]);
}

static void test_one_loopback_address_is_enough(void)
{
	struct listen_address both[2];
	const char *why;

	TEST_ASSERT_EQUAL_INT(2, listen_parse("localhost:0", 11, both, &why));
	listeners_follow(&listeners, both, 2, 0);
	TEST_ASSERT_EQUAL_STRING("", face.shut);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(1, served);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_port_that_is_taken_is_in_the_status_until_it_is_had);
	RUN_TEST(test_an_address_that_no_interface_has_is_in_the_status_and_looked_for);
	RUN_TEST(test_what_stays_in_the_file_stays_open);
	RUN_TEST(test_a_socket_of_somebody_else_is_kept_whatever_the_file_names);
	RUN_TEST(test_one_loopback_address_is_enough);
	return UNITY_END();
}
