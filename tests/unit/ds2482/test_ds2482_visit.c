/* SPDX-License-Identifier: MIT */
/*
 * A whole transaction of one chip in few I2C transfers: its bytes, its time, how many messages; and
 * that a chip which becomes slower gives errors and no false bytes.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/ds2482/visit.h"
#include "hal/sim/crc.h"
#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

#define US INT64_C(1000)
#define LOOKS 8 /* after so many resets and bytes it is known how long they take */

static uint8_t out[10], in[9];
static int visit_err;
static unsigned limit; /* of the scratchpad: no other is the same */

static struct i2c_adapter_ops ops;
static const struct i2c_adapter_ops *true_ops;
static unsigned transfers, messages;
static int64_t longest_ns;

void setUp(void)
{
	ds_begin();
	limit = 0;
}

void tearDown(void)
{
	ds_end();
}

static int count_transfer(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *list,
                          size_t n)
{
	int64_t begun = ds.host.now;
	int err = true_ops->transfer(adapter, address, list, n);

	transfers++;
	messages += (unsigned)n;
	if (ds.host.now - begun > longest_ns)
		longest_ns = ds.host.now - begun;
	return err;
}

/* Write Scratchpad by the link's own functions: a limit that the last reading has not had. */
static void mark(void)
{
	uint8_t settings[13];

	memcpy(settings, out, 9);
	settings[9] = 0x4e;
	settings[10] = (uint8_t)(limit = (limit + 1) % 100);
	settings[11] = 100;
	settings[12] = 0x7f;
	TEST_ASSERT_EQUAL_INT(1, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(0, part_write(ds.wire, settings, 13, LINK_IDLE));
}

static void begin(const char *adapter)
{
	char text[200];

	snprintf(text, sizeof(text),
	         "i2c %s\nchip DS2482-800 0x18\nchannel 3\nDS18B20 28.000000000001 as t\n",
	         adapter);
	ds_start(text);
	ds.wire = ds.master->ops->channel(ds.master, 3);
	true_ops = ds.adapter.adapter.ops;
	ops = *true_ops;
	ops.transfer = count_transfer;
	ds.adapter.adapter.ops = &ops;
	out[0] = 0x55;
	memcpy(out + 1, sim_net_slave(&ds.net, "t")->rom, 8);
	mark();
}

/* The chip shows itself busy behind Convert T, or gives its scratchpad. Returns the time. */
static int64_t run(uint8_t command)
{
	int64_t begun = ds.host.now;

	out[9] = command;
	memset(in, 0xa5, sizeof(in));
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .in = in, .in_n = command == 0xbe ? 9 : 1};

	transfers = messages = 0;
	longest_ns = 0;
	visit_err = ds.wire->ops->run(ds.wire, &part);
	TEST_ASSERT_LESS_OR_EQUAL_INT(0, visit_err);
	return ds.host.now - begun;
}

static bool is_right(void)
{
	return visit_err == 0 && sim_crc8(0, in, 9) == 0 && in[2] == limit && in[3] == 100;
}

static void learn(void)
{
	for (unsigned i = 0; i < LOOKS; i++)
		mark();
}

static const char *const adapters[] = {"speed 400 combine any", "speed 400 combine one-read",
                                       "speed 100 combine any", "speed 800 combine any"};
#define ADAPTERS (sizeof(adapters) / sizeof(adapters[0]))

static void test_it_gives_the_chips_bytes(void)
{
	for (unsigned a = 0; a < ADAPTERS; a++)
		for (int percent = 95; percent <= 105; percent++) {
			begin(adapters[a]);
			TEST_ASSERT_TRUE(ds2482_visits(ds2482_link_of(ds.wire)->chip));
			ds.net.chip[0].percent = percent;
			for (unsigned n = 0; n < 3 * LOOKS; n++) {
				mark();
				run(0xbe);
				TEST_ASSERT_TRUE_MESSAGE(is_right(), adapters[a]);
			}
			tearDown();
			setUp();
		}
}

/* The slots alone take 11.72 and 7.28 ms; by the longest times of the data sheet 14.0 and 8.6. */
static void test_it_takes_little_longer_than_its_slots(void)
{
	begin(adapters[0]);
	TEST_ASSERT_LESS_THAN_INT64(14100 * US, run(0xbe));
	learn();
	TEST_ASSERT_LESS_THAN_INT64(13400 * US, run(0xbe));
	TEST_ASSERT_TRUE(is_right());
	TEST_ASSERT_LESS_THAN_INT64(7950 * US, run(0x44));
	TEST_ASSERT_EQUAL_INT(0, visit_err);
	TEST_ASSERT_EQUAL_HEX8(0, in[0]);
}

/* A read ends what some adapters combine. Nobody holds the I2C bus longer than for ten bytes. */
static void test_it_takes_few_transfers(void)
{
	begin(adapters[0]);
	learn();
	run(0xbe);
	TEST_ASSERT_EQUAL_UINT(2, transfers);
	TEST_ASSERT_EQUAL_UINT(2 + 2 * 10 + 3 * 9 + 2, messages);
	TEST_ASSERT_LESS_THAN_INT64(8 * HOST_MS, longest_ns);
	run(0x44);
	TEST_ASSERT_EQUAL_UINT(1, transfers);
	TEST_ASSERT_EQUAL_UINT(2 + 2 * 10 + 3 + 2, messages);
	tearDown();
	setUp();
	begin(adapters[1]);
	run(0xbe);
	TEST_ASSERT_EQUAL_UINT(1 + 10 + 9 + 1, transfers);
	run(0x44);
	TEST_ASSERT_EQUAL_UINT(1 + 10 + 1 + 1, transfers);
}

/* One that takes few messages in a transfer, down to what one byte that is read needs. */
static void test_an_adapter_may_take_few_messages(void)
{
	for (unsigned most = 3; most <= 42; most++) {
		begin(adapters[0]);
		learn();
		ds.adapter.adapter.max_messages = most;
		run(0xbe);
		TEST_ASSERT_TRUE(is_right());
		TEST_ASSERT_LESS_OR_EQUAL_UINT(most < 5 ? 21 : 60 / (most / 5), transfers);
		tearDown();
		setUp();
	}
}

static void test_where_waits_are_timed_it_is_not_used(void)
{
	static const char *const slow[] = {"speed 400 combine smbus", "speed 100 combine one-read"};

	for (unsigned a = 0; a < 2; a++) {
		begin(slow[a]);
		TEST_ASSERT_FALSE(ds2482_visits(ds2482_link_of(ds.wire)->chip));
		tearDown();
		setUp();
	}
}

/*
 * Suddenly by a tenth, or by some thousandths from one to the next, while bytes are written and
 * read by turns: the chip refuses what comes too early. Each refusal makes the pauses longer.
 */
static void check_slower(const char *adapter, int from, int to, unsigned marks)
{
	unsigned errors = 0, last = 0;

	begin(adapter);
	ds.net.chip[0].percent = from;
	learn();
	run(0xbe);
	TEST_ASSERT_TRUE(is_right());
	ds.net.chip[0].percent = to;
	for (unsigned n = 1; n <= 60; n++) {
		for (unsigned i = 0; i < marks; i++)
			mark();
		run(0xbe);
		if (visit_err) {
			TEST_ASSERT_TRUE(visit_err == -EIO || visit_err == -ENXIO);
			errors++;
			last = n;
			continue;
		}
		TEST_ASSERT_TRUE_MESSAGE(is_right(), adapter);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT(2, errors);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(8, last);
	tearDown();
	setUp();
}

static void test_a_chip_that_becomes_slower_refuses_and_lies_not(void)
{
	for (unsigned a = 0; a < ADAPTERS; a++)
		for (int from = 95; from < 105; from++)
			for (int to = from + 1; to <= 105; to++)
				for (unsigned marks = 0; marks < 2; marks++)
					check_slower(adapters[a], from, to, marks);
}

static void test_a_chip_that_becomes_slower_is_refused_once_at_least(void)
{
	begin(adapters[0]);
	ds.net.chip[0].percent = 95;
	learn();
	ds.net.chip[0].percent = 105;
	run(0xbe);
	TEST_ASSERT_LESS_THAN_INT(0, visit_err);
	/* What the link's functions do meanwhile is right. */
	mark();
	run(0xbe);
	TEST_ASSERT_TRUE(is_right());
}

static void test_what_is_wrong_is_told(void)
{
	static const struct {
		const char *event;
		int err;
	} troubles[] = {{"unplug t", -EHOSTDOWN}, {"short 0x18.3", -ECOMM}, {"stick 0x18", 0},
	                {"sleep 0x18", -EIO},     {"reset 0x18", 0},        {"jam 0x18", 0}};

	for (unsigned a = 0; a < ADAPTERS; a++)
		for (unsigned k = 0; k < sizeof(troubles) / sizeof(troubles[0]); k++) {
			begin(adapters[a]);
			learn();
			ds_event(troubles[k].event);
			TEST_ASSERT_LESS_THAN_INT64(40 * HOST_MS, run(0xbe));
			TEST_ASSERT_LESS_THAN_INT_MESSAGE(0, visit_err, troubles[k].event);
			if (troubles[k].err)
				TEST_ASSERT_EQUAL_INT_MESSAGE(troubles[k].err, visit_err,
				                              troubles[k].event);
			tearDown();
			setUp();
		}
}

/* At any moment of it. */
static void test_a_chip_that_restarts_meanwhile_gives_no_false_bytes(void)
{
	for (unsigned a = 0; a < 2; a++) {
		unsigned errors = 0;

		for (int64_t at = 0; at < 13 * HOST_MS; at += 97 * US) {
			begin(adapters[a]);
			learn();
			TEST_ASSERT_EQUAL_INT(
				0, sim_net_add_event(&ds.net, &(struct sim_event){
								      .what = SIM_CHIP_RESET,
								      .chip = 0,
								      .at_ns = ds.net.time + at}));
			run(0xbe);
			errors += visit_err != 0;
			TEST_ASSERT_TRUE(visit_err || is_right());
			tearDown();
			setUp();
		}
		TEST_ASSERT_GREATER_THAN_UINT(120, errors);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_gives_the_chips_bytes);
	RUN_TEST(test_it_takes_little_longer_than_its_slots);
	RUN_TEST(test_it_takes_few_transfers);
	RUN_TEST(test_an_adapter_may_take_few_messages);
	RUN_TEST(test_where_waits_are_timed_it_is_not_used);
	RUN_TEST(test_a_chip_that_becomes_slower_refuses_and_lies_not);
	RUN_TEST(test_a_chip_that_becomes_slower_is_refused_once_at_least);
	RUN_TEST(test_what_is_wrong_is_told);
	RUN_TEST(test_a_chip_that_restarts_meanwhile_gives_no_false_bytes);
	return UNITY_END();
}
