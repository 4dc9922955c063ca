/* SPDX-License-Identifier: MIT */
/* Tests of the notifications to the service manager. */
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/notify.h"

static struct notify notify;
static int manager = -1; /* the service manager's end */
static char path[64];
static char received[512];

void setUp(void)
{
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	unsetenv("WATCHDOG_PID");
	notify.fd = -1;
	snprintf(path, sizeof(path), "/tmp/owsd-test-notify.%d", (int)getpid());
}

void tearDown(void)
{
	notify_close(&notify);
	if (manager >= 0)
		close(manager);
	manager = -1;
	unlink(path);
}

/* Bind the manager's socket to a path, or to an abstract name when that begins with @. */
static void listen_on(const char *name)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	size_t len = strlen(name);

	memcpy(address.sun_path, name, len + 1);
	if (name[0] == '@')
		address.sun_path[0] = '\0';
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
	TEST_ASSERT_GREATER_OR_EQUAL(0, manager);
	TEST_ASSERT_EQUAL(0, bind(manager, (struct sockaddr *)&address,
	                          (socklen_t)(offsetof(struct sockaddr_un, sun_path) + len)));
	setenv("NOTIFY_SOCKET", name, 1);
	TEST_ASSERT_EQUAL(0, notify_open(&notify));
}

static const char *told(void)
{
	ssize_t n = recv(manager, received, sizeof(received) - 1, 0);

	received[n < 0 ? 0 : n] = '\0';
	return received;
}

static void test_without_a_socket_nothing_happens(void)
{
	TEST_ASSERT_EQUAL(0, notify_open(&notify));
	TEST_ASSERT_EQUAL(-1, notify.fd);
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_READY));
	TEST_ASSERT_EQUAL(0, notify_status(&notify, "%d", 1));
}

static void test_news_arrive_at_a_path(void)
{
	listen_on(path);
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_READY));
	TEST_ASSERT_EQUAL_STRING("READY=1", told());
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_WATCHDOG));
	TEST_ASSERT_EQUAL_STRING("WATCHDOG=1", told());
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_STOPPING));
	TEST_ASSERT_EQUAL_STRING("STOPPING=1", told());
}

static void test_news_arrive_at_an_abstract_name(void)
{
	char name[64];

	snprintf(name, sizeof(name), "@owsd-test-notify.%d", (int)getpid());
	listen_on(name);
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_READY));
	TEST_ASSERT_EQUAL_STRING("READY=1", told());
}

/* As a manager that loads its units anew, and in a container takes ten datagrams until then. */
static void test_what_is_told_once_waits_for_a_busy_manager_and_the_watchdog_does_not(void)
{
	pid_t busy;
	int status;

	listen_on(path);
	while (!notify_send(&notify, NOTIFY_WATCHDOG))
		;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, notify_send(&notify, NOTIFY_WATCHDOG));
	busy = fork();
	if (busy == 0) {
		bool ready = false, shown = false;

		usleep(300000); /* pace */
		for (int i = 0; i < 500 && !(ready && shown); i++) {
			ready |= strcmp(told(), "READY=1") == 0;
			shown |= strcmp(received, "STATUS=up") == 0;
			usleep(*received ? 0 : 10000); /* pace */
		}
		_exit(ready && shown ? 0 : 1);
	}
	TEST_ASSERT_EQUAL_INT(0, notify_send(&notify, NOTIFY_READY));
	TEST_ASSERT_EQUAL_INT(0, notify_status(&notify, "up"));
	TEST_ASSERT_FALSE(notify.deaf);
	TEST_ASSERT_EQUAL_INT(busy, waitpid(busy, &status, 0));
	TEST_ASSERT_EQUAL_INT(0, status);
}

/* It costs its time once, until it takes something again. */
static void test_a_manager_that_takes_nothing_is_waited_for_once(void)
{
	listen_on(path);
	while (!notify_send(&notify, NOTIFY_WATCHDOG))
		;
	TEST_ASSERT_EQUAL_INT(-EAGAIN, notify_send(&notify, NOTIFY_READY));
	TEST_ASSERT_TRUE(notify.deaf);
	for (int i = 0; i < 1000; i++)
		TEST_ASSERT_EQUAL_INT(-EAGAIN, notify_status(&notify, "%d", i));
	TEST_ASSERT_EQUAL_STRING("WATCHDOG=1", told());
	TEST_ASSERT_EQUAL_INT(0, notify_status(&notify, "again"));
	TEST_ASSERT_FALSE(notify.deaf);
}

static void test_reloading_tells_the_monotonic_time(void)
{
	long long us = 0;

	listen_on(path);
	TEST_ASSERT_EQUAL(0, notify_send(&notify, NOTIFY_RELOADING));
	TEST_ASSERT_EQUAL(1, sscanf(told(), "RELOADING=1\nMONOTONIC_USEC=%lld", &us));
	TEST_ASSERT_TRUE(us > 0);
}

static void test_a_status_cannot_smuggle_other_news_in(void)
{
	listen_on(path);
	TEST_ASSERT_EQUAL(0, notify_status(&notify, "%d signals\nREADY=1", 3));
	TEST_ASSERT_EQUAL_STRING("STATUS=3 signals?READY=1", told());
}

static void test_a_status_is_utf8_wherever_it_is_cut(void)
{
	char big[400] = "";

	for (int i = 0; i < 100; i++)
		strcat(big, "\xe2\x82\xac");
	listen_on(path);
	for (int i = 0; i < 3; i++) {
		TEST_ASSERT_EQUAL(0, notify_status(&notify, "%.*s%s", i, "xx", big));
		TEST_ASSERT_EQUAL(7 + i + (255 - i) / 3 * 3, strlen(told()));
		TEST_ASSERT_NULL(strchr(received, '?'));
	}
	TEST_ASSERT_EQUAL(0, notify_status(&notify, "venkovn\xed"));
	TEST_ASSERT_EQUAL_STRING("STATUS=venkovn?", told());
}

static void test_a_long_status_is_cut(void)
{
	char big[1000];

	memset(big, 'x', sizeof(big) - 1);
	big[sizeof(big) - 1] = '\0';
	listen_on(path);
	TEST_ASSERT_EQUAL(0, notify_status(&notify, "%s", big));
	TEST_ASSERT_EQUAL_size_t(7 + 255, strlen(told()));
}

static void test_a_manager_that_is_gone_is_an_error_and_no_signal(void)
{
	listen_on(path);
	close(manager);
	manager = -1;
	unlink(path);
	TEST_ASSERT_EQUAL(-ENOENT, notify_send(&notify, NOTIFY_READY));
}

static void test_a_socket_name_of_another_kind_is_refused(void)
{
	char big[200];

	setenv("NOTIFY_SOCKET", "vsock:2:1234", 1);
	TEST_ASSERT_EQUAL(-EINVAL, notify_open(&notify));
	setenv("NOTIFY_SOCKET", "/", 1);
	TEST_ASSERT_EQUAL(-EINVAL, notify_open(&notify));
	memset(big, 'x', sizeof(big) - 1);
	big[0] = '/';
	big[sizeof(big) - 1] = '\0';
	setenv("NOTIFY_SOCKET", big, 1);
	TEST_ASSERT_EQUAL(-EINVAL, notify_open(&notify));
	TEST_ASSERT_EQUAL(-1, notify.fd);
}

static int64_t watchdog_of(const char *usec, const char *pid)
{
	int64_t ns;

	setenv("NOTIFY_SOCKET", path, 1);
	setenv("WATCHDOG_USEC", usec, 1);
	if (pid)
		setenv("WATCHDOG_PID", pid, 1);
	else
		unsetenv("WATCHDOG_PID");
	TEST_ASSERT_EQUAL(0, notify_open(&notify));
	ns = notify.watchdog_ns;
	notify_close(&notify);
	return ns;
}

static void test_the_watchdog_is_ours_only_with_our_pid(void)
{
	char self[16];

	snprintf(self, sizeof(self), "%d", (int)getpid());
	TEST_ASSERT_EQUAL_INT64(30000000000, watchdog_of("30000000", NULL));
	TEST_ASSERT_EQUAL_INT64(30000000000, watchdog_of("30000000", self));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("30000000", "1"));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("30000000", "rubbish"));
}

static void test_a_watchdog_time_that_is_no_number_is_none(void)
{
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("", NULL));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("-5", NULL));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("12x", NULL));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("99999999999999999999", NULL));
	TEST_ASSERT_EQUAL_INT64(0, watchdog_of("9223372036854775807", NULL));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_without_a_socket_nothing_happens);
	RUN_TEST(test_news_arrive_at_a_path);
	RUN_TEST(test_news_arrive_at_an_abstract_name);
	RUN_TEST(test_what_is_told_once_waits_for_a_busy_manager_and_the_watchdog_does_not);
	RUN_TEST(test_a_manager_that_takes_nothing_is_waited_for_once);
	RUN_TEST(test_reloading_tells_the_monotonic_time);
	RUN_TEST(test_a_status_cannot_smuggle_other_news_in);
	RUN_TEST(test_a_status_is_utf8_wherever_it_is_cut);
	RUN_TEST(test_a_long_status_is_cut);
	RUN_TEST(test_a_manager_that_is_gone_is_an_error_and_no_signal);
	RUN_TEST(test_a_socket_name_of_another_kind_is_refused);
	RUN_TEST(test_the_watchdog_is_ours_only_with_our_pid);
	RUN_TEST(test_a_watchdog_time_that_is_no_number_is_none);
	return UNITY_END();
}
