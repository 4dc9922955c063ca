/* SPDX-License-Identifier: MIT */
/* Serial ports on pseudo-terminals: which one a target means, and what a driver does with it. */
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "unity.h"

#include "hal/serial/find.h"
#include "hal/serial/tty.h"
#include "tests/unit/aid/host.h"

static struct host host;
static char folder[64], why[200], name[128];
static int adapter[3]; /* the other ends */
static struct serial_source source;
static struct serial_port *port;
static struct link_master_cost cost;

#define ONE "by-id/one"
#define TWO "by-id/two"
#define HERE "by-path/usb-1"
#define THERE "by-path/usb-2"
static const char *const links[] = {ONE, TWO, HERE, THERE};

static const char *link_path(const char *link)
{
	static char path[128];

	snprintf(path, sizeof(path), "%s/%s", folder, link);
	return path;
}

/* A pseudo-terminal is no line: what it would be asked is kept here, in place of the C library. */
static struct {
	unsigned breaks, ends, flushes;
	int flags;
	bool other_speed;
} asked;

int ioctl(int fd, unsigned long request, ...)
{
	va_list list;

	va_start(list, request);
	void *argument = va_arg(list, void *);
	va_end(list);
	asked.breaks += request == TIOCSBRK;
	asked.ends += request == TIOCCBRK;
	if (request == TIOCGSERIAL)
		memset(argument, 0, sizeof(struct serial_struct));
	if (request == TIOCSSERIAL)
		asked.flags = ((const struct serial_struct *)argument)->flags;
	if (request == TIOCGSERIAL || request == TIOCSSERIAL)
		return 0;
	return (int)syscall(SYS_ioctl, fd, request, argument);
}

int tcflush(int fd, int queue)
{
	asked.flushes += queue == TCIOFLUSH;
	return ioctl(fd, TCFLSH, (void *)(intptr_t)queue);
}

speed_t cfgetospeed(const struct termios *set)
{
	return asked.other_speed ? B1200 : set->c_cflag & CBAUD;
}

void setUp(void)
{
	memset(&asked, 0, sizeof(asked));
	memset(&cost, 0, sizeof(cost));
	host_init_real(&host);
	snprintf(folder, sizeof(folder), "/tmp/by-id-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	TEST_ASSERT_EQUAL_INT(0,
	                      mkdir(link_path("by-id"), 0700) | mkdir(link_path("by-path"), 0700));
	for (unsigned i = 0; i < 3; i++) {
		adapter[i] = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
		TEST_ASSERT_TRUE(adapter[i] >= 0 && !grantpt(adapter[i]) && !unlockpt(adapter[i]));
	}
	source = (struct serial_source){.ctx = NULL};
	port = NULL;
}

static void link_to(const char *link, unsigned n)
{
	(void)unlink(link_path(link));
	TEST_ASSERT_EQUAL_INT(0, symlink(ptsname(adapter[n]), link_path(link)));
}

void tearDown(void)
{
	if (port)
		port->ops->close(port);
	if (source.ctx)
		source.destroy(source.ctx);
	for (unsigned i = 0; i < 3; i++)
		if (adapter[i] >= 0)
			close(adapter[i]);
	for (unsigned i = 0; i < sizeof(links) / sizeof(links[0]); i++)
		(void)unlink(link_path(links[i]));
	TEST_ASSERT_EQUAL_INT(0, rmdir(link_path("by-id")) | rmdir(link_path("by-path")));
	TEST_ASSERT_EQUAL_INT(0, rmdir(folder));
}

static void make(const char *where)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, tty_source(where, folder, &source, why, sizeof(why)), why);
}

static int try_open(void)
{
	int err = source.open(source.ctx, &host.env, &port, name, sizeof(name), why, sizeof(why));

	if (!err)
		port->cost = &cost;
	return err;
}

static void close_port(void)
{
	port->ops->close(port);
	port = NULL;
}

static void refused(int err, const char *text)
{
	TEST_ASSERT_EQUAL_INT(err, try_open());
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, text), why);
}

static void test_a_target_names_a_device_or_nothing(void)
{
	TEST_ASSERT_EQUAL_INT(-EINVAL, tty_source("ttyUSB0", folder, &source, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "expected a device, as /dev/ttyUSB0"));
	make("/dev/null");
	refused(-ENOTTY, "/dev/null is no serial port");
	source.destroy(source.ctx);
	make("/dev/ttyUSB4711");
	refused(-ENODEV, "no /dev/ttyUSB4711: is the adapter plugged in?");
}

static void test_without_a_device_the_only_port_is_taken(void)
{
	uint64_t mark = 0;

	make("");
	refused(-ENODEV, "no serial port in");
	TEST_ASSERT_EQUAL_INT(0, source.visible(source.ctx, &mark));
	link_to(ONE, 0);
	link_to(TWO, 1);
	refused(-EINVAL, "there are several serial ports in");
	TEST_ASSERT_EQUAL_INT(0, unlink(link_path(TWO)));
	TEST_ASSERT_EQUAL_INT(0, symlink("/etc/passwd", link_path(TWO)));
	TEST_ASSERT_EQUAL_INT(1, source.visible(source.ctx, &mark));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(link_path(ONE), name);
}

static void test_an_adapter_that_came_back_as_another_device_is_found_by_what_it_is(void)
{
	char device[64];

	snprintf(device, sizeof(device), "%s", ptsname(adapter[0]));
	link_to(ONE, 0);
	link_to(TWO, 1);
	make(device);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(device, name);
	close_port();
	/* the name of the device is another adapter's now */
	link_to(TWO, 0);
	link_to(ONE, 2);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(link_path(ONE), name);
	TEST_ASSERT_EQUAL_INT(0, port->ops->write(port, (const uint8_t *)"x", 1));
	TEST_ASSERT_EQUAL_INT(1, read(adapter[2], device, 1));
}

static void test_one_that_is_away_is_waited_for_and_no_other_taken(void)
{
	char device[64];
	uint64_t mark;

	snprintf(device, sizeof(device), "%s", ptsname(adapter[0]));
	for (unsigned i = 0; i < 2; i++) {
		link_to(ONE, 0);
		make(i ? "" : device);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
		close_port();
		/* another device is the only one, and has the number that it had */
		TEST_ASSERT_EQUAL_INT(0, unlink(link_path(ONE)));
		link_to(TWO, 0);
		TEST_ASSERT_EQUAL_INT(0, source.visible(source.ctx, &mark));
		refused(-ENODEV, "/one: is the adapter plugged in?");
		TEST_ASSERT_EQUAL_INT(0, unlink(link_path(TWO)));
		source.destroy(source.ctx);
		source.ctx = NULL;
	}
}

static unsigned told(const char *text)
{
	unsigned n = 0;

	for (unsigned i = 0; i < host.events; i++)
		n += host.event[i].news == BUS_NOTE && strstr(host.event[i].text, text);
	return n;
}

static void reopen(void)
{
	close_port();
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
}

static void answers_at(unsigned n)
{
	char byte;

	TEST_ASSERT_EQUAL_INT(0, port->ops->write(port, (const uint8_t *)"x", 1));
	TEST_ASSERT_EQUAL_INT(1, read(adapter[n], &byte, 1));
}

/* One name below by-id is all that they have: it leads to the one that was plugged in last. */
static void test_of_two_equal_adapters_each_is_found_where_it_is(void)
{
	char device[64];

	snprintf(device, sizeof(device), "%s", ptsname(adapter[0]));
	link_to(ONE, 0);
	link_to(HERE, 0);
	link_to(THERE, 1);
	make("");
	refused(-EINVAL, "by-path if two are the same");
	source.destroy(source.ctx);
	make(device);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	/* they come back in the other order */
	link_to(ONE, 0);
	link_to(HERE, 1);
	link_to(THERE, 0);
	reopen();
	TEST_ASSERT_EQUAL_STRING(link_path(HERE), name);
	answers_at(1);
	TEST_ASSERT_EQUAL_UINT(0, told("before"));
}

static void test_an_adapter_that_may_be_another_is_reported_once_with_both_names(void)
{
	link_to(ONE, 0);
	link_to(HERE, 0);
	make("");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	/* an equal one has the name now, in another place */
	link_to(ONE, 1);
	link_to(THERE, 1);
	reopen();
	reopen();
	TEST_ASSERT_EQUAL_UINT(1, told("is usb-2 now, usb-1 before: the same adapter?"));
	close_port();
	source.destroy(source.ctx);
	/* a place that was named, and what is plugged in there */
	link_to(TWO, 0);
	make(link_path(HERE));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	link_to(HERE, 1);
	reopen();
	reopen();
	TEST_ASSERT_EQUAL_UINT(1, told("is one now, two before: the same adapter?"));
}

static void test_two_targets_do_not_share_a_port(void)
{
	struct serial_port *second;
	int holder;

	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	int err = tty_open(ptsname(adapter[0]), &host.env, &second, &holder);
	/* who is no root is kept out by the kernel */
	TEST_ASSERT_TRUE(err == -EADDRINUSE || err == -EBUSY);
	struct serial_port *first = port;

	err = try_open();
	TEST_ASSERT_EQUAL_INT(-EBUSY, err);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "is in use by"), why);
	port = first;
	close_port();
	TEST_ASSERT_EQUAL_INT(0, try_open());
}

/* The thread sleeps over the deadline, and a byte has come when it goes on. */
static int64_t sleep_over(void *ctx)
{
	struct pollfd there = {.events = POLLIN};
	char tty[64];

	(void)ctx;
	for (there.fd = 3; there.fd < 256; there.fd++)
		if (there.fd != adapter[0] && ttyname_r(there.fd, tty, sizeof(tty)) == 0 &&
		    strcmp(tty, ptsname(adapter[0])) == 0)
			break;
	TEST_ASSERT_EQUAL_INT(1, write(adapter[0], "x", 1));
	TEST_ASSERT_EQUAL_INT(1, poll(&there, 1, 10000));
	return HOST_S;
}

static void test_what_came_while_a_busy_machine_let_nobody_look_is_read_after_the_deadline(void)
{
	uint8_t byte = 0;

	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_INT(0, port->ops->speed(port, 115200));
	host.env.now = sleep_over;
	TEST_ASSERT_EQUAL_INT(1, port->ops->read(port, &byte, 1, HOST_S));
	TEST_ASSERT_EQUAL_HEX8('x', byte);
}

static void test_bytes_go_both_ways_untouched_and_a_read_has_a_deadline(void)
{
	static const uint8_t bytes[] = {0x03, 0x0A, 0x0D, 0x11, 0x13, 0x1A, 0x7F, 0xFF, 0x00};
	uint8_t in[16];
	struct termios set;

	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_INT(0, port->ops->speed(port, 9600));
	TEST_ASSERT_EQUAL_INT(0, tcgetattr(adapter[0], &set));
	TEST_ASSERT_EQUAL_UINT(B9600, cfgetospeed(&set));
	TEST_ASSERT_EQUAL_INT(0, port->ops->speed(port, 115200));
	TEST_ASSERT_EQUAL_INT(0, port->ops->write(port, bytes, sizeof(bytes)));
	TEST_ASSERT_EQUAL_INT(sizeof(bytes), read(adapter[0], in, sizeof(in)));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, in, sizeof(bytes));
	TEST_ASSERT_EQUAL_INT(sizeof(bytes), write(adapter[0], bytes, sizeof(bytes)));
	TEST_ASSERT_EQUAL_INT(sizeof(bytes),
	                      port->ops->read(port, in, sizeof(in), host_now(&host) + HOST_S));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, in, sizeof(bytes));
	TEST_ASSERT_EQUAL_INT(0, port->ops->read(port, in, 1, host_now(&host) + HOST_MS));
	TEST_ASSERT_BITS_HIGH(ASYNC_LOW_LATENCY, asked.flags);
	port->ops->send_break(port);
	TEST_ASSERT_EQUAL_UINT(1, asked.breaks);
	TEST_ASSERT_EQUAL_UINT(1, asked.ends);
	asked.other_speed = true;
	TEST_ASSERT_EQUAL_INT(-ENOTTY, port->ops->speed(port, 9600));
	TEST_ASSERT_EQUAL_UINT64(2 * sizeof(bytes), cost.bytes);
}

/* What a program before has left set. */
static void test_a_port_is_set_whatever_it_was_and_is_ours_alone(void)
{
	int flag = 0, other = open(ptsname(adapter[0]), O_RDWR | O_NOCTTY);
	struct termios set;

	TEST_ASSERT_EQUAL_INT(0, tcgetattr(adapter[0], &set));
	set.c_cflag = (set.c_cflag & ~(tcflag_t)(CLOCAL | CREAD)) | CRTSCTS | CSTOPB;
	TEST_ASSERT_EQUAL_INT(0, tcsetattr(adapter[0], TCSANOW, &set));
	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_INT(0, port->ops->speed(port, 9600));
	TEST_ASSERT_EQUAL_INT(0, tcgetattr(adapter[0], &set));
	TEST_ASSERT_EQUAL_UINT(CLOCAL | CREAD | CS8,
	                       set.c_cflag & (tcflag_t)(CLOCAL | CREAD | CRTSCTS | CSTOPB | CS8));
	TEST_ASSERT_EQUAL_INT(0, ioctl(other, TIOCGEXCL, &flag));
	TEST_ASSERT_NOT_EQUAL_INT(0, flag);
	close_port();
	TEST_ASSERT_EQUAL_INT(0, ioctl(other, TIOCGEXCL, &flag));
	TEST_ASSERT_EQUAL_INT(0, flag);
	/* or close() waits for what a stuck adapter does not take */
	TEST_ASSERT_EQUAL_UINT(1, asked.flushes);
	close(other);
}

static void test_a_port_that_takes_nothing_more_is_an_error_in_time(void)
{
	static uint8_t much[100000];
	int64_t begun = host_now(&host);

	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, port->ops->write(port, much, sizeof(much)));
	TEST_ASSERT_GREATER_THAN_INT64(HOST_S, host_now(&host) - begun);
	TEST_ASSERT_GREATER_THAN_UINT64(100, cost.bytes);
}

static void test_no_port_becomes_the_terminal_of_the_process(void)
{
	int status;
	pid_t pid;

	make(ptsname(adapter[0]));
	pid = fork();
	if (pid == 0) {
		bool opened = setsid() > 0 && try_open() == 0;

		_exit(opened && open("/dev/tty", O_RDWR) < 0 ? 0 : 1);
	}
	TEST_ASSERT_EQUAL_INT(pid, waitpid(pid, &status, 0));
	TEST_ASSERT_EQUAL_INT(0, status);
}

static void test_a_port_that_was_pulled_is_gone(void)
{
	uint8_t in;

	make(ptsname(adapter[0]));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	close(adapter[0]);
	adapter[0] = -1;
	TEST_ASSERT_EQUAL_INT(-ENODEV, port->ops->read(port, &in, 1, host_now(&host) + HOST_S));
	TEST_ASSERT_EQUAL_INT(-ENODEV, port->ops->write(port, &in, 1));
	TEST_ASSERT_EQUAL_INT(-ENODEV, port->ops->speed(port, 9600));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_target_names_a_device_or_nothing);
	RUN_TEST(test_without_a_device_the_only_port_is_taken);
	RUN_TEST(test_an_adapter_that_came_back_as_another_device_is_found_by_what_it_is);
	RUN_TEST(test_one_that_is_away_is_waited_for_and_no_other_taken);
	RUN_TEST(test_of_two_equal_adapters_each_is_found_where_it_is);
	RUN_TEST(test_an_adapter_that_may_be_another_is_reported_once_with_both_names);
	RUN_TEST(test_two_targets_do_not_share_a_port);
	RUN_TEST(test_what_came_while_a_busy_machine_let_nobody_look_is_read_after_the_deadline);
	RUN_TEST(test_bytes_go_both_ways_untouched_and_a_read_has_a_deadline);
	RUN_TEST(test_a_port_is_set_whatever_it_was_and_is_ours_alone);
	RUN_TEST(test_a_port_that_takes_nothing_more_is_an_error_in_time);
	RUN_TEST(test_no_port_becomes_the_terminal_of_the_process);
	RUN_TEST(test_a_port_that_was_pulled_is_gone);
	return UNITY_END();
}
