/* SPDX-License-Identifier: MIT */
/* Transactions of several chips at the same time: whose bytes are whose, trouble, and time. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

#define CHIPS 5
/* The longest times of a reset and 19 bytes, and ten reads of the status or a register. */
#define ALONE_NS (INT64_C(1243200) + 19 * 8 * INT64_C(72800) + 3 * HOST_MS)

static uint8_t out[CHIPS][10], in[CHIPS][9];
static struct link_run run[CHIPS];

void setUp(void)
{
	ds_begin();
}

void tearDown(void)
{
	ds_end();
}

/* Four DS2482-100 and, last, channel 3 of a DS2482-800, each with a thermometer of its own. */
static void begin(const char *adapter)
{
	char text[600];
	int n = snprintf(text, sizeof(text), "i2c %s\n", adapter);

	for (unsigned i = 0; i < CHIPS; i++)
		n += snprintf(text + n, sizeof(text) - (size_t)n,
		              "chip DS2482-%s 0x%x\n%sDS18B20 28.00000000000%u as t%u\n",
		              i == 4 ? "800" : "100", 0x18 + i, i == 4 ? "channel 3\n" : "", i + 1,
		              i);
	ds_start(text);
	for (unsigned i = 0; i < CHIPS; i++) {
		char name[16];

		snprintf(name, sizeof(name), "t%u", i);
		out[i][0] = 0x55;
		memcpy(out[i] + 1, sim_net_slave(&ds.net, name)->rom, 8);
	}
}

/* Write Scratchpad alone: limits that nobody else has. */
static void mark(unsigned i)
{
	struct link *link = run[i].link;
	uint8_t settings[13];

	memcpy(settings, out[i], 9);
	settings[9] = 0x4e;
	settings[10] = (uint8_t)(10 + i);
	settings[11] = (uint8_t)(100 + i);
	settings[12] = 0x7f;
	TEST_ASSERT_EQUAL_INT(1, part_reset(link));
	TEST_ASSERT_EQUAL_INT(0, part_write(link, settings, 13, LINK_IDLE));
}

static void prepare(const char *adapter)
{
	begin(adapter);
	for (unsigned i = 0; i < CHIPS; i++) {
		out[i][9] = 0xbe;
		run[i] = (struct link_run){
			.link = ds.master->ops->channel(ds.master, i < 4 ? i : 4 + 3),
			.part = {.reset = true, .out = out[i], .out_n = 10, .in = in[i], .in_n = 9},
			.err = 1,
		};
		TEST_ASSERT_NOT_NULL(run[i].link);
		mark(i);
	}
	memset(in, 0, sizeof(in));
}

static bool is_right(unsigned i)
{
	return run[i].err == 0 && sim_crc8(0, in[i], 9) == 0 && in[i][2] == 10 + i &&
	       in[i][3] == 100 + i;
}

static int64_t together(void)
{
	int64_t begun = ds.host.now;

	run[0].link->ops->run_many(run, CHIPS);
	return ds.host.now - begun;
}

static void test_each_chip_gives_its_own_bytes(void)
{
	static const char *const adapters[] = {
		"speed 400 combine any", "speed 400 combine one-read", "speed 100 combine any",
		"speed 50 combine one-read"};

	for (unsigned a = 0; a < 4; a++)
		for (int percent = 95; percent <= 105; percent += 5) {
			prepare(adapters[a]);
			for (unsigned i = 0; i < CHIPS; i++)
				ds.net.chip[i].percent = i & 1 ? percent : 100;
			for (unsigned n = 0; n < 3; n++) {
				memset(in, 0, sizeof(in));
				together();
				for (unsigned i = 0; i < CHIPS; i++)
					TEST_ASSERT_TRUE_MESSAGE(is_right(i), adapters[a]);
			}
			tearDown();
			setUp();
		}
}

/* At 400 kHz a transaction takes 2.4 ms of the I2C bus, and 12 ms of its chip. */
static void test_five_take_little_longer_than_one(void)
{
	prepare("speed 400 combine any");
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(CHIPS, run[0].link->ops->many(run[0].link));
	TEST_ASSERT_LESS_THAN_INT64(ALONE_NS + 4 * HOST_MS, together());
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(CHIPS, run[0].link->ops->many(run[0].link));
}

/* At 100 kHz there is time for two; where bytes take no known time, nobody can tell. */
static void test_a_slow_bus_takes_fewer(void)
{
	prepare("speed 100 combine any");
	TEST_ASSERT_EQUAL_UINT(2, run[0].link->ops->many(run[0].link));
	tearDown();
	setUp();
	prepare("speed 50 combine any");
	TEST_ASSERT_EQUAL_UINT(1, run[0].link->ops->many(run[0].link));
	tearDown();
	setUp();
	prepare("speed 400 combine smbus");
	TEST_ASSERT_EQUAL_UINT(1, run[0].link->ops->many(run[0].link));
}

static int64_t call_ns;
static int (*wait_plainly)(void *ctx, int fd, short events, int64_t until_ns);

static int wait_longer(void *ctx, int fd, short events, int64_t until_ns)
{
	int ret = wait_plainly(ctx, fd, events, until_ns);

	ds.host.now += call_ns;
	return ret;
}

/* An adapter that takes long for a call, whatever its bytes take: it learns that. */
static void test_an_adapter_with_slow_calls_gets_fewer_at_a_time(void)
{
	prepare("speed 400 combine any");
	unsigned before = run[0].link->ops->many(run[0].link);

	wait_plainly = ds.host.env.wait;
	ds.host.env.wait = wait_longer;
	call_ns = HOST_MS / 4;
	for (unsigned n = 0; n < 40; n++)
		together();
	TEST_ASSERT_LESS_THAN_UINT(before, run[0].link->ops->many(run[0].link));
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2, run[0].link->ops->many(run[0].link));
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_TRUE(is_right(i));
}

static void test_trouble_of_one_chip_is_no_trouble_of_the_others(void)
{
	static const struct {
		const char *event;
		int alone; /* what reset() says behind it */
	} troubles[] = {
		{"stick 0x1a", -ETIMEDOUT}, {"jam 0x1a", -ETIMEDOUT},   {"sleep 0x1a", -EIO},
		{"refuse 0x1a", -EIO},      {"refuse-data 0x1a", -EIO}, {"short 0x1a", -ECOMM},
		{"unplug t2", 0},           {"reset 0x1a", -ENXIO},
	};

	for (unsigned k = 0; k < sizeof(troubles) / sizeof(troubles[0]); k++) {
		prepare("speed 400 combine any");
		ds_event(troubles[k].event);
		TEST_ASSERT_LESS_THAN_INT64_MESSAGE(ALONE_NS + 4 * HOST_MS, together(),
		                                    troubles[k].event);
		for (unsigned i = 0; i < CHIPS; i++)
			if (i != 2)
				TEST_ASSERT_TRUE_MESSAGE(is_right(i), troubles[k].event);
		TEST_ASSERT_LESS_THAN_INT_MESSAGE(0, run[2].err, troubles[k].event);
		/* What the link says next is what it would have said without all that. */
		TEST_ASSERT_EQUAL_INT_MESSAGE(troubles[k].alone, part_reset(run[2].link),
		                              troubles[k].event);
		tearDown();
		setUp();
	}
}

/* At any moment of it, by the time and by the bytes on the bus. */
static void test_a_chip_that_restarts_meanwhile_gives_no_false_bytes(void)
{
	unsigned wrong = 0, errors = 0;

	for (int64_t at = 0; at < ALONE_NS; at += 97000) {
		prepare("speed 400 combine any");
		TEST_ASSERT_EQUAL_INT(
			0,
			sim_net_add_event(&ds.net, &(struct sim_event){.what = SIM_CHIP_RESET,
		                                                       .chip = 3,
		                                                       .at_ns = ds.net.time + at}));
		together();
		for (unsigned i = 0; i < CHIPS; i++)
			if (i != 3)
				TEST_ASSERT_TRUE(is_right(i));
		errors += run[3].err != 0;
		wrong += run[3].err == 0 && !is_right(3);
		tearDown();
		setUp();
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(80, errors);
}

static void test_an_adapter_that_goes_ends_all_of_them(void)
{
	prepare("speed 400 combine any");
	TEST_ASSERT_EQUAL_INT(
		0, sim_net_add_event(&ds.net, &(struct sim_event){.what = SIM_ADAPTER,
	                                                          .on = false,
	                                                          .at_ns = ds.net.time + 3000000}));
	TEST_ASSERT_LESS_THAN_INT64(10 * HOST_MS, together());
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_EQUAL_INT(-ENODEV, run[i].err);
}

static struct i2c_adapter_ops held;
static unsigned transfers;

static int time_out(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
                    size_t n)
{
	(void)adapter, (void)address, (void)messages, (void)n;
	transfers++;
	ds.host.now += 100 * HOST_MS;
	return -ETIMEDOUT;
}

/* Each transfer of a bus that is held takes the kernel's time-out: none but the first is made. */
static void test_a_bus_that_is_held_ends_all_of_them(void)
{
	prepare("speed 400 combine any");
	held = *ds.adapter.adapter.ops;
	held.transfer = time_out;
	ds.adapter.adapter.ops = &held;
	transfers = 0;
	together();
	TEST_ASSERT_EQUAL_UINT(1, transfers);
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, run[i].err);
}

static void test_a_shutdown_ends_all_of_them(void)
{
	prepare("speed 400 combine any");
	ds.host.shutdown = true;
	TEST_ASSERT_LESS_THAN_INT64(10 * HOST_MS, together());
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_LESS_THAN_INT(0, run[i].err);
}

/* What was armed for the strong pull-up, and what a chip is busy with, is seen to first. */
static void test_they_begin_where_the_last_call_has_ended(void)
{
	static const uint8_t byte = 0;

	prepare("speed 100 combine one-read");
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_EQUAL_INT(
			0, part_write(run[i].link, &byte, 1, i & 1 ? LINK_STRONG : LINK_IDLE));
	together();
	for (unsigned i = 0; i < CHIPS; i++)
		TEST_ASSERT_TRUE(is_right(i));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_chip_gives_its_own_bytes);
	RUN_TEST(test_five_take_little_longer_than_one);
	RUN_TEST(test_a_slow_bus_takes_fewer);
	RUN_TEST(test_an_adapter_with_slow_calls_gets_fewer_at_a_time);
	RUN_TEST(test_trouble_of_one_chip_is_no_trouble_of_the_others);
	RUN_TEST(test_a_chip_that_restarts_meanwhile_gives_no_false_bytes);
	RUN_TEST(test_an_adapter_that_goes_ends_all_of_them);
	RUN_TEST(test_a_bus_that_is_held_ends_all_of_them);
	RUN_TEST(test_a_shutdown_ends_all_of_them);
	RUN_TEST(test_they_begin_where_the_last_call_has_ended);
	return UNITY_END();
}
