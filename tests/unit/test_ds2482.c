/* SPDX-License-Identifier: MIT */
/* The driver over the simulated chip, in virtual time. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "hal/ds2482/ds2482.h"
#include "hal/sim/adapter.h"
#include "hal/sim/crc.h"
#include "hal/sim/scenario.h"
#include "tests/unit/host.h"
#include "unity.h"

static struct host host;
static struct sim_net net;
static struct sim_adapter adapter;
static struct link_master *master;
static struct link *wire;
static unsigned closes;
static char why[200];

void setUp(void)
{
	host_init_virtual(&host);
	closes = 0;
}

void tearDown(void)
{
	if (master)
		master->ops->destroy(master);
	master = NULL;
	sim_net_clear(&net);
}

static int open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                        size_t size)
{
	(void)ctx, (void)text, (void)size;
	sim_net_run(&net, env->now(env->ctx));
	if (!net.plugged)
		return -ENODEV;
	sim_adapter_init(&adapter, &net, env);
	*out = &adapter.adapter;
	return 0;
}

static void forget(void *ctx)
{
	(void)ctx;
	closes++;
}

static const struct link_master_ops ops = {
	.scheme = "test",
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.destroy = ds2482_destroy,
};

static int try_open(const char *scenario, const char *where)
{
	const struct ds2482_source source = {
		.open = open_adapter, .destroy = forget, .name = "test"};
	int err = sim_scenario_parse("test", scenario, &net, why, sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ops, &host.env, &source, where, &master, why,
	                                       sizeof(why)));
	return master->ops->open(master, why, sizeof(why));
}

static void start(const char *scenario)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(scenario, ""), why);
	wire = master->ops->channel(master, 0);
}

static void event(const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_event(&net, text, host.now, why, sizeof(why)), why);
}

/* Reset, Match ROM, Read Scratchpad and its nine bytes. */
static int read_scratchpad(const char *name, uint8_t scratchpad[9])
{
	uint8_t out[10] = {0x55};
	int err = wire->ops->reset(wire);

	if (err < 0)
		return err;
	memcpy(out + 1, sim_net_slave(&net, name)->rom, 8);
	out[9] = 0xBE;
	err = wire->ops->write(wire, out, 10, LINK_IDLE);
	return err ? err : wire->ops->read(wire, scratchpad, 9);
}

static void check_scratchpad(void)
{
	static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
	uint8_t scratchpad[9];

	TEST_ASSERT_EQUAL_INT(0, read_scratchpad("t", scratchpad));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, scratchpad, 5);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
}

#define KINDS 8
static const char *const kinds[KINDS] = {
	"i2c speed 400 combine any\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine one-read\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine any\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine one-read\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine smbus\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine smbus\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine any messages 5\nchip DS2484 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 50 combine one-read\nchip DS2482-800 0x1f\nDS18B20 28.000000000001 as t",
};

static void test_a_scratchpad_is_read_over_every_kind_of_adapter(void)
{
	for (unsigned i = 0; i < KINDS; i++) {
		start(kinds[i]);
		for (unsigned n = 0; n < 3; n++)
			check_scratchpad();
		tearDown();
	}
}

static void test_slow_and_fast_chips_within_the_data_sheets_limits_are_waited_for(void)
{
	for (unsigned i = 0; i < 6; i++) {
		for (int percent = 95; percent <= 105; percent += 5) {
			start(kinds[i]);
			net.chip[0].percent = percent;
			check_scratchpad();
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

		start(kinds[i]);
		wire->ops->cost(wire, &before);
		master->ops->cost(master, &shared);
		check_scratchpad();
		wire->ops->cost(wire, &after);
		master->ops->cost(master, &shared_after);
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

		start(kinds[i]);
		wire->ops->cost(wire, &before);
		begun = host.now;
		check_scratchpad();
		wire->ops->cost(wire, &after);
		ratio = (double)(host.now - begun) / (double)(after.wire_ns - before.wire_ns);
		snprintf(text, sizeof(text), "kind %u: %.3f", i, ratio);
		TEST_ASSERT_TRUE_MESSAGE(ratio <= most[i], text);
		tearDown();
	}
}

static void test_presence_nobody_and_a_short_are_told_apart(void)
{
	for (unsigned i = 0; i < KINDS; i++) {
		start(kinds[i]);
		TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
		event("unplug t");
		TEST_ASSERT_EQUAL_INT(0, wire->ops->reset(wire));
		event(i == 7 ? "short 0x1f" : "short 0x18");
		TEST_ASSERT_EQUAL_INT(-ECOMM, wire->ops->reset(wire));
		event(i == 7 ? "end short 0x1f" : "end short 0x18");
		event("plug t");
		TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
		check_scratchpad();
		tearDown();
	}
}

static void test_triplets_and_bits_read_the_wire(void)
{
	const uint8_t search = 0xF0;

	start(kinds[1]);
	TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->write(wire, &search, 1, LINK_IDLE));
	for (unsigned i = 0; i < 8; i++) /* 28h, least bit first */
		TEST_ASSERT_EQUAL_INT(0x28 >> i & 1 ? 1 | 4 : 2, wire->ops->triplet(wire, i & 1));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->bit(wire, true, LINK_IDLE)); /* 0, and its complement */
	TEST_ASSERT_EQUAL_INT(1, wire->ops->bit(wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->bit(wire, false, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(3 | 4, wire->ops->triplet(wire, false)); /* nobody */
}

static void test_the_strong_pullup_feeds_a_parasite_until_the_next_call(void)
{
	static const uint8_t convert[2] = {0xCC, 0x44};

	for (unsigned i = 0; i < KINDS; i++) {
		struct sim_slave *slave;
		uint8_t scratchpad[9];

		start(kinds[i]);
		slave = sim_net_slave(&net, "t");
		slave->parasite = true;
		slave->input[0] = sim_constant(25.0625);
		for (unsigned n = 0; n < 2; n++) {
			TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
			TEST_ASSERT_EQUAL_INT(0, wire->ops->write(wire, convert, 2, LINK_STRONG));
			/* Who waits counts from the call's end. */
			host.now += 750 * HOST_MS;
			TEST_ASSERT_EQUAL_INT(0, read_scratchpad("t", scratchpad));
			TEST_ASSERT_EQUAL_HEX8(0x91, scratchpad[0]);
		}
		TEST_ASSERT_EQUAL_UINT64(1, slave->power_ons);
		tearDown();
	}
}

static void test_each_channel_of_an_800_is_its_own_wire(void)
{
	start("chip DS2482-800 0x1a\nchannel 0\nDS2401 01.000000000001\n"
	      "channel 6\nDS18B20 28.000000000001 as t");
	TEST_ASSERT_EQUAL_UINT(8, master->ops->channels(master));
	for (unsigned i = 0; i < 8; i++) {
		wire = master->ops->channel(master, i);
		TEST_ASSERT_EQUAL_INT(i == 0 || i == 6, wire->ops->reset(wire));
	}
	wire = master->ops->channel(master, 6);
	check_scratchpad();
}

static void test_one_chip_or_one_channel_is_opened_when_it_is_named(void)
{
	static const char *const two = "chip DS2482-100 0x18\nchip DS2482-800 0x1c\nchannel 3\n"
	                               "DS18B20 28.000000000001 as t";

	start(two);
	TEST_ASSERT_EQUAL_UINT(9, master->ops->channels(master));
	tearDown();
	TEST_ASSERT_EQUAL_INT(0, try_open(two, ":0x1c"));
	TEST_ASSERT_EQUAL_UINT(8, master->ops->channels(master));
	tearDown();
	TEST_ASSERT_EQUAL_INT(0, try_open(two, ":0x1c.3"));
	TEST_ASSERT_EQUAL_UINT(1, master->ops->channels(master));
	wire = master->ops->channel(master, 0);
	check_scratchpad();
	TEST_ASSERT_NULL(master->ops->channel(master, 1));
	tearDown();
	TEST_ASSERT_EQUAL_INT(-ENXIO, try_open(two, ":0x18.3"));
	TEST_ASSERT_NOT_NULL(strstr(why, "one channel"));
	tearDown();
	TEST_ASSERT_EQUAL_INT(-ENXIO, try_open(two, ":0x1a"));
	TEST_ASSERT_NOT_NULL(strstr(why, "no DS2482 answers at 0x1a"));
}

static void test_a_where_that_is_none_is_refused(void)
{
	static const char *const wrong[] = {":", ":0x17", ":0x20", ":0x18.8", ":0x18.", ":0x18.1x",
	                                    "0x18", ":x"};
	const struct ds2482_source source = {
		.open = open_adapter, .destroy = forget, .name = "test"};

	for (unsigned i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		TEST_ASSERT_EQUAL_INT(-EINVAL, ds2482_create(&ops, &host.env, &source, wrong[i],
		                                             &master, why, sizeof(why)));
	TEST_ASSERT_EQUAL_UINT(sizeof(wrong) / sizeof(wrong[0]), closes);
}

/* A part that takes everything and answers with its own registers, as an MCP9808 does. */
static unsigned second_bytes;

static int other_write_byte(struct i2c_adapter *base, uint8_t address, uint8_t command)
{
	(void)base, (void)address, (void)command;
	return 0;
}

static int other_write_byte_data(struct i2c_adapter *base, uint8_t address, uint8_t command,
                                 uint8_t data)
{
	(void)base, (void)address, (void)command, (void)data;
	second_bytes++;
	return 0;
}

static int other_transfer(struct i2c_adapter *base, uint8_t address, struct i2c_message *messages,
                          size_t n)
{
	(void)base, (void)address;
	for (size_t i = 0; i < n; i++)
		second_bytes += !(messages[i].flags & I2C_MESSAGE_READ) && messages[i].len > 1;
	return 0;
}

static uint8_t other_value;
static int other_read_byte(struct i2c_adapter *base, uint8_t address)
{
	(void)base, (void)address;
	return other_value;
}

static int other_claim(struct i2c_adapter *base, uint8_t address)
{
	(void)base, (void)address;
	return 0;
}

static void other_close(struct i2c_adapter *base)
{
	(void)base;
}

static const struct i2c_adapter_ops other_ops = {
	.transfer = other_transfer,
	.write_byte = other_write_byte,
	.write_byte_data = other_write_byte_data,
	.read_byte = other_read_byte,
	.claim = other_claim,
	.close = other_close,
};
static struct i2c_adapter other = {.ops = &other_ops, .combine = I2C_ANY, .max_messages = 42};

static int open_other(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                      size_t size)
{
	(void)ctx, (void)env, (void)text, (void)size;
	*out = &other;
	return 0;
}

static void test_other_parts_never_get_a_second_byte(void)
{
	const struct ds2482_source source = {
		.open = open_other, .destroy = forget, .name = "test"};

	second_bytes = 0;
	for (unsigned value = 0; value < 256; value++) {
		if ((value & 0xE1) == 0 && (value & DS2482_RST))
			continue; /* would be a DS2482 by all that can be seen */
		other_value = (uint8_t)value;
		TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ops, &host.env, &source, "", &master, why,
		                                       sizeof(why)));
		TEST_ASSERT_EQUAL_INT(-ENXIO, master->ops->open(master, why, sizeof(why)));
		master->ops->destroy(master);
		master = NULL;
	}
	TEST_ASSERT_EQUAL_UINT(0, second_bytes);
}

static int held_claim(struct i2c_adapter *base, uint8_t address)
{
	base->holder = getpid();
	return address == 0x1a ? -EADDRINUSE : 0;
}

static unsigned released;
static void count_release(struct i2c_adapter *base, uint8_t address)
{
	(void)base;
	TEST_ASSERT_NOT_EQUAL_UINT(0x1a, address);
	released++;
}

static void test_a_chip_of_another_process_is_left_alone_and_said(void)
{
	const struct ds2482_source source = {
		.open = open_other, .destroy = forget, .name = "test"};
	struct i2c_adapter_ops held_ops = other_ops;
	char name[16] = "", holder[80];

	/* an emulator runs us under its own name */
	TEST_ASSERT_EQUAL_INT(0, prctl(PR_GET_NAME, name));
	snprintf(holder, sizeof(holder), "0x1a on test is in use by %s (process", name);
	held_ops.claim = held_claim;
	held_ops.release = count_release;
	other.ops = &held_ops;
	other_value = 0xff;
	released = 0;
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ops, &host.env, &source, "", &master, why,
	                                       sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-EADDRINUSE, master->ops->open(master, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, holder), why);
	/* where nothing was found nobody is held off */
	TEST_ASSERT_EQUAL_UINT(DS2482_ADDRESSES - 1, released);
	other.ops = &other_ops;
}

static int driver_claim(struct i2c_adapter *base, uint8_t address)
{
	(void)base, (void)address;
	return -EBUSY;
}

static void driver_takes_it(void)
{
	static struct i2c_adapter_ops taken;

	taken = *adapter.adapter.ops;
	taken.claim = driver_claim;
	adapter.adapter.ops = &taken;
}

/* Its reset and configuration leave the chip as ours do. */
static void test_a_chip_that_a_driver_took_is_left_alone_soon(void)
{
	start("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 as t temperature 20\n");
	check_scratchpad();
	driver_takes_it();
	host.now += HOST_S;
	uint64_t transfers = adapter.adapter.transfers;
	TEST_ASSERT_EQUAL_INT(-ENXIO, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(-EBUSY, wire->ops->recover(wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-ENXIO, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_UINT64(transfers, adapter.adapter.transfers);
}

/* What looks like a restart may be a kernel driver that was bound to it: hands off. */
static void test_a_chip_that_a_driver_took_is_not_reset(void)
{
	start("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 as t temperature 20\n");
	event("reset 0x18");
	TEST_ASSERT_EQUAL_INT(-ENXIO, wire->ops->reset(wire));
	driver_takes_it();
	uint64_t transfers = adapter.adapter.transfers;
	TEST_ASSERT_EQUAL_INT(-EBUSY, wire->ops->recover(wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_UINT64(transfers, adapter.adapter.transfers);
}

static void test_a_chip_that_restarted_is_noticed_and_set_up_again(void)
{
	for (unsigned i = 0; i < 6; i++) {
		uint8_t scratchpad[9];
		int err = 0;

		start(kinds[i]);
		check_scratchpad();
		event("reset 0x18");
		TEST_ASSERT_EQUAL_INT(-ENXIO, read_scratchpad("t", scratchpad));
		TEST_ASSERT_EQUAL_INT(-ENXIO, wire->ops->reset(wire));
		TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_CHIP_RESET));
		TEST_ASSERT_EQUAL_HEX8(SIM_APU, net.chip[0].config);
		check_scratchpad();
		/* And in the middle of a call. */
		TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&net, &(struct sim_event){
		                                .what = SIM_CHIP_RESET,
		                                .at_ns = net.time + 2000000}));
		err = wire->ops->read(wire, scratchpad, 9);
		TEST_ASSERT_EQUAL_INT(-ENXIO, err);
		tearDown();
	}
}

static void test_a_stuck_chip_is_an_error_in_time_and_a_reset_frees_it(void)
{
	for (unsigned i = 0; i < 6; i++) {
		int64_t begun;

		start(kinds[i]);
		event("stick 0x18");
		begun = host.now;
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, wire->ops->reset(wire));
		TEST_ASSERT_LESS_THAN_INT64(50 * HOST_MS, host.now - begun);
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, wire->ops->recover(wire, LINK_RETRY));
		TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_CHIP_RESET));
		check_scratchpad();
		event("jam 0x18");
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, wire->ops->reset(wire));
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, wire->ops->recover(wire, LINK_CHIP_RESET));
		event("end jam 0x18");
		TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_CHIP_RESET));
		check_scratchpad();
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
		host.now += 40 * HOST_MS;
	return ret;
}

static void test_a_process_that_was_not_scheduled_takes_no_chip_for_stuck(void)
{
	for (unsigned i = 0; i < KINDS; i++) {
		for (uint32_t seed = 1; seed <= 20; seed++) {
			char text[40];

			host_init_virtual(&host);
			wait_in_time = host.env.wait;
			host.env.wait = wait_with_gaps;
			gaps = seed;
			snprintf(text, sizeof(text), "kind %u, seed %u", i, seed);
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, try_open(kinds[i], ""), text);
			wire = master->ops->channel(master, 0);
			for (unsigned n = 0; n < 5; n++)
				TEST_ASSERT_EQUAL_INT_MESSAGE(1, wire->ops->reset(wire), text);
			tearDown();
		}
	}
}

static void test_a_missing_chip_is_taken_when_it_is_there_again(void)
{
	start("chip DS2482-800 0x18\nchannel 5\nDS2401 01.000000000001\n"
	      "chip DS2482-100 0x1c\nDS18B20 28.000000000001 as t");
	TEST_ASSERT_EQUAL_UINT(9, master->ops->channels(master));
	TEST_ASSERT_EQUAL_INT(0, master->ops->grow(master, why, sizeof(why)));
	event("refuse 0x18");
	master->ops->close(master);
	TEST_ASSERT_EQUAL_INT(0, master->ops->open(master, why, sizeof(why)));
	TEST_ASSERT_EQUAL_UINT(1, master->ops->channels(master));
	TEST_ASSERT_EQUAL_INT(1, master->ops->grow(master, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "0x18"));
	wire = master->ops->channel(master, 0);
	check_scratchpad();
	event("end refuse 0x18");
	TEST_ASSERT_EQUAL_INT(0, master->ops->grow(master, why, sizeof(why)));
	TEST_ASSERT_EQUAL_UINT(9, master->ops->channels(master));
	check_scratchpad();
	wire = master->ops->channel(master, 6);
	TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
}

static void test_a_refused_call_is_an_error_and_the_next_one_works(void)
{
	for (unsigned i = 0; i < 6; i++) {
		uint8_t scratchpad[9];

		start(kinds[i]);
		event("refuse 0x18 for 1ms");
		TEST_ASSERT_EQUAL_INT(-EIO, wire->ops->reset(wire));
		host.now += 5 * HOST_MS;
		TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_RETRY));
		check_scratchpad();
		event("refuse-data 0x18 each 15");
		TEST_ASSERT_EQUAL_INT(-EIO, read_scratchpad("t", scratchpad));
		event("end refuse-data 0x18");
		TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_RETRY));
		check_scratchpad();
		tearDown();
	}
}

static void test_an_adapter_that_is_gone_comes_back_by_opening_it_again(void)
{
	uint8_t scratchpad[9];
	struct link_master_cost shared, shared_after;
	struct link_cost before, after;

	start(kinds[1]);
	check_scratchpad();
	wire->ops->cost(wire, &before);
	master->ops->cost(master, &shared);
	event("remove adapter for 2s");
	TEST_ASSERT_EQUAL_INT(-ENODEV, read_scratchpad("t", scratchpad));
	master->ops->close(master);
	TEST_ASSERT_EQUAL_INT(-ENODEV, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(-ENODEV, wire->ops->recover(wire, LINK_REOPEN));
	host.now += 3 * HOST_S;
	TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_REOPEN));
	check_scratchpad();
	wire->ops->cost(wire, &after);
	master->ops->cost(master, &shared_after);
	TEST_ASSERT_GREATER_THAN_UINT64(shared.transfers, shared_after.transfers);
	TEST_ASSERT_GREATER_THAN_UINT64(before.wire_ns, after.wire_ns);
}

static void test_only_a_part_with_a_supply_switch_cycles_the_power(void)
{
	start(kinds[1]);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, wire->ops->recover(wire, LINK_POWER_CYCLE));
	tearDown();
	start(kinds[6]);
	sim_net_slave(&net, "t")->parasite = true;
	TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_POWER_CYCLE));
	TEST_ASSERT_EQUAL_UINT64(2, sim_net_slave(&net, "t")->power_ons);
	check_scratchpad();
}

static void test_overdrive_is_the_links_own(void)
{
	const uint8_t skip = 0x3C, read = 0xBE;
	uint8_t scratchpad[9];

	start("i2c speed 400 combine any\nchip DS2482-100 0x18\nDS28EA00 42.000000000001 as t");
	TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->write(wire, &skip, 1, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->speed(wire, LINK_OVERDRIVE));
	TEST_ASSERT_EQUAL_HEX8(SIM_1WS | SIM_APU, net.chip[0].config);
	TEST_ASSERT_EQUAL_INT(0, wire->ops->write(wire, &read, 1, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->read(wire, scratchpad, 9));
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
	TEST_ASSERT_EQUAL_HEX8(75, scratchpad[2]);
	TEST_ASSERT_EQUAL_INT(1, wire->ops->reset(wire));
	TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_BUS_RESET));
	TEST_ASSERT_EQUAL_HEX8(SIM_APU, net.chip[0].config);
	check_scratchpad();
}

static void test_a_shutdown_ends_every_call(void)
{
	for (unsigned i = 0; i < KINDS; i++) {
		uint8_t byte = 0;

		start(kinds[i]);
		host.shutdown = true;
		TEST_ASSERT_EQUAL_INT(-ECANCELED, wire->ops->reset(wire));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, wire->ops->write(wire, &byte, 1, LINK_IDLE));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, wire->ops->read(wire, &byte, 1));
		TEST_ASSERT_EQUAL_INT(-ECANCELED, wire->ops->triplet(wire, false));
		host.shutdown = false;
		tearDown();
	}
}

/* On a channel that is not the one a restarted chip has, with somebody else on that one. */
static void harass(const char *i2c, uint32_t seed)
{
	static const enum sim_what faults[] = {SIM_CHIP_RESET, SIM_STICK, SIM_JAM, SIM_REFUSE,
	                                       SIM_REFUSE_DATA, SIM_CHIP_SLEEP};
	unsigned good = 0, bad = 0;
	uint32_t first = seed;
	char text[200];

	snprintf(text, sizeof(text), "%s\nchip DS2482-800 0x18\nDS18B20 28.000000000002 as other\n"
	         "channel 5\nDS18B20 28.000000000001 as t", i2c);
	start(text);
	wire = master->ops->channel(master, 5);
	for (unsigned round = 0; round < 300; round++) {
		static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
		struct sim_event event = {.at_ns = net.time, .on = true};
		uint8_t scratchpad[9];
		int err;

		seed = seed * 1664525 + 1013904223;
		event.what = faults[(seed >> 8) % 6];
		event.at_ns += (seed >> 12) % 25000000;
		event.each = 1 + (seed >> 16) % 9;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&net, &event));
		event.on = false;
		event.at_ns += (seed >> 4) % 7000000;
		if (event.what != SIM_CHIP_RESET)
			TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&net, &event));
		snprintf(text, sizeof(text), "seed %u, round %u, fault %d", first, round, event.what);
		err = read_scratchpad("t", scratchpad);
		if (err == 0) {
			TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(expect, scratchpad, 5, text);
			good++;
			continue;
		}
		TEST_ASSERT_TRUE_MESSAGE(err == -EIO || err == -ENXIO || err == -ETIMEDOUT, text);
		bad++;
		for (unsigned i = 0; i < 10 && wire->ops->recover(wire, LINK_CHIP_RESET); i++)
			host.now += 10 * HOST_MS;
	}
	host.now += 100 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, wire->ops->recover(wire, LINK_CHIP_RESET));
	check_scratchpad();
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

		start(kinds[i]);
		net.hz *= 2; /* a core clock that changed */
		for (unsigned n = 0; n < 30; n++) {
			uint8_t scratchpad[9];
			int err = read_scratchpad("t", scratchpad);

			TEST_ASSERT_TRUE(err == 0 || err == -EIO);
			errors += err != 0;
			if (!err)
				TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
		}
		TEST_ASSERT_LESS_THAN_UINT(20, errors);
		check_scratchpad();
		tearDown();
	}
}

/* Opening it fails; what it says is kept. */
static int open_refused(const char *where)
{
	int err;

	TEST_ASSERT_EQUAL_INT(0, ds2482_i2c_master.create(where, &host.env, &master, why,
	                                                  sizeof(why)));
	err = master->ops->open(master, why, sizeof(why));
	TEST_ASSERT_EQUAL_UINT(0, master->ops->channels(master));
	master->ops->destroy(master);
	master = NULL;
	if (err == -EOPNOTSUPP)
		TEST_ASSERT_NOT_NULL(strstr(why, "built without libi2c"));
	return err;
}

static void test_an_adapter_that_cannot_be_opened_says_what_to_do(void)
{
	int err = open_refused("/dev/i2c-no-such");

	if (err != -EOPNOTSUPP) {
		TEST_ASSERT_EQUAL_INT(-ENODEV, err);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "no /dev/i2c-no-such: switch I2C on"), why);
	}
	TEST_ASSERT_EQUAL_INT(-EINVAL, ds2482_i2c_master.create("i2c-1", &host.env, &master, why,
	                                                        sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, ds2482_i2c_master.create("/dev/i2c-1:0x40", &host.env,
	                                                        &master, why, sizeof(why)));
	TEST_ASSERT_NULL(master);
}

static void test_a_file_that_is_no_adapter_is_told(void)
{
	int err = open_refused("/dev/null:0x18.3");

	if (err == -ENOSYS)
		TEST_IGNORE_MESSAGE("this emulator passes no ioctl of I2C on");
	if (err == -EOPNOTSUPP)
		return;
	TEST_ASSERT_EQUAL_INT(-ENOTTY, err);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "/dev/null is no I2C adapter"), why);
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
	RUN_TEST(test_each_channel_of_an_800_is_its_own_wire);
	RUN_TEST(test_one_chip_or_one_channel_is_opened_when_it_is_named);
	RUN_TEST(test_a_where_that_is_none_is_refused);
	RUN_TEST(test_other_parts_never_get_a_second_byte);
	RUN_TEST(test_a_chip_of_another_process_is_left_alone_and_said);
	RUN_TEST(test_a_chip_that_a_driver_took_is_left_alone_soon);
	RUN_TEST(test_a_chip_that_a_driver_took_is_not_reset);
	RUN_TEST(test_a_chip_that_restarted_is_noticed_and_set_up_again);
	RUN_TEST(test_a_stuck_chip_is_an_error_in_time_and_a_reset_frees_it);
	RUN_TEST(test_a_process_that_was_not_scheduled_takes_no_chip_for_stuck);
	RUN_TEST(test_a_missing_chip_is_taken_when_it_is_there_again);
	RUN_TEST(test_a_refused_call_is_an_error_and_the_next_one_works);
	RUN_TEST(test_an_adapter_that_is_gone_comes_back_by_opening_it_again);
	RUN_TEST(test_only_a_part_with_a_supply_switch_cycles_the_power);
	RUN_TEST(test_overdrive_is_the_links_own);
	RUN_TEST(test_a_shutdown_ends_every_call);
	RUN_TEST(test_a_bus_that_became_faster_is_learned_from_what_comes_too_early);
	RUN_TEST(test_an_adapter_that_cannot_be_opened_says_what_to_do);
	RUN_TEST(test_a_file_that_is_no_adapter_is_told);
	RUN_TEST(test_whatever_happens_data_without_an_error_are_right);
	return UNITY_END();
}
