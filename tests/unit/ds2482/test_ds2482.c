/* SPDX-License-Identifier: MIT */
/* The driver of the DS2482 at work: calls, waits, channels, which chip is taken. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/ds2482/master.h"
#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

void setUp(void)
{
	ds_begin();
}

void tearDown(void)
{
	ds_end();
}

static void test_a_scratchpad_is_read_over_every_kind_of_adapter(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		ds_start(ds_kinds[i]);
		for (unsigned n = 0; n < 3; n++)
			ds_check_scratchpad();
		tearDown();
	}
}

static void test_slow_and_fast_chips_within_the_data_sheets_limits_are_waited_for(void)
{
	for (unsigned i = 0; i < 6; i++) {
		for (int percent = 95; percent <= 105; percent += 5) {
			ds_start(ds_kinds[i]);
			ds.net.chip[0].percent = percent;
			ds_check_scratchpad();
			tearDown();
		}
	}
}

static void test_a_scratchpad_takes_few_transactions(void)
{
	static const unsigned most[4] = {3, 21, 3, 21};

	for (unsigned i = 0; i < 4; i++) {
		struct link_master_cost shared, shared_after;
		struct link_cost before, after;

		ds_start(ds_kinds[i]);
		ds.wire->ops->cost(ds.wire, &before);
		ds.master->ops->cost(ds.master, &shared);
		ds_check_scratchpad();
		ds.wire->ops->cost(ds.wire, &after);
		ds.master->ops->cost(ds.master, &shared_after);
		TEST_ASSERT_LESS_OR_EQUAL_UINT64(most[i],
		                                 shared_after.transfers - shared.transfers);
		TEST_ASSERT_EQUAL_UINT64(1, after.resets - before.resets);
		TEST_ASSERT_EQUAL_UINT64(1184000 + 19 * 8 * 69300, after.wire_ns - before.wire_ns);
		tearDown();
	}
}

static void test_most_of_the_time_is_the_wires(void)
{
	static const double most[4] = {1.22, 1.22, 1.57, 1.53};

	for (unsigned i = 0; i < 4; i++) {
		struct link_cost before, after;
		int64_t begun;
		char text[80];
		double ratio;

		ds_start(ds_kinds[i]);
		ds.wire->ops->cost(ds.wire, &before);
		begun = ds.host.now;
		ds_check_scratchpad();
		ds.wire->ops->cost(ds.wire, &after);
		ratio = (double)(ds.host.now - begun) / (double)(after.wire_ns - before.wire_ns);
		snprintf(text, sizeof(text), "kind %u: %.3f", i, ratio);
		TEST_ASSERT_TRUE_MESSAGE(ratio <= most[i], text);
		tearDown();
	}
}

static void test_presence_nobody_and_a_short_are_told_apart(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		ds_start(ds_kinds[i]);
		TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
		ds_event("unplug t");
		TEST_ASSERT_EQUAL_INT(0, part_reset(ds.wire));
		ds_event(i == 7 ? "short 0x1f" : "short 0x18");
		TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(ds.wire));
		ds_event(i == 7 ? "end short 0x1f" : "end short 0x18");
		ds_event("plug t");
		TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
		ds_check_scratchpad();
		tearDown();
	}
}

static void test_triplets_and_bits_read_the_wire(void)
{
	const uint8_t search = 0xF0;

	ds_start(ds_kinds[1]);
	TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(0, part_write(ds.wire, &search, 1, LINK_IDLE));
	for (unsigned i = 0; i < 8; i++) /* 28h, least bit first */
		TEST_ASSERT_EQUAL_INT(0x28 >> i & 1 ? 1 | 4 : 2,
		                      ds.wire->ops->triplet(ds.wire, i & 1));
	/* 0, and its complement */
	TEST_ASSERT_EQUAL_INT(0, link_slot(ds.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(1, link_slot(ds.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, link_slot(ds.wire, false, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(3 | 4, ds.wire->ops->triplet(ds.wire, false)); /* nobody */
}

static void test_the_strong_pullup_feeds_a_parasite_until_the_next_call(void)
{
	static const uint8_t convert[2] = {0xCC, 0x44};

	for (unsigned i = 0; i < DS_KINDS; i++) {
		struct sim_slave *slave;
		uint8_t scratchpad[9];

		ds_start(ds_kinds[i]);
		slave = sim_net_slave(&ds.net, "t");
		slave->parasite = true;
		slave->input[0] = sim_constant(25.0625);
		for (unsigned n = 0; n < 2; n++) {
			TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
			TEST_ASSERT_EQUAL_INT(0, part_write(ds.wire, convert, 2, LINK_STRONG));
			/* Who waits counts from the call's end. */
			ds.host.now += 750 * HOST_MS;
			TEST_ASSERT_EQUAL_INT(0, ds_read_scratchpad("t", scratchpad));
			TEST_ASSERT_EQUAL_HEX8(0x91, scratchpad[0]);
		}
		TEST_ASSERT_EQUAL_UINT64(1, slave->power_ons);
		tearDown();
	}
}

/* Nobody else would end it. */
static void test_the_strong_pullup_ends_with_the_adapter_also_at_a_shutdown(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		ds_start(ds_kinds[i]);
		TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
		TEST_ASSERT_EQUAL_INT(1, link_slot(ds.wire, true, LINK_STRONG));
		TEST_ASSERT_TRUE(ds.net.chip[0].wire[0].strong);
		ds.host.shutdown = true;
		ds.master->ops->close(ds.master);
		TEST_ASSERT_FALSE(ds.net.chip[0].wire[0].strong);
		ds.host.shutdown = false;
		tearDown();
	}
}

static int (*whole_wait)(void *ctx, int fd, short events, int64_t until_ns);
static unsigned waits_left;

static int wait_until_shutdown(void *ctx, int fd, short events, int64_t until_ns)
{
	ds.host.shutdown = !waits_left;
	waits_left -= waits_left > 0;
	return whole_wait(ctx, fd, events, until_ns);
}

/* The chip may be busy then, and nobody waits for it. */
static void test_the_strong_pullup_ends_with_the_adapter_whenever_the_shutdown_comes(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++)
		for (unsigned waits = 0; waits < 6; waits++) {
			host_init_real(&ds.host);
			whole_wait = ds.host.env.wait;
			ds_start(ds_kinds[i]);
			TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
			ds.host.env.wait = wait_until_shutdown;
			waits_left = waits;
			(void)link_slot(ds.wire, true, LINK_STRONG);
			waits_left = 0;
			ds.master->ops->close(ds.master);
			sim_net_run(&ds.net, host_now(&ds.host) + HOST_MS);
			TEST_ASSERT_FALSE_MESSAGE(ds.net.chip[0].wire[0].strong, ds_kinds[i]);
			tearDown();
			setUp();
		}
}

static void test_each_channel_of_an_800_is_its_own_wire(void)
{
	ds_start("chip DS2482-800 0x1a\nchannel 0\nDS2401 01.000000000001\n"
	         "channel 6\nDS18B20 28.000000000001 as t");
	TEST_ASSERT_EQUAL_UINT(8, ds.master->ops->channels(ds.master));
	for (unsigned i = 0; i < 8; i++) {
		ds.wire = ds.master->ops->channel(ds.master, i);
		TEST_ASSERT_EQUAL_INT(i == 0 || i == 6, part_reset(ds.wire));
	}
	ds.wire = ds.master->ops->channel(ds.master, 6);
	ds_check_scratchpad();
}

static void test_one_chip_or_one_channel_is_opened_when_it_is_named(void)
{
	static const char *const two = "chip DS2482-100 0x18\nchip DS2482-800 0x1c\nchannel 3\n"
				       "DS18B20 28.000000000001 as t";

	ds_start(two);
	TEST_ASSERT_EQUAL_UINT(9, ds.master->ops->channels(ds.master));
	tearDown();
	TEST_ASSERT_EQUAL_INT(0, ds_try_open(two, ":0x1c"));
	TEST_ASSERT_EQUAL_UINT(8, ds.master->ops->channels(ds.master));
	tearDown();
	TEST_ASSERT_EQUAL_INT(0, ds_try_open(two, ":0x1c.3"));
	TEST_ASSERT_EQUAL_UINT(1, ds.master->ops->channels(ds.master));
	ds.wire = ds.master->ops->channel(ds.master, 0);
	ds_check_scratchpad();
	TEST_ASSERT_NULL(ds.master->ops->channel(ds.master, 1));
	tearDown();
	TEST_ASSERT_EQUAL_INT(-ENXIO, ds_try_open(two, ":0x18.3"));
	TEST_ASSERT_NOT_NULL(strstr(ds.why, "one channel"));
	tearDown();
	TEST_ASSERT_EQUAL_INT(-ENXIO, ds_try_open(two, ":0x1a"));
	TEST_ASSERT_NOT_NULL(strstr(ds.why, "no DS2482 answers at 0x1a"));
}

static void test_a_where_that_is_none_is_refused(void)
{
	static const char *const wrong[] = {":",      ":0x17",    ":0x20", ":0x18.8",
	                                    ":0x18.", ":0x18.1x", "0x18",  ":x"};
	const struct ds2482_source source = {
		.open = ds_open_adapter, .destroy = ds_forget, .name = "test"};

	for (unsigned i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		TEST_ASSERT_EQUAL_INT(-EINVAL,
		                      ds2482_create(&ds_ops, &ds.host.env, &source, wrong[i],
		                                    &ds.master, ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_UINT(sizeof(wrong) / sizeof(wrong[0]), ds.closes);
}

static void test_only_a_part_with_a_supply_switch_cycles_the_power(void)
{
	ds_start(ds_kinds[1]);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, ds.wire->ops->recover(ds.wire, LINK_POWER_CYCLE));
	tearDown();
	ds_start(ds_kinds[6]);
	sim_net_slave(&ds.net, "t")->parasite = true;
	TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_POWER_CYCLE));
	TEST_ASSERT_EQUAL_UINT64(2, sim_net_slave(&ds.net, "t")->power_ons);
	ds_check_scratchpad();
}

static void test_a_shutdown_ends_every_call(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		uint8_t byte = 0;

		ds_start(ds_kinds[i]);
		ds.host.shutdown = true;
		TEST_ASSERT_EQUAL_INT(-ECANCELED, part_reset(ds.wire));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, part_write(ds.wire, &byte, 1, LINK_IDLE));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, part_read(ds.wire, &byte, 1));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, ds.wire->ops->triplet(ds.wire, false));
		ds.host.shutdown = false;
		tearDown();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_scratchpad_is_read_over_every_kind_of_adapter);
	RUN_TEST(test_slow_and_fast_chips_within_the_data_sheets_limits_are_waited_for);
	RUN_TEST(test_a_scratchpad_takes_few_transactions);
	RUN_TEST(test_most_of_the_time_is_the_wires);
	RUN_TEST(test_presence_nobody_and_a_short_are_told_apart);
	RUN_TEST(test_triplets_and_bits_read_the_wire);
	RUN_TEST(test_the_strong_pullup_feeds_a_parasite_until_the_next_call);
	RUN_TEST(test_the_strong_pullup_ends_with_the_adapter_also_at_a_shutdown);
	RUN_TEST(test_the_strong_pullup_ends_with_the_adapter_whenever_the_shutdown_comes);
	RUN_TEST(test_each_channel_of_an_800_is_its_own_wire);
	RUN_TEST(test_one_chip_or_one_channel_is_opened_when_it_is_named);
	RUN_TEST(test_a_where_that_is_none_is_refused);
	RUN_TEST(test_only_a_part_with_a_supply_switch_cycles_the_power);
	RUN_TEST(test_a_shutdown_ends_every_call);
	return UNITY_END();
}
