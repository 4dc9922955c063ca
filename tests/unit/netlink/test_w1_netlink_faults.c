/* SPDX-License-Identifier: MIT */
/* The target w1:netlink: what goes wrong, and what serves then. */
#include <errno.h>
#include <string.h>
#include <sys/socket.h>

#include "hal/bus/backends.h"
#include "hal/native/state.h"
#include "hal/netlink/talk.h"
#include "unity.h"

#include "tests/unit/aid/netlink_scene.h"

void setUp(void)
{
	nl_begin();
}

void tearDown(void)
{
	nl_end();
}

static void test_a_device_that_goes_is_no_device(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625), *other = nl_thermometer(0, 2, 5);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	sim_wire_plug(&wire_net.wire[0], warm, false, nl.host.now);
	TEST_ASSERT_EQUAL_INT(-ENODEV, nl_read(warm, "temperature"));
	nl_reads(other, "temperature", "           5");
	sim_wire_plug(&wire_net.wire[0], other, false, nl.host.now);
	TEST_ASSERT_EQUAL_INT(-ENODEV, nl_read(other, "temperature"));
	TEST_ASSERT_EQUAL_UINT(2, host_events(&nl.host, BUS_LOST));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&nl.host, BUS_DOWN));
	sim_wire_plug(&wire_net.wire[0], warm, true, nl.host.now);
	host_run(&nl.host, nl.bus, nl.host.now + 6 * HOST_S);
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_a_lost_reply_is_asked_for_again(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	int64_t before = nl.host.now;
	w1_core.silent = 1;
	nl_reads(warm, "templow", "          70");
	TEST_ASSERT_GREATER_THAN_INT64(before + 14 * HOST_S, nl.host.now);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&nl.host, BUS_DOWN));
}

static void test_a_late_reply_is_not_taken_for_another(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625), *other = nl_thermometer(0, 2, 5);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	nl_reads(other, "temperature", "           5");
	w1_core.late = 1;
	nl_reads(warm, "latesttemp", "     21.0625");
	w1_core.late = 1;
	nl_reads(other, "latesttemp", "           5");
}

static void test_replies_that_make_no_sense_are_an_error(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	w1_core.garbage = 1;
	nl_reads(warm, "templow", "          70");
	w1_core.refuses = 1;
	nl_reads(warm, "temphigh", "          75");
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(2, ((struct native *)nl.bus)->count[COUNT_LINK_ERRORS]);
	w1_core.garbage = 1000;
	TEST_ASSERT_NOT_EQUAL_INT(0, nl_read(warm, "templow"));
	w1_core.garbage = 0;
	host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_a_changed_byte_makes_no_false_value(void)
{
	unsigned right = 0;

	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	w1_core.seed = 1;
	for (int i = 0; i < 400; i++) {
		w1_core.scrambles = 1;
		int err = nl_read(warm, "latesttemp");
		if (!err)
			TEST_ASSERT_EQUAL_STRING("     21.0625", (char *)nl.data);
		right += !err;
		w1_core.scrambles = 0;
		if (err)
			host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
		nl.host.events = 0;
	}
	TEST_ASSERT_GREATER_THAN_UINT(350, right);
}

static void test_a_socket_that_ends_is_opened_again(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	unsigned sockets = w1_core.sockets;
	TEST_ASSERT_EQUAL_INT(0, shutdown(w1_core.fd, SHUT_RDWR));
	nl_read(warm, "temperature");
	host_run(&nl.host, nl.bus, nl.host.now + 30 * HOST_S);
	TEST_ASSERT_GREATER_THAN_UINT(sockets, w1_core.sockets);
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_a_module_that_is_unloaded_takes_the_target_down(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	int64_t before = nl.host.now;
	w1_core.masters = 0;
	nl_erase("w1_bus_master1");
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, nl_read(warm, "templow"));
	TEST_ASSERT_LESS_THAN_INT64(before + 6 * HOST_S, nl.host.now);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&nl.host, BUS_DOWN));
	w1_core.masters = 1;
	nl_sysfs_master(1);
	host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&nl.host, BUS_UP));
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_one_of_two_masters_that_goes_leaves_the_other(void)
{
	nl_masters(2);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625),
			 *cold = nl_thermometer(1, 2, -10.125);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	nl_reads(cold, "temperature", "     -10.125");
	w1_core.gone = 2;
	TEST_ASSERT_EQUAL_INT(-ENODEV, nl_read(cold, "temperature"));
	nl_reads(warm, "temperature", "     21.0625");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&nl.host, BUS_DOWN));
	w1_core.gone = 0;
	host_run(&nl.host, nl.bus, nl.host.now + 6 * HOST_S);
	nl_reads(cold, "temperature", "     -10.125");
}

static void test_a_master_that_comes_later_is_one_more_bus(void)
{
	nl_masters(1);
	nl_thermometer(0, 1, 21.0625);
	nl_start();
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	wire_net.channels = w1_core.masters = 2;
	struct sim_slave *cold = nl_thermometer(1, 2, -10.125);
	host_run(&nl.host, nl.bus, nl.host.now + 6 * HOST_S);
	nl_reads(cold, "temperature", "     -10.125");
	nl_lists("/bus.1", "/bus.1/28.02005DDF0300\n/bus.1/interface\n/bus.1/simultaneous\n"
	                   "/bus.1/alarm\n");
}

static void test_a_suspended_target_has_no_socket(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	unsigned sockets = w1_core.sockets;
	bus_suspend(nl.bus, true);
	TEST_ASSERT_EQUAL_INT(0, (int)recv(w1_core.fd, nl.data, sizeof(nl.data), 0));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, nl_read(warm, "temperature"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&nl.host, BUS_RELEASED));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&nl.host, BUS_BACK));
	nl_erase("w1_bus_master1");
	host_run(&nl.host, nl.bus, nl.host.now + 5 * HOST_S);
	nl_sysfs_master(1);
	host_run(&nl.host, nl.bus, nl.host.now + 5 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&nl.host, BUS_BACK));
	TEST_ASSERT_EQUAL_UINT(sockets, w1_core.sockets);
	bus_suspend(nl.bus, false);
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(sockets + 1, w1_core.sockets);
	nl_reads(warm, "temperature", "     21.0625");
}

/* --- Refused --- */

static void test_files_serve_where_netlink_is_refused(void)
{
	static const struct {
		int err;
		const char *why;
	} refusals[] = {
		{-EPERM, "no right"},
		{-EACCES, "no right"},
		{-EAFNOSUPPORT, "RestrictAddressFamilies"},
		{-EPROTONOSUPPORT, "CONFIG_CONNECTOR"},
		{-ECONNREFUSED, "network namespace"},
	};

	for (size_t i = 0; i < sizeof(refusals) / sizeof(refusals[0]); i++) {
		nl_masters(1);
		nl.host.events = 0;
		w1_core.socket_error = refusals[i].err;
		nl_create("");
		nl_lists("/bus.0", "/bus.0/interface\n/bus.0/simultaneous\n/bus.0/alarm\n");
		TEST_ASSERT_TRUE_MESSAGE(nl_told(BUS_NOTE, refusals[i].why), refusals[i].why);
		TEST_ASSERT_TRUE(nl_told(BUS_NOTE, "served by files as target w1"));
		TEST_ASSERT_EQUAL_UINT(1, host_events(&nl.host, BUS_NOTE));
		TEST_ASSERT_EQUAL_INT(
			0, nl_ask(BUS_READ, "/bus.0/interface/settings/name", NULL)->err);
		TEST_ASSERT_EQUAL_STRING("w1", (char *)nl.data);
		nl_close();
	}
}

static void test_a_passing_fault_is_no_refusal(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	w1_core.socket_error = -EMFILE;
	nl_create("");
	host_run(&nl.host, nl.bus, nl.host.now + HOST_S);
	TEST_ASSERT_TRUE(nl_told(BUS_DOWN, "Too many open files"));
	w1_core.socket_error = 0;
	host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
	nl_reads(warm, "temperature", "     21.0625");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&nl.host, BUS_NOTE));
}

static void test_files_serve_where_the_kernel_does_not_answer(void)
{
	nl_masters(1);
	w1_core.masters = 0;
	nl_create("");
	nl_lists("/bus.0", "/bus.0/interface\n/bus.0/simultaneous\n/bus.0/alarm\n");
	TEST_ASSERT_TRUE(nl_told(BUS_NOTE, "CONFIG_W1_CON"));
}

static void test_one_lost_answer_at_the_start_is_no_refusal(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	w1_core.silent = 1;
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	TEST_ASSERT_FALSE(nl_told(BUS_NOTE, "served by files"));
}

/* A kernel that has answered can: silence when the target is opened again is a passing fault. */
static void test_a_kernel_that_has_answered_is_asked_again_by_netlink(void)
{
	nl_masters(1);
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	nl_start();
	nl_reads(warm, "temperature", "     21.0625");
	bus_suspend(nl.bus, true);
	w1_core.silent = 2;
	bus_suspend(nl.bus, false);
	host_run(&nl.host, nl.bus, nl.host.now + 60 * HOST_S);
	TEST_ASSERT_FALSE(nl_told(BUS_NOTE, "served by files"));
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_without_a_master_the_target_is_down_until_one_comes(void)
{
	nl_masters(0);
	nl_create("");
	host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, nl.host.events);
	TEST_ASSERT_TRUE(nl_told(BUS_DOWN, "modprobe"));
	TEST_ASSERT_EQUAL_UINT(0, w1_core.sockets);
	w1_core.masters = 1;
	nl_sysfs_master(1);
	wire_net.channels = 1;
	struct sim_slave *warm = nl_thermometer(0, 1, 21.0625);
	host_run(&nl.host, nl.bus, nl.host.now + 10 * HOST_S);
	nl_reads(warm, "temperature", "     21.0625");
}

static void test_a_target_is_followed_by_what_w1_takes(void)
{
	static const char *const wrong[] = {"w1:netlinks", "w1:netlink/x",
	                                    "w1:netlink/w1_bus_master0", "w1:netlink/root=here"};
	struct bus *none = NULL;
	char why[200];

	nl_masters(1);
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, bus_create(wrong[i], &nl.host.env, &none, why, sizeof(why)),
			wrong[i]);
	nl.bus = host_bus(&nl.host, "w1:netlink/w1_bus_master2");
	nl_close();
	nl.bus = host_bus(&nl.host, "w1:netlink");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_that_goes_is_no_device);
	RUN_TEST(test_a_lost_reply_is_asked_for_again);
	RUN_TEST(test_a_late_reply_is_not_taken_for_another);
	RUN_TEST(test_replies_that_make_no_sense_are_an_error);
	RUN_TEST(test_a_changed_byte_makes_no_false_value);
	RUN_TEST(test_a_socket_that_ends_is_opened_again);
	RUN_TEST(test_a_module_that_is_unloaded_takes_the_target_down);
	RUN_TEST(test_one_of_two_masters_that_goes_leaves_the_other);
	RUN_TEST(test_a_master_that_comes_later_is_one_more_bus);
	RUN_TEST(test_a_suspended_target_has_no_socket);
	RUN_TEST(test_files_serve_where_netlink_is_refused);
	RUN_TEST(test_a_passing_fault_is_no_refusal);
	RUN_TEST(test_files_serve_where_the_kernel_does_not_answer);
	RUN_TEST(test_one_lost_answer_at_the_start_is_no_refusal);
	RUN_TEST(test_a_kernel_that_has_answered_is_asked_again_by_netlink);
	RUN_TEST(test_without_a_master_the_target_is_down_until_one_comes);
	RUN_TEST(test_a_target_is_followed_by_what_w1_takes);
	return UNITY_END();
}
