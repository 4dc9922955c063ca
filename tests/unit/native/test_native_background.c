/* SPDX-License-Identifier: MIT */
/* The background search of 50 known devices: what it costs, and how soon it finds what is new. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/plant.h"

#define KNOWN 50
#define MINUTE_NS (60 * HOST_S)

static struct host host;
static struct bus *bus;
static struct sim_net *net;
static struct bus_req req[KNOWN];
static char path[KNOWN][64];
static uint8_t data[KNOWN][64];
static bool due[KNOWN], busy;

static void take(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	due[answer->id] = true;
}

static void event(const char *text)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_event(net, text, host.now, why, sizeof(why)),
	                              why);
}

static uint64_t counter(const char *name)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, name) == 0)
			return counters[i].value;
	TEST_FAIL_MESSAGE(name);
	return 0;
}

/* Ids differ in all bits, as those of a real delivery do; but `twin`, which ends as t0 does not. */
void setUp(void)
{
	char name[] = "/tmp/owsd-hunt-XXXXXX", target[64];
	int fd = mkstemp(name);
	FILE *file = fd < 0 ? NULL : fdopen(fd, "w");

	TEST_ASSERT_NOT_NULL(file);
	fprintf(file, "i2c speed 400\nchip DS2482-100 0x18\n");
	for (unsigned i = 0; i < KNOWN; i++)
		fprintf(file, "DS18B20 28.%08X%04X as t%u\n", (i + 1) * 2654435761u, i, i);
	fprintf(file,
	        "DS18B20 28.0FEDCBA98765 as new unplugged\n"
	        "DS18B20 28.%08X0001 as twin unplugged\n",
	        2654435761u);
	fclose(file);
	snprintf(target, sizeof(target), "sim:%s", name);
	busy = false;
	host_init_virtual(&host);
	host.env.answer = take;
	bus = host_bus(&host, target);
	unlink(name);
	net = plant_net(bus);
	host_run(&host, bus, host.now + MINUTE_NS);
	TEST_ASSERT_EQUAL_UINT64(KNOWN, counter("devices_found"));
}

void tearDown(void)
{
	bus_destroy(bus);
}

/* All are asked for without a pause, for so long, or until a counter is so large. */
static void run_busy(int64_t until_ns, const char *name, uint64_t count)
{
	for (unsigned i = 0; i < KNOWN; i++)
		due[i] |= !busy;
	busy = true;
	while (host.now < until_ns && (!name || counter(name) < count)) {
		for (unsigned i = 0; i < KNOWN; i++) {
			if (!due[i])
				continue;
			due[i] = false;
			snprintf(path[i], sizeof(path[i]), "/28.%08X%04X/temperature12",
			         (i + 1) * 2654435761u, i);
			req[i] = (struct bus_req){.id = i,
			                          .op = BUS_READ,
			                          .prio = BUS_INPUT,
			                          .fresh = true,
			                          .deadline_ns = host.now + 20 * HOST_S,
			                          .path = path[i],
			                          .len = sizeof(data[i]),
			                          .data = data[i]};
			TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[i]));
		}
		int64_t next = bus_step(bus, host.now);
		next = next < until_ns ? next : until_ns;
		host.now = next > host.now ? next : host.now;
	}
}

/* Nobody asks for anything until a counter is so large, but so long at most. */
static void wait_for(const char *name, uint64_t count, int64_t most_ns)
{
	int64_t until_ns = host.now + most_ns;

	while (host.now < until_ns && counter(name) < count)
		host_run(&host, bus, host.now + HOST_S / 10);
	TEST_ASSERT_EQUAL_UINT64_MESSAGE(count, counter(name), name);
}

/* Of an idle wire a pass takes 6.5 ms; to its end it took 15.0, and all of them 5.5 % of it. */
static uint64_t us_of_a_pass(void)
{
	uint64_t wire_us = counter("wire_us"), passes = counter("search_passes");

	host_run(&host, bus, host.now + 2 * MINUTE_NS);
	wire_us = counter("wire_us") - wire_us;
	TEST_ASSERT_LESS_THAN_UINT64(2 * MINUTE_NS / 1000 / 25, wire_us);
	return wire_us / (counter("search_passes") - passes);
}

static void test_it_takes_a_hundredth_of_a_busy_wire(void)
{
	uint64_t us = us_of_a_pass(), passes, found = KNOWN, lost = 0;

	TEST_ASSERT_LESS_THAN_UINT64(7000, us);
	run_busy(host.now + MINUTE_NS, NULL, 0); /* until they convert in turn */
	passes = counter("search_passes");
	run_busy(host.now + 100 * HOST_S, NULL, 0);
	passes = counter("search_passes") - passes;
	TEST_ASSERT_LESS_THAN_UINT64(HOST_S / 1000, passes * us);
	for (unsigned i = 0; i < 3; i++) {
		event("plug new");
		run_busy(host.now + 40 * HOST_S, "devices_found", ++found);
		TEST_ASSERT_EQUAL_UINT64(found, counter("devices_found"));
		event("unplug new");
		run_busy(host.now + 110 * HOST_S, "devices_lost", ++lost);
		TEST_ASSERT_EQUAL_UINT64(lost, counter("devices_lost"));
	}
}

static void test_a_new_device_is_found_within_ten_seconds(void)
{
	for (unsigned i = 1; i <= 12; i++) {
		event("plug new");
		wait_for("devices_found", KNOWN + i, 10 * HOST_S);
		event("unplug new");
		wait_for("devices_lost", i, 26 * HOST_S);
		host_run(&host, bus, host.now + i * 1337 * HOST_MS);
	}
}

/* Nobody asks for them: a pass that is cut is no loss, and those to the end prove them. */
static void test_who_is_there_is_not_lost(void)
{
	host_run(&host, bus, host.now + 10 * MINUTE_NS);
	TEST_ASSERT_EQUAL_UINT64(KNOWN, counter("devices_found"));
	TEST_ASSERT_EQUAL_UINT64(0, counter("devices_lost"));
}

/* It begins as a known one, 48 bits long: a pass to the end finds it. */
static void test_who_begins_as_a_known_one_is_found(void)
{
	event("plug twin");
	wait_for("devices_found", KNOWN + 1, 150 * HOST_S);
	event("unplug twin");
	wait_for("devices_lost", 1, 26 * HOST_S);
	event("unplug t0");
	event("plug twin");
	wait_for("devices_found", KNOWN + 2, 150 * HOST_S);
	wait_for("devices_lost", 2, 26 * HOST_S);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_takes_a_hundredth_of_a_busy_wire);
	RUN_TEST(test_a_new_device_is_found_within_ten_seconds);
	RUN_TEST(test_who_is_there_is_not_lost);
	RUN_TEST(test_who_begins_as_a_known_one_is_found);
	return UNITY_END();
}
