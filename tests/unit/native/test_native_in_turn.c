/* SPDX-License-Identifier: MIT */
/*
 * 50 thermometers of one wire that convert in turn, behind a DS2482: how often each value is new,
 * in how many I2C transfers, and that none is false while the chip's times change.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/plant.h"

#define COUNT 50

static struct host host;
static struct bus *bus;
static struct sim_net *net;
static struct bus_req req[COUNT];
static char path[COUNT][64];
static uint8_t data[COUNT][64];
static int64_t asked_ns[COUNT], again_ns[COUNT];
static double set_to[COUNT];
static unsigned turn, good[COUNT], wrong, old, failed;

static void take(void *ctx, const struct bus_answer *answer)
{
	unsigned i = answer->id;

	(void)ctx;
	again_ns[i] = host.now + HOST_MS / 10;
	failed += answer->err != 0;
	if (answer->err)
		return;
	good[i]++;
	wrong += strtod((char *)data[i], NULL) != set_to[i];
	old += answer->measured_ns < asked_ns[i];
}

/* Another temperature from now on: a value of before gives itself away. */
static void ask(unsigned i)
{
	char text[64], why[200] = "";

	set_to[i] = (double)(turn++ % 1000) / 16 + 20;
	snprintf(text, sizeof(text), "set t%u temperature %.4f", i, set_to[i]);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_event(net, text, host.now, why, sizeof(why)),
	                              why);
	snprintf(path[i], sizeof(path[i]), "/28.0000000000%02X/temperature12", i + 1);
	memset(data[i], 0, sizeof(data[i]));
	req[i] = (struct bus_req){.id = i,
	                          .op = BUS_READ,
	                          .prio = BUS_INPUT,
	                          .fresh = true,
	                          .deadline_ns = host.now + 20 * HOST_S,
	                          .path = path[i],
	                          .len = sizeof(data[i]),
	                          .data = data[i]};
	asked_ns[i] = host.now;
	again_ns[i] = INT64_MAX;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[i]));
}

static void run(int64_t ns)
{
	int64_t until_ns = host.now + ns;

	while (host.now < until_ns) {
		int64_t next = until_ns;

		for (unsigned i = 0; i < COUNT; i++) {
			if (again_ns[i] <= host.now)
				ask(i);
			next = again_ns[i] < next ? again_ns[i] : next;
		}
		int64_t step = bus_step(bus, host.now);
		next = step < next ? step : next;
		host.now = next > host.now ? next : host.now;
	}
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

static void begin(const char *adapter)
{
	char name[] = "/tmp/owsd-turn-XXXXXX", target[64];
	int fd = mkstemp(name);
	FILE *file = fd < 0 ? NULL : fdopen(fd, "w");

	TEST_ASSERT_NOT_NULL(file);
	fprintf(file, "i2c %s\nchip DS2482-100 0x18\n", adapter);
	for (unsigned i = 0; i < COUNT; i++)
		fprintf(file, "DS18B20 28.0000000000%02X as t%u\n", i + 1, i);
	fclose(file);
	snprintf(target, sizeof(target), "sim:%s", name);
	host_init_virtual(&host);
	host.env.answer = take;
	bus = host_bus(&host, target);
	unlink(name);
	net = plant_net(bus);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	host_run(&host, bus, host.now + 10 * HOST_S);
	memset(again_ns, 0, sizeof(again_ns));
	run(10 * HOST_S);
	memset(good, 0, sizeof(good));
	wrong = old = failed = 0;
}

void setUp(void)
{
	turn = 0;
}

void tearDown(void)
{
	if (bus)
		bus_destroy(bus);
	bus = NULL;
}

static unsigned least(void)
{
	unsigned fewest = UINT32_MAX;

	for (unsigned i = 0; i < COUNT; i++)
		fewest = good[i] < fewest ? good[i] : fewest;
	return fewest;
}

static void no_false_value(void)
{
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_EQUAL_UINT(0, old);
	TEST_ASSERT_EQUAL_UINT(0, failed);
}

/*
 * Two transfers read a chip, and one starts it. Of the background search each bit is one, a pass a
 * second.
 */
static void test_each_value_is_new_within_eleven_tenths_of_a_second(void)
{
	begin("speed 400 combine any");
	uint64_t transfers = counter("i2c_transfers"), starts = counter("conversions");

	run(60 * HOST_S);
	no_false_value();
	TEST_ASSERT_GREATER_THAN_UINT(60000 / 1100, least());
	/* Each value is of a start of its own, which the chip showed. */
	starts = counter("conversions") - starts;
	TEST_ASSERT_GREATER_THAN_UINT64(60000 / 1100 * COUNT, starts);
	transfers = counter("i2c_transfers") - transfers;
	TEST_ASSERT_LESS_THAN_UINT64(3 * starts + 70 * 60, transfers);
}

static void test_other_adapters_are_little_slower(void)
{
	begin("speed 400 combine one-read");
	run(30 * HOST_S);
	no_false_value();
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(30000 / 1110, least());
	tearDown();
	begin("speed 100 combine any");
	run(30 * HOST_S);
	no_false_value();
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(30000 / 1450, least());
}

/* The chip gets warm, or cold, or another one is put in its place. */
static void test_the_chips_times_may_change(void)
{
	static const int percent[] = {95, 105, 96, 104, 97, 100, 98, 99, 101, 105};

	begin("speed 400 combine any");
	for (unsigned i = 0; i < sizeof(percent) / sizeof(percent[0]); i++) {
		net->chip[0].percent = percent[i];
		run(5 * HOST_S);
	}
	no_false_value();
	TEST_ASSERT_GREATER_THAN_UINT(50000 / 1200, least());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_value_is_new_within_eleven_tenths_of_a_second);
	RUN_TEST(test_other_adapters_are_little_slower);
	RUN_TEST(test_the_chips_times_may_change);
	return UNITY_END();
}
