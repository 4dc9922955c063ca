/* SPDX-License-Identifier: MIT */
/* Serial ports on pseudo-terminals: which one a target means, and what a driver does with it. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

void setUp(void)
{
	host_init_real(&host);
	snprintf(folder, sizeof(folder), "/tmp/by-id-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	for (unsigned i = 0; i < 3; i++) {
		adapter[i] = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
		TEST_ASSERT_TRUE(adapter[i] >= 0 && !grantpt(adapter[i]) && !unlockpt(adapter[i]));
	}
	source = (struct serial_source){.ctx = NULL};
	port = NULL;
}

static const char *link_path(const char *link)
{
	static char path[128];

	snprintf(path, sizeof(path), "%s/%s", folder, link);
	return path;
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
	(void)unlink(link_path("one"));
	(void)unlink(link_path("two"));
	TEST_ASSERT_EQUAL_INT(0, rmdir(folder));
}

static void make(const char *where)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, tty_source(where, folder, &source, why, sizeof(why)), why);
}

static int try_open(void)
{
	return source.open(source.ctx, &host.env, &port, name, sizeof(name), why, sizeof(why));
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
	link_to("one", 0);
	link_to("two", 1);
	refused(-EINVAL, "there are 2 serial ports in");
	TEST_ASSERT_EQUAL_INT(0, unlink(link_path("two")));
	TEST_ASSERT_EQUAL_INT(1, source.visible(source.ctx, &mark));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(link_path("one"), name);
}

static void test_an_adapter_that_came_back_as_another_device_is_found_by_what_it_is(void)
{
	char device[64];

	snprintf(device, sizeof(device), "%s", ptsname(adapter[0]));
	link_to("one", 0);
	link_to("two", 1);
	make(device);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(device, name);
	close_port();
	/* the name of the device is another adapter's now */
	link_to("two", 0);
	link_to("one", 2);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
	TEST_ASSERT_EQUAL_STRING(link_path("one"), name);
	TEST_ASSERT_EQUAL_INT(0, port->ops->write(port, (const uint8_t *)"x", 1));
	TEST_ASSERT_EQUAL_INT(1, read(adapter[2], device, 1));
}

static void test_one_that_is_away_is_waited_for_and_no_other_taken(void)
{
	char device[64];
	uint64_t mark;

	snprintf(device, sizeof(device), "%s", ptsname(adapter[0]));
	for (unsigned i = 0; i < 2; i++) {
		link_to("one", 0);
		make(i ? "" : device);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(), why);
		close_port();
		/* another device is the only one, and has the number that it had */
		TEST_ASSERT_EQUAL_INT(0, unlink(link_path("one")));
		link_to("two", 0);
		TEST_ASSERT_EQUAL_INT(0, source.visible(source.ctx, &mark));
		refused(-ENODEV, "/one: is the adapter plugged in?");
		TEST_ASSERT_EQUAL_INT(0, unlink(link_path("two")));
		source.destroy(source.ctx);
		source.ctx = NULL;
	}
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
	port->ops->send_break(port);
	TEST_ASSERT_EQUAL_UINT64(2 * sizeof(bytes), port->bytes);
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
	RUN_TEST(test_two_targets_do_not_share_a_port);
	RUN_TEST(test_bytes_go_both_ways_untouched_and_a_read_has_a_deadline);
	RUN_TEST(test_a_port_that_was_pulled_is_gone);
	return UNITY_END();
}
