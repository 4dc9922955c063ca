/* SPDX-License-Identifier: MIT */
/* The I2C transactions of a DS2482 are recorded, and its driver works on them again. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/ds2482/i2c.h"
#include "hal/sim/bus.h"
#include "hal/sim/replay.h"
#include "hal/trace/trace.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/one_bus.h"

#define SENSOR "/28.A10000000000/temperature"

static struct trace *trace;
static char *text, file[300], room[300];
static size_t len;

void setUp(void)
{
	snprintf(file, sizeof(file), "%s", folder_file("it", "trace"));
	host_init_virtual(&host);
}

void tearDown(void)
{
	one_bus_end();
	free(text);
	text = NULL;
}

static void put(const char *content)
{
	FILE *made = fopen(file, "w");

	fputs(content, made);
	fclose(made);
}

static void open_bus(const struct bus_ops *ops)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, ops->create(file, &host.env, &bus, why, sizeof(why)), why);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, host.event[0].news, host.event[0].text);
}

static int32_t read_sensor(void)
{
	struct bus_req req = {.op = BUS_READ,
	                      .prio = BUS_INPUT,
	                      .fresh = true,
	                      .path = SENSOR,
	                      .data = (uint8_t *)room,
	                      .len = sizeof(room),
	                      .deadline_ns = host.now + 20 * HOST_S};

	memset(room, 0, sizeof(room));
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 21 * HOST_S));
	return host.answer[0].err;
}

static void record(const char *combine)
{
	FILE *out = open_memstream(&text, &len);
	char scenario[300];

	snprintf(scenario, sizeof(scenario),
	         "i2c speed 100 combine %s\nchip DS2482-100 0x1a\n"
	         "DS18B20 28.A10000000000 as t temperature 21.5\n",
	         combine);
	put(scenario);
	trace = trace_record(out, true, false);
	host.env.tap = &trace->tap;
	open_bus(&sim_bus);
	TEST_ASSERT_EQUAL_INT32(0, read_sensor());
	TEST_ASSERT_EQUAL_STRING("        21.5", room);
	one_bus_end();
	trace_end(trace);
	fclose(out);
}

static void test_the_driver_reads_the_same_of_a_replay(void)
{
	static const char *const combine[] = {"any", "one-read", "smbus"};

	for (size_t i = 0; i < sizeof(combine) / sizeof(combine[0]); i++) {
		record(combine[i]);
		TEST_ASSERT_NOT_NULL(strstr(text, " i2c: claim 1A >\n"));
		TEST_ASSERT_NULL(strstr(text, " run "));
		put(text);
		host_init_virtual(&host);
		open_bus(&replay_bus);
		TEST_ASSERT_EQUAL_INT32(0, read_sensor());
		TEST_ASSERT_EQUAL_STRING("        21.5", room);
		one_bus_end();
		free(text);
		text = NULL;
		host_init_virtual(&host);
	}
}

/* The driver trusts what an adapter says of itself. */
static void test_an_adapter_that_there_cannot_be_combines_nothing(void)
{
	static const char *const can[] = {"=-1", "=2147483647", "!EIO", ""};
	char content[100], why[100];

	for (size_t i = 0; i < sizeof(can) / sizeof(can[0]); i++) {
		snprintf(content, sizeof(content), TRACE_BEGIN "0 0 i2c: adapter > %s\n", can[i]);
		put(content);
		TEST_ASSERT_EQUAL_INT(0, trace_replay(&trace, file, why, sizeof(why)));
		struct i2c_adapter *adapter = trace->tap.adapter(&trace->tap, &host.env, NULL);
		TEST_ASSERT_EQUAL_INT(I2C_SMBUS_ONLY, adapter->combine);
		TEST_ASSERT_EQUAL_UINT(0, adapter->max_messages);
		adapter->ops->close(adapter);
		trace_end(trace);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_driver_reads_the_same_of_a_replay);
	RUN_TEST(test_an_adapter_that_there_cannot_be_combines_nothing);
	return UNITY_END();
}
