/* SPDX-License-Identifier: MIT */
/* What goes wrong under the driver of the DS2482, and how it comes back. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/ds2482/i2c_master.h"
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

static void test_a_chip_that_restarted_is_noticed_and_set_up_again(void)
{
	for (unsigned i = 0; i < 6; i++) {
		uint8_t scratchpad[9];
		int err = 0;

		ds_start(ds_kinds[i]);
		ds_check_scratchpad();
		ds_event("reset 0x18");
		TEST_ASSERT_EQUAL_INT(-ENXIO, ds_read_scratchpad("t", scratchpad));
		TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
		TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
		TEST_ASSERT_EQUAL_HEX8(SIM_APU, ds.net.chip[0].config);
		ds_check_scratchpad();
		/* And in the middle of a call. */
		TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
		TEST_ASSERT_EQUAL_INT(
			0, sim_net_add_event(&ds.net,
		                             &(struct sim_event){.what = SIM_CHIP_RESET,
		                                                 .at_ns = ds.net.time + 2000000}));
		err = part_read(ds.wire, scratchpad, 9);
		TEST_ASSERT_EQUAL_INT(-ENXIO, err);
		tearDown();
	}
}

static void test_a_stuck_chip_is_an_error_in_time_and_a_reset_frees_it(void)
{
	for (unsigned i = 0; i < 6; i++) {
		int64_t begun;

		ds_start(ds_kinds[i]);
		ds_event("stick 0x18");
		begun = ds.host.now;
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, part_reset(ds.wire));
		TEST_ASSERT_LESS_THAN_INT64(50 * HOST_MS, ds.host.now - begun);
		TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
		ds_check_scratchpad();
		ds_event("jam 0x18");
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, part_reset(ds.wire));
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, ds.wire->ops->recover(ds.wire, LINK_BUS_RESET));
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
		ds_event("end jam 0x18");
		TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
		ds_check_scratchpad();
		tearDown();
	}
}

/* What is read back behind this command is not what was written. */
static int (*reads_back)(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
                         size_t n);
static uint8_t untaken;

static int read_back_another(struct i2c_adapter *adapter, uint8_t address,
                             struct i2c_message *messages, size_t n)
{
	int err = reads_back(adapter, address, messages, n);

	if (!err && n == 2 && messages[0].data[0] == untaken)
		messages[1].data[0] ^= 1;
	return err;
}

static void test_a_chip_that_takes_no_configuration_or_channel_is_not_used(void)
{
	static struct i2c_adapter_ops ops;

	ds_start("chip DS2482-800 0x18\nchannel 5\nDS18B20 28.000000000001 as t");
	ds.wire = ds.master->ops->channel(ds.master, 5);
	ops = *ds.adapter.adapter.ops;
	reads_back = ops.transfer;
	ops.transfer = read_back_another;
	ds.adapter.adapter.ops = &ops;
	untaken = DS2482_WRITE_CONFIG;
	TEST_ASSERT_EQUAL_INT(-ENXIO, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	untaken = DS2482_CHANNEL;
	TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	untaken = 0;
	TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	ds_check_scratchpad();
}

static void test_one_refused_byte_does_not_fail_the_reset_of_a_chip(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		ds_start(ds_kinds[i]);
		ds.net.refuse_address[0] = (struct refusal){.each = 1000, .count = 999};
		TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
		TEST_ASSERT_LESS_THAN_UINT32(999, ds.net.refuse_address[0].count % 1000);
		ds_check_scratchpad();
		tearDown();
	}
}

/* A chip with eight channels that refuses a byte is none with one channel. */
static void test_one_refused_byte_makes_no_other_chip_of_one_that_is_opened(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		ds_start(ds_kinds[i]);
		unsigned channels = ds.master->ops->channels(ds.master), opened = 0;
		for (unsigned nth = 1; nth < 40; nth++) {
			ds.master->ops->close(ds.master);
			ds.net.refuse_data[0] = (struct refusal){.each = 1000, .count = 1000 - nth};
			if (ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)))
				continue;
			opened++;
			TEST_ASSERT_EQUAL_UINT(channels, ds.master->ops->channels(ds.master));
		}
		TEST_ASSERT_GREATER_THAN_UINT(0, opened);
		tearDown();
	}
}

/* However far it came before it refused a byte, it is asked again. */
static void test_a_second_chip_that_is_disturbed_at_the_start_is_not_left_out(void)
{
	unsigned later = 0;

	for (unsigned each = 5; each < 60; each++) {
		char scenario[160];
		int left = 1;

		snprintf(scenario, sizeof(scenario),
		         "i2c speed 400 combine any\nchip DS2482-800 0x18\nchip DS2482-100 0x1c\n"
		         "at 0s refuse-data 0x1c each %u\n",
		         each);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, ds_try_open(scenario, ""), ds.why);
		later += ds.master->ops->channels(ds.master) == 8;
		ds_event("end refuse-data 0x1c");
		for (unsigned i = 0; i < 2 && left == 1; i++)
			left = ds.master->ops->grow(ds.master, ds.why, sizeof(ds.why));
		TEST_ASSERT_EQUAL_INT(0, left);
		TEST_ASSERT_EQUAL_UINT(9, ds.master->ops->channels(ds.master));
		tearDown();
	}
	TEST_ASSERT_GREATER_THAN_UINT(0, later);
}

/* The chip saw it (SD), and the line is high again when it is asked. */
static void test_a_short_that_ends_within_the_reset_is_a_short(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		struct sim_event event = {.what = SIM_SHORT, .on = true};

		ds_start(ds_kinds[i]);
		event.at_ns = ds.host.now - ds.net.epoch;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&ds.net, &event));
		event.on = false;
		event.at_ns += 1100000;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&ds.net, &event));
		TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(ds.wire));
		ds_check_scratchpad();
		tearDown();
	}
}

/* Now and then the process does not run for longer than any operation takes. */
static int (*wait_in_time)(void *ctx, int fd, short events, int64_t until_ns);
static uint32_t gaps;

static int wait_with_gaps(void *ctx, int fd, short events, int64_t until_ns)
{
	int ret = wait_in_time(ctx, fd, events, until_ns);

	gaps = gaps * 1664525 + 1013904223;
	if ((gaps >> 16) % 4 == 0)
		ds.host.now += 40 * HOST_MS;
	return ret;
}

static void test_a_process_that_was_not_scheduled_takes_no_chip_for_stuck(void)
{
	for (unsigned i = 0; i < DS_KINDS; i++) {
		for (uint32_t seed = 1; seed <= 20; seed++) {
			char text[40];

			host_init_virtual(&ds.host);
			wait_in_time = ds.host.env.wait;
			ds.host.env.wait = wait_with_gaps;
			gaps = seed;
			snprintf(text, sizeof(text), "kind %u, seed %u", i, seed);
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, ds_try_open(ds_kinds[i], ""), text);
			ds.wire = ds.master->ops->channel(ds.master, 0);
			for (unsigned n = 0; n < 5; n++)
				TEST_ASSERT_EQUAL_INT_MESSAGE(1, part_reset(ds.wire), text);
			tearDown();
		}
	}
}

static void test_a_missing_chip_is_taken_when_it_is_there_again(void)
{
	ds_start("chip DS2482-800 0x18\nchannel 5\nDS2401 01.000000000001\n"
	         "chip DS2482-100 0x1c\nDS18B20 28.000000000001 as t");
	TEST_ASSERT_EQUAL_UINT(9, ds.master->ops->channels(ds.master));
	TEST_ASSERT_EQUAL_INT(0, ds.master->ops->grow(ds.master, ds.why, sizeof(ds.why)));
	ds_event("refuse 0x18");
	ds.master->ops->close(ds.master);
	TEST_ASSERT_EQUAL_INT(0, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_UINT(1, ds.master->ops->channels(ds.master));
	TEST_ASSERT_EQUAL_INT(1, ds.master->ops->grow(ds.master, ds.why, sizeof(ds.why)));
	TEST_ASSERT_NOT_NULL(strstr(ds.why, "0x18"));
	ds.wire = ds.master->ops->channel(ds.master, 0);
	ds_check_scratchpad();
	ds_event("end refuse 0x18");
	TEST_ASSERT_EQUAL_INT(0, ds.master->ops->grow(ds.master, ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_UINT(9, ds.master->ops->channels(ds.master));
	ds_check_scratchpad();
	ds.wire = ds.master->ops->channel(ds.master, 6);
	TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
}

static void test_a_refused_call_is_an_error_and_the_next_one_works(void)
{
	for (unsigned i = 0; i < 6; i++) {
		uint8_t scratchpad[9];

		ds_start(ds_kinds[i]);
		ds_event("refuse 0x18 for 1ms");
		TEST_ASSERT_EQUAL_INT(-EIO, part_reset(ds.wire));
		ds.host.now += 5 * HOST_MS;
		ds_check_scratchpad();
		ds_event("refuse-data 0x18 each 15");
		TEST_ASSERT_EQUAL_INT(-EIO, ds_read_scratchpad("t", scratchpad));
		ds_event("end refuse-data 0x18");
		ds_check_scratchpad();
		tearDown();
	}
}

static void test_an_adapter_that_is_gone_comes_back_by_opening_it_again(void)
{
	uint8_t scratchpad[9];
	struct link_master_cost shared, shared_after;
	struct link_cost before, after;

	ds_start(ds_kinds[1]);
	ds_check_scratchpad();
	ds.wire->ops->cost(ds.wire, &before);
	ds.master->ops->cost(ds.master, &shared);
	ds_event("remove adapter for 2s");
	TEST_ASSERT_EQUAL_INT(-ENODEV, ds_read_scratchpad("t", scratchpad));
	ds.master->ops->close(ds.master);
	TEST_ASSERT_EQUAL_INT(-ENODEV, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(-ENODEV, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-ENODEV, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)));
	ds.host.now += 3 * HOST_S;
	TEST_ASSERT_EQUAL_INT(0, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)));
	ds_check_scratchpad();
	ds.wire->ops->cost(ds.wire, &after);
	ds.master->ops->cost(ds.master, &shared_after);
	TEST_ASSERT_GREATER_THAN_UINT64(shared.transfers, shared_after.transfers);
	TEST_ASSERT_GREATER_THAN_UINT64(before.wire_ns, after.wire_ns);
}

/* On a channel that is not the one a restarted chip has, with somebody else on that one. */
static void harass(const char *i2c, uint32_t seed)
{
	static const enum sim_what faults[] = {SIM_CHIP_RESET, SIM_STICK,       SIM_JAM,
	                                       SIM_REFUSE,     SIM_REFUSE_DATA, SIM_CHIP_SLEEP};
	unsigned good = 0, bad = 0;
	uint32_t first = seed;
	char text[200];

	snprintf(text, sizeof(text),
	         "%s\nchip DS2482-800 0x18\nDS18B20 28.000000000002 as other\n"
	         "channel 5\nDS18B20 28.000000000001 as t",
	         i2c);
	ds_start(text);
	ds.wire = ds.master->ops->channel(ds.master, 5);
	for (unsigned round = 0; round < 300; round++) {
		static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
		struct sim_event event = {.at_ns = ds.net.time, .on = true};
		uint8_t scratchpad[9];
		int err;

		seed = seed * 1664525 + 1013904223;
		event.what = faults[(seed >> 8) % 6];
		event.at_ns += (seed >> 12) % 25000000;
		event.each = 1 + (seed >> 16) % 9;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&ds.net, &event));
		event.on = false;
		event.at_ns += (seed >> 4) % 7000000;
		if (event.what != SIM_CHIP_RESET)
			TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&ds.net, &event));
		snprintf(text, sizeof(text), "seed %u, round %u, fault %d", first, round,
		         event.what);
		err = ds_read_scratchpad("t", scratchpad);
		if (err == 0) {
			TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(expect, scratchpad, 5, text);
			good++;
			continue;
		}
		TEST_ASSERT_TRUE_MESSAGE(err == -EIO || err == -ENXIO || err == -ETIMEDOUT, text);
		bad++;
		for (unsigned i = 0; i < 10 && ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET); i++)
			ds.host.now += 10 * HOST_MS;
	}
	ds.host.now += 100 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	ds_check_scratchpad();
	TEST_ASSERT_GREATER_THAN_UINT(20, good);
	TEST_ASSERT_GREATER_THAN_UINT(20, bad);
	tearDown();
}

static void test_whatever_happens_data_without_an_error_are_right(void)
{
	for (uint32_t seed = 1; seed <= 5; seed++) {
		harass("i2c speed 400 combine any", seed);
		harass("i2c speed 400 combine one-read", seed);
		harass("i2c speed 100 combine any", seed);
		harass("i2c speed 100 combine one-read", seed);
		harass("i2c speed 100 combine smbus", seed);
	}
}

static void test_a_bus_that_became_faster_is_learned_from_what_comes_too_early(void)
{
	for (unsigned i = 0; i < 4; i++) {
		unsigned errors = 0;

		ds_start(ds_kinds[i]);
		ds.net.hz *= 2; /* a core clock that changed */
		for (unsigned n = 0; n < 30; n++) {
			uint8_t scratchpad[9];
			int err = ds_read_scratchpad("t", scratchpad);

			TEST_ASSERT_TRUE(err == 0 || err == -EIO);
			errors += err != 0;
			if (!err)
				TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
		}
		TEST_ASSERT_LESS_THAN_UINT(20, errors);
		ds_check_scratchpad();
		tearDown();
	}
}

/* Opening it fails; what it says is kept. */
static int open_refused(const char *where)
{
	int err;

	TEST_ASSERT_EQUAL_INT(0, ds2482_i2c_master.create(where, &ds.host.env, &ds.master, ds.why,
	                                                  sizeof(ds.why)));
	err = ds.master->ops->open(ds.master, ds.why, sizeof(ds.why));
	TEST_ASSERT_EQUAL_UINT(0, ds.master->ops->channels(ds.master));
	ds.master->ops->destroy(ds.master);
	ds.master = NULL;
	if (err == -EOPNOTSUPP)
		TEST_ASSERT_NOT_NULL(strstr(ds.why, "built without libi2c"));
	return err;
}

static void test_an_adapter_that_cannot_be_opened_says_what_to_do(void)
{
	int err = open_refused("/dev/i2c-no-such");

	if (err != -EOPNOTSUPP) {
		TEST_ASSERT_EQUAL_INT(-ENODEV, err);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(ds.why, "no /dev/i2c-no-such: switch I2C on"),
		                             ds.why);
	}
	TEST_ASSERT_EQUAL_INT(-EINVAL, ds2482_i2c_master.create("i2c-1", &ds.host.env, &ds.master,
	                                                        ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_INT(-EINVAL,
	                      ds2482_i2c_master.create("/dev/i2c-1:0x40", &ds.host.env, &ds.master,
	                                               ds.why, sizeof(ds.why)));
	TEST_ASSERT_NULL(ds.master);
}

static void test_a_file_that_is_no_adapter_is_told(void)
{
	int err = open_refused("/dev/null:0x18.3");

	if (err == -ENOSYS)
		TEST_IGNORE_MESSAGE("this emulator passes no ioctl of I2C on");
	if (err == -EOPNOTSUPP)
		return;
	TEST_ASSERT_EQUAL_INT(-ENOTTY, err);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(ds.why, "/dev/null is no I2C adapter"), ds.why);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_chip_that_restarted_is_noticed_and_set_up_again);
	RUN_TEST(test_a_stuck_chip_is_an_error_in_time_and_a_reset_frees_it);
	RUN_TEST(test_a_chip_that_takes_no_configuration_or_channel_is_not_used);
	RUN_TEST(test_one_refused_byte_does_not_fail_the_reset_of_a_chip);
	RUN_TEST(test_one_refused_byte_makes_no_other_chip_of_one_that_is_opened);
	RUN_TEST(test_a_second_chip_that_is_disturbed_at_the_start_is_not_left_out);
	RUN_TEST(test_a_short_that_ends_within_the_reset_is_a_short);
	RUN_TEST(test_a_process_that_was_not_scheduled_takes_no_chip_for_stuck);
	RUN_TEST(test_a_missing_chip_is_taken_when_it_is_there_again);
	RUN_TEST(test_a_refused_call_is_an_error_and_the_next_one_works);
	RUN_TEST(test_an_adapter_that_is_gone_comes_back_by_opening_it_again);
	RUN_TEST(test_whatever_happens_data_without_an_error_are_right);
	RUN_TEST(test_a_bus_that_became_faster_is_learned_from_what_comes_too_early);
	RUN_TEST(test_an_adapter_that_cannot_be_opened_says_what_to_do);
	RUN_TEST(test_a_file_that_is_no_adapter_is_told);
	return UNITY_END();
}
