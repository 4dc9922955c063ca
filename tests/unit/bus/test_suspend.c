/* SPDX-License-Identifier: MIT */
/* Suspended buses: what each kind lets go of, refuses, and sees of its target meanwhile. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/ds2482/look.h"
#include "tests/unit/aid/host.h"

#define TEMPERATURE "/28.000000000001/temperature"

static struct host host;
static struct bus *bus;
static char folder[64];
static uint8_t data[256];
static struct bus_req req;

void setUp(void)
{
	host_init_virtual(&host);
	bus = NULL;
	snprintf(folder, sizeof(folder), "/tmp/owsd-test-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
}

void tearDown(void)
{
	char line[100];

	bus_destroy(bus);
	snprintf(line, sizeof(line), "rm -rf %s", folder);
	TEST_ASSERT_EQUAL_INT(0, system(line));
}

static void ask(const char *path)
{
	req = (struct bus_req){.id = 7,
	                       .op = BUS_READ,
	                       .path = path,
	                       .data = data,
	                       .len = sizeof(data),
	                       .deadline_ns = host.now + 10 * HOST_S};
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
}

static int result(const char *path)
{
	host.answers = 0;
	ask(path);
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 20 * HOST_S));
	return host.answer[0].err;
}

static void run(int64_t seconds)
{
	host_run(&host, bus, host.now + seconds * HOST_S);
}

static void start(const char *target)
{
	bus = host_bus(&host, target);
	run(1);
}

/* sim: with this scenario */
static void simulate(const char *scenario)
{
	char target[100];
	FILE *file;

	snprintf(target, sizeof(target), "sim:%s/net.sim", folder);
	file = fopen(target + 4, "w");
	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fputs(scenario, file));
	TEST_ASSERT_EQUAL_INT(0, fclose(file));
	start(target);
}

static unsigned told(enum bus_news news)
{
	return host_events(&host, news);
}

static void test_a_simple_bus_needs_no_code_to_be_suspended(void)
{
	start("null:");
	TEST_ASSERT_EQUAL_INT(0, result(TEMPERATURE));
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(TEMPERATURE));
	bus_suspend(bus, false);
	run(1);
	TEST_ASSERT_EQUAL_UINT(2, told(BUS_UP));
	TEST_ASSERT_EQUAL_INT(0, result(TEMPERATURE));
}

static void test_what_waits_is_refused_before_the_hardware_is_said_to_be_free(void)
{
	start("null:");
	host.answers = host.events = 0;
	ask(TEMPERATURE);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, host.answer[0].err);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
}

static void test_to_suspend_twice_is_to_suspend_once(void)
{
	start("null:");
	bus_suspend(bus, true);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
	bus_suspend(bus, false);
	bus_suspend(bus, false);
	run(10);
	TEST_ASSERT_EQUAL_UINT(2, told(BUS_UP));
}

static void test_a_target_that_is_always_there_is_back_once(void)
{
	start("null:");
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_BACK));
	bus_suspend(bus, true);
	run(60);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_BACK));
}

static void test_a_bus_may_start_suspended(void)
{
	bus = host_bus(&host, "null:");
	bus_suspend(bus, true);
	run(10);
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_UP));
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(TEMPERATURE));
}

static void test_an_overlapping_bus_refuses_what_comes_late(void)
{
	start("late:late=0");
	TEST_ASSERT_EQUAL_INT(0, result(TEMPERATURE));
	ask("/late" TEMPERATURE);
	host.answers = 0;
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, host.answer[0].err);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(TEMPERATURE));
	bus_suspend(bus, false);
	run(1);
	TEST_ASSERT_EQUAL_INT(0, result(TEMPERATURE));
}

static void test_each_return_of_the_target_is_told_once(void)
{
	start("late:up=20000;down=20000");
	bus_suspend(bus, true);
	run(100);
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_DOWN));
	TEST_ASSERT_INT_WITHIN(1, 3, (int)told(BUS_BACK));
}

static void test_a_simulated_adapter_is_back_when_it_is_plugged_in(void)
{
	simulate("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n"
	         "at 10s remove adapter for 60s\n");
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_UP));
	run(20);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_DOWN));
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
	run(30);
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_BACK));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result("/28.A0B1C2000028/temperature"));
	run(40);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_BACK));
	bus_suspend(bus, false);
	run(5);
	TEST_ASSERT_EQUAL_UINT(2, told(BUS_UP));
	TEST_ASSERT_EQUAL_INT(0, result("/28.A0B1C2000028/temperature"));
}

/* Its adapter is to be seen all the time: to try it again and again would cost the other way. */
static void test_a_chip_that_does_not_answer_is_not_back(void)
{
	simulate("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n"
	         "at 0s refuse 0x18 for 1000s\n");
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_DOWN));
	bus_suspend(bus, true);
	run(100);
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_BACK));
}

static void test_a_bus_let_go_of_in_order_is_back_at_once(void)
{
	simulate("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n");
	bus_suspend(bus, true);
	run(10);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_BACK));
}

static void test_requests_under_way_are_answered_before_the_release(void)
{
	simulate("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n");
	host.answers = host.events = 0;
	ask("/uncached/28.A0B1C2000028/temperature");
	run(0);
	host_run(&host, bus, host.now + 100 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(0, host.answers);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, host.answer[0].err);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_RELEASED));
}

static void test_a_cached_value_does_not_outlive_the_suspension(void)
{
	simulate("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n");
	TEST_ASSERT_EQUAL_INT(0, result("/28.A0B1C2000028/temperature"));
	bus_suspend(bus, true);
	bus_suspend(bus, false);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_INT(0, result("/28.A0B1C2000028/temperature"));
	TEST_ASSERT_EQUAL_UINT8(0, host.answer[0].detail & BUS_DETAIL_CACHED);
}

static void make(const char *name)
{
	char path[120];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
}

static void test_the_kernels_masters_are_back_when_one_has_come(void)
{
	char target[100];

	snprintf(target, sizeof(target), "w1:root=%s", folder);
	start(target);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_DOWN));
	bus_suspend(bus, true);
	run(20);
	TEST_ASSERT_EQUAL_UINT(0, told(BUS_BACK));
	make("w1_bus_master3");
	run(10);
	TEST_ASSERT_EQUAL_UINT(1, told(BUS_BACK));
}

/* --- What is to be seen of an adapter: /dev/null, which has the number 3, in its place -------- */

static int look(uint8_t chips, uint64_t *mark)
{
	*mark = 0;
	return i2c_look("/dev/null", folder, chips, mark);
}

static void test_a_chip_with_a_kernel_driver_is_not_there(void)
{
	char driver[32], client[24], path[100];
	uint64_t before, after;

	TEST_ASSERT_EQUAL_INT(1, look(1, &before));
	make("3-0018");
	TEST_ASSERT_EQUAL_INT(1, look(1, &after));
	TEST_ASSERT_EQUAL_UINT64(before, after);
	snprintf(path, sizeof(path), "%s/3-0018/driver", folder);
	TEST_ASSERT_EQUAL_INT(0, symlink("../../../bus/i2c/drivers/ds2482", path));
	TEST_ASSERT_EQUAL_INT(0, look(1, &after));
	TEST_ASSERT_TRUE(before != after);
	TEST_ASSERT_EQUAL_INT(1, look(3, &after)); /* the one at 0x19 is free */
	i2c_driver("/dev/null", folder, 0x18, driver, sizeof(driver), client, sizeof(client));
	TEST_ASSERT_EQUAL_STRING("ds2482", driver);
	TEST_ASSERT_EQUAL_STRING("3-0018", client);
}

static void test_an_adapter_without_a_file_is_not_there(void)
{
	uint64_t mark = 0;

	TEST_ASSERT_EQUAL_INT(0, i2c_look("/dev/i2c-does-not-exist", folder, 0, &mark));
}

static void test_adapters_are_listed_by_number(void)
{
	unsigned number[8];

	make("i2c-10");
	make("i2c-2");
	make("i2c-x");
	make("i2c-");
	make("spi-1");
	make("i2c-0");
	TEST_ASSERT_EQUAL_UINT(3, i2c_list(folder, number, 8));
	TEST_ASSERT_EQUAL_UINT(0, number[0]);
	TEST_ASSERT_EQUAL_UINT(2, number[1]);
	TEST_ASSERT_EQUAL_UINT(10, number[2]);
	TEST_ASSERT_EQUAL_UINT(2, i2c_list(folder, number, 2));
	TEST_ASSERT_EQUAL_UINT(0, i2c_list("/nowhere/at/all", number, 8));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_simple_bus_needs_no_code_to_be_suspended);
	RUN_TEST(test_what_waits_is_refused_before_the_hardware_is_said_to_be_free);
	RUN_TEST(test_to_suspend_twice_is_to_suspend_once);
	RUN_TEST(test_a_target_that_is_always_there_is_back_once);
	RUN_TEST(test_a_bus_may_start_suspended);
	RUN_TEST(test_an_overlapping_bus_refuses_what_comes_late);
	RUN_TEST(test_each_return_of_the_target_is_told_once);
	RUN_TEST(test_a_simulated_adapter_is_back_when_it_is_plugged_in);
	RUN_TEST(test_a_chip_that_does_not_answer_is_not_back);
	RUN_TEST(test_a_bus_let_go_of_in_order_is_back_at_once);
	RUN_TEST(test_requests_under_way_are_answered_before_the_release);
	RUN_TEST(test_a_cached_value_does_not_outlive_the_suspension);
	RUN_TEST(test_the_kernels_masters_are_back_when_one_has_come);
	RUN_TEST(test_a_chip_with_a_kernel_driver_is_not_there);
	RUN_TEST(test_an_adapter_without_a_file_is_not_there);
	RUN_TEST(test_adapters_are_listed_by_number);
	return UNITY_END();
}
