/* SPDX-License-Identifier: MIT */
/* What is counted of each wire of an adapter that has several. */
#include "unity.h"

#include "tests/unit/aid/one_bus.h"

void setUp(void)
{
}

void tearDown(void)
{
	one_bus_end();
}

static void read_one(const char *path)
{
	static uint32_t id;
	uint8_t text[64];
	struct bus_req request = {.id = ++id,
	                          .op = BUS_READ,
	                          .prio = BUS_INPUT,
	                          .fresh = true,
	                          .path = path,
	                          .data = text,
	                          .len = sizeof(text),
	                          .deadline_ns = host.now + 20 * HOST_S};

	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &request));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, id, host.now + 20 * HOST_S));
	TEST_ASSERT_EQUAL_INT(0, host_answer(&host, id)->err);
}

static uint64_t sum(void)
{
	char name[] = "wire_0_us";
	uint64_t all = 0;

	for (; name[5] < '8'; name[5]++)
		all += counted(name);
	return all;
}

static void test_a_ds2482_800_has_eight_wires_each_with_its_load(void)
{
	uint64_t before;

	simulate("chip DS2482-800 0x18\nchannel 5\nDS18B20 28.000000000001 temperature 20\n"
	         "channel 2\nDS18B20 28.000000000002 temperature 20");
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	read_one("/28.000000000001/temperature");
	TEST_ASSERT_EQUAL_UINT64(8, counted("wires"));
	before = counted("wire_5_us");
	for (int i = 0; i < 20; i++)
		read_one("/28.000000000001/scratchpad");
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(before + UINT64_C(20) * 19 * 8 * 60,
	                                    counted("wire_5_us"));
	TEST_ASSERT_GREATER_THAN_UINT64(2 * counted("wire_2_us"), counted("wire_5_us"));
	TEST_ASSERT_UINT64_WITHIN(8, counted("wire_us"), sum());
	TEST_ASSERT_EQUAL_UINT64(0, counted("wire_5_errors"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2482_800_has_eight_wires_each_with_its_load);
	return UNITY_END();
}
