/* SPDX-License-Identifier: MIT */
/* The native bus on an adapter with two chips, one of which is late. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/one_bus.h"

/* Gone after 20 s; when it is back, the first chip does not answer for a while. */
static const char scenario[] = "chip DS2482-800 0x18\n"
			       "channel 5\n"
			       "DS18B20 28.A0B1C2000028 temperature 20\n"
			       "chip DS2482-100 0x1c\n"
			       "DS18B20 28.A0B1C2010028 temperature 30\n"
			       "at 20s remove adapter for 1s\n"
			       "at 20.5s refuse 0x18 for 15s\n";

void setUp(void)
{
	simulate(scenario);
}

void tearDown(void)
{
	one_bus_end();
}

static int ask(const char *path, char *text, uint32_t room)
{
	struct bus_req req = {.id = 1,
	                      .op = BUS_READ,
	                      .prio = BUS_OUTPUT,
	                      .fresh = true,
	                      .path = path,
	                      .data = (uint8_t *)text,
	                      .len = room - 1,
	                      .deadline_ns = host.now + 5 * HOST_S};

	host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 6 * HOST_S));
	text[host.answer[0].err ? 0 : host.answer[0].len] = '\0';
	return host.answer[0].err;
}

static void test_a_late_chip_comes_back_without_the_other_going(void)
{
	char text[64];
	unsigned downs, ups;

	host_run(&host, bus, host.now + 5 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, ask("/28.A0B1C2000028/temperature", text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("          20", text);
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, ask("/28.A0B1C2010028/temperature", text, sizeof(text)));
	TEST_ASSERT_LESS_THAN_INT(0, ask("/28.A0B1C2000028/temperature", text, sizeof(text)));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == BUS_NOTE)
			TEST_ASSERT_NOT_NULL(strstr(host.event[i].text, "0x18"));
	downs = host_events(&host, BUS_DOWN);
	ups = host_events(&host, BUS_UP);
	host_run(&host, bus, host.now + 30 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, ask("/28.A0B1C2000028/temperature", text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("          20", text);
	TEST_ASSERT_EQUAL_INT(0, ask("/28.A0B1C2010028/temperature", text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("          30", text);
	TEST_ASSERT_EQUAL_UINT(downs, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(ups, host_events(&host, BUS_UP));
}

static void test_no_total_steps_back_while_a_chip_is_away(void)
{
	const struct bus_counter *counters;
	uint64_t seen[64] = {0};
	size_t n;

	for (unsigned s = 0; s < 60; s++) {
		host_run(&host, bus, host.now + HOST_S);
		counters = bus_counters(bus, &n);
		TEST_ASSERT_LESS_OR_EQUAL_size_t(64, n);
		for (size_t i = 0; i < n; i++) {
			TEST_ASSERT_GREATER_OR_EQUAL_UINT64_MESSAGE(
				seen[i], bus_counted(&counters[i]), counters[i].name);
			seen[i] = bus_counted(&counters[i]);
		}
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_total_steps_back_while_a_chip_is_away);
	RUN_TEST(test_a_late_chip_comes_back_without_the_other_going);
	return UNITY_END();
}
