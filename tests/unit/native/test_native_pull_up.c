/* SPDX-License-Identifier: MIT */
/*
 * Nothing uses a wire, or another channel of the same chip, while the strong pull-up feeds a chip
 * that works: it would lose its supply, and its result with it.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define OTHERS 8

static struct sim_slave *other[OTHERS];
static unsigned cut;

void setUp(void)
{
	native_begin();
	fleet_begin();
	cut = 0;
}

void tearDown(void)
{
	native_end();
}

/* Any use of a DS2482 ends the strong pull-up of each of its channels. */
static void look_at_pull_up(int64_t now)
{
	const struct sim_slave *parasite = fleet.slave[0];

	cut += wire_net.wire[0].strong && parasite->busy && now < parasite->until;
}

/*
 * A parasitic thermometer that converts again and again on the first channel; on the last one
 * devices that nobody asks for.
 */
static void set_out(unsigned channels)
{
	wire_init(&host, channels, 1);
	wire_net.used = look_at_pull_up;
	fleet_add_to(0, "DS18B20", 1);
	fleet.slave[0]->parasite = true;
	for (unsigned i = 0; i < OTHERS; i++)
		other[i] = wire_add(channels - 1, "DS18B20", 10 + i);
}

/* Each has all bits but the last of another device: a look for them takes a search for each. */
static void ask_for_what_is_nowhere(void)
{
	char path[64];
	uint32_t id = 0;
	int err;

	for (unsigned i = 0; i < OTHERS; i++) {
		snprintf(path, sizeof(path), "%s", name_of(other[i]));
		size_t len = strlen(path);
		TEST_ASSERT_EQUAL_CHAR('0', path[len - 2]);
		path[len - 2] = '8';
		strcat(path, "/temphigh");
		id = fleet_ask(i % 2 ? BUS_INPUT : BUS_ALARM, BUS_READ, path);
	}
	fleet_answered(id, &err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, err);
}

/* So many that they use up their part of the wire's time: conversions begin between searches. */
static void look_for_the_absent_beside_conversions(unsigned channels)
{
	set_out(channels);
	start();
	for (unsigned turn = 0; turn < 120; turn++)
		ask_for_what_is_nowhere();
	TEST_ASSERT_EQUAL_UINT(0, cut);
	TEST_ASSERT_GREATER_THAN_UINT(20, wire_net.strong_count);
	TEST_ASSERT_GREATER_THAN_UINT(20, fleet.good);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.failed);
}

static void test_no_look_for_absent_devices_cuts_the_strong_pull_up(void)
{
	look_for_the_absent_beside_conversions(1);
}

static void test_nor_that_of_another_channel(void)
{
	look_for_the_absent_beside_conversions(2);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_look_for_absent_devices_cuts_the_strong_pull_up);
	RUN_TEST(test_nor_that_of_another_channel);
	return UNITY_END();
}
