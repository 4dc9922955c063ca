/* SPDX-License-Identifier: MIT */
/* Requests before all wires were searched: the wire of one adapter does not wait for another's. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

#define MEMORY 2560 /* of a DS28EC20, in bytes */
#define OTHERS 200  /* devices of its wire: the search takes 3 s and more */
#define READS 100   /* of the input, meanwhile */

/* Some come while the memory holds its wire. */
#define PERIOD_NS(i) ((25 + (i) % 8 * 7) * HOST_MS)

static unsigned slept;

void setUp(void)
{
	native_begin();
	slept = 0;
}

void tearDown(void)
{
	native_end();
}

/* Until the request was answered. What it needs can be done at once: no step may wait. */
static void take(uint32_t id)
{
	while (!host_answer(&host, id)) {
		int64_t next = bus_step(bus, host.now);

		if (host_answer(&host, id) || next <= host.now)
			continue;
		slept++;
		host.now = next;
	}
}

static void test_an_input_does_not_wait_while_a_memory_of_another_adapter_is_written(void)
{
	static char text[MEMORY + 1];
	unsigned reads = 0;

	wire_init(&host, 2, 2);
	struct sim_slave *memory = wire_add(0, "DS28EC20", 1), *input = wire_add(1, "DS2413", 1);
	for (unsigned i = 0; i < OTHERS; i++)
		wire_add(0, "DS18B20", i + 1);
	start();
	memset(text, 'x', MEMORY);
	uint32_t write = ask(BUS_WRITE, BUS_GUEST, true, of(memory, "memory"), text);
	while (!host_answer(&host, write) && reads < READS) {
		int64_t due = host.now + PERIOD_NS(reads);

		take(ask(BUS_READ, BUS_INPUT, true, of(input, "sensed.BYTE"), NULL));
		host_run(&host, bus, due);
		reads++;
	}
	TEST_ASSERT_EQUAL_UINT(READS, reads);
	TEST_ASSERT_EQUAL_UINT(0, slept);
	TEST_ASSERT_EQUAL_INT(0, answer_to(write)->err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_input_does_not_wait_while_a_memory_of_another_adapter_is_written);
	return UNITY_END();
}
