/* SPDX-License-Identifier: MIT */
/* Who has the wire: what has to stay together does, and what need not lets others in between. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static const uint8_t page[32] = "what stands in the page";
static struct sim_slave *chip;

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		native_end();
}

/*
 * The chip answers behind its strong pull-up in the same transaction. The host is late at each
 * step, so that other requests have come meanwhile that go first.
 */
static void test_a_ds1977_is_read_on_a_host_that_is_late(void)
{
	static const char *const properties[] = {"pages/page.3", "set_password/enabled"};

	native_begin();
	wire_init(&host, 1, 1);
	chip = wire_add(0, "DS1977", 1);
	const struct sim_slave *outputs = wire_add(0, "DS2408", 2);
	start();
	size_t size;
	memcpy(sim_slave_memory(chip, &size) + 3 * 64, page, 32);
	for (unsigned i = 0; i < 20; i++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, properties[i % 2]), NULL);
		uint32_t other = ask(BUS_READ, BUS_ALARM, true, of(outputs, "latch.BYTE"), NULL);

		for (unsigned steps = 0; !host_answer(&host, id); steps++) {
			TEST_ASSERT_LESS_THAN_UINT(200, steps);
			int64_t next = bus_step(bus, host.now);

			host.now = next > host.now ? next : host.now;
			host.now += 7 * HOST_MS;
			if (host_answer(&host, other) && steps < 40 && steps % 3 == 0)
				other = ask(BUS_READ, BUS_ALARM, true, of(outputs, "latch.BYTE"),
				            NULL);
		}
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, properties[i % 2]);
		if (i % 2 == 0)
			TEST_ASSERT_EQUAL_MEMORY(page, data[id], 32);
		answer_to(other);
		forget();
	}
	TEST_ASSERT_EQUAL_UINT64(0, counted("checksum_errors"));
}

/* A page takes 25 ms of the wire. */
static void test_no_look_at_an_iblss_holds_the_wire_for_more_than_one_page(void)
{
	static const char *const properties[] = {"TH/temperature", "subtype"};

	for (unsigned i = 0; i < 2; i++) {
		native_begin();
		wire_init(&host, 1, 1);
		chip = wire_add(0, "IBLSS", 1);
		start();
		host_run(&host, bus, host.now + 10 * HOST_S);
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, properties[i]), NULL);

		while (!host_answer(&host, id)) {
			int64_t began = host.now, next = bus_step(bus, began);

			TEST_ASSERT_LESS_THAN_INT64(35 * HOST_MS, host.now - began);
			host.now = next > host.now ? next : host.now;
		}
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		native_end();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds1977_is_read_on_a_host_that_is_late);
	RUN_TEST(test_no_look_at_an_iblss_holds_the_wire_for_more_than_one_page);
	return UNITY_END();
}
