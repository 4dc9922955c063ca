/* SPDX-License-Identifier: MIT */
/*
 * Adapters that take long for each message of a transfer, as over USB: few messages, and nothing
 * false where they become quicker.
 */
#include <errno.h>
#include <string.h>

#include "hal/ds2482/master.h"
#include "unity.h"

#include "hal/ds2482/visit.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/ds2482_scene.h"

#define US INT64_C(1000)

static struct i2c_adapter_ops ops;
static const struct i2c_adapter_ops *true_ops;
static int64_t between_ns;
static uint32_t jitter; /* 0: none */
static unsigned messages;
static bool is_plain; /* the driver knows one error for whatever is refused */
static bool is_whole; /* read in a transaction that is made as a whole (visit.h) */

void setUp(void)
{
	ds_begin();
	jitter = 0;
	messages = 0;
	is_whole = false;
}

void tearDown(void)
{
	ds_end();
}

static void pass(void)
{
	int64_t ns = between_ns;

	messages++;
	if (jitter) {
		jitter = jitter * 1664525 + 1013904223;
		ns += (jitter >> 16) % 1000 * US;
	}
	ds.host.now += ns;
}

/* Message by message, as the kernel's driver of such an adapter sends them. */
static int transfer(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *list,
                    size_t n)
{
	int err = 0;

	for (size_t i = 0; !err && i < n; i++) {
		err = true_ops->transfer(adapter, address, &list[i], 1);
		pass();
	}
	return err == -EIO && is_plain ? -ENXIO : err;
}

static int write_byte(struct i2c_adapter *adapter, uint8_t address, uint8_t command)
{
	int err = true_ops->write_byte(adapter, address, command);

	pass();
	return err;
}

static int write_byte_data(struct i2c_adapter *adapter, uint8_t address, uint8_t command,
                           uint8_t byte)
{
	int err = true_ops->write_byte_data(adapter, address, command, byte);

	pass();
	return err;
}

static int read_byte(struct i2c_adapter *adapter, uint8_t address)
{
	int err = true_ops->read_byte(adapter, address);

	pass();
	return err;
}

static int open_slow(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                     size_t size)
{
	int err = ds_open_adapter(ctx, env, out, text, size);

	if (err)
		return err;
	true_ops = (*out)->ops;
	ops = *true_ops;
	ops.transfer = transfer;
	ops.write_byte = write_byte;
	ops.write_byte_data = write_byte_data;
	ops.read_byte = read_byte;
	(*out)->ops = &ops;
	return 0;
}

static void begin(int64_t ns)
{
	const struct ds2482_source source = {
		.open = open_slow, .destroy = ds_forget, .name = "test"};

	between_ns = ns;
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_parse("test", ds_kinds[2], &ds.net, ds.why, sizeof(ds.why)),
		ds.why);
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ds_ops, &ds.host.env, &source, "", &ds.master,
	                                       ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)),
	                              ds.why);
	ds.wire = ds.master->ops->channel(ds.master, 0);
}

/*
 * Reset and ten bytes written, one message each; nine bytes read, three each; three statuses. The
 * messages themselves take 0.28 ms and what the adapter takes.
 */
static void test_where_messages_are_slow_a_written_byte_is_one(void)
{
	static const struct {
		int64_t between_us, most_ms;
	} paces[] = {{150, 26}, {250, 29}, {350, 34}, {400, 36}, {1000, 64}};

	for (unsigned i = 0; i < sizeof(paces) / sizeof(paces[0]); i++) {
		begin(paces[i].between_us * US);
		messages = 0;
		int64_t begun = ds.host.now;

		ds_check_scratchpad();
		TEST_ASSERT_LESS_OR_EQUAL_UINT(1 + 10 + 3 * 9 + 2 + 2, messages);
		TEST_ASSERT_LESS_THAN_INT64(paces[i].most_ms * HOST_MS, ds.host.now - begun);
		tearDown();
		setUp();
	}
}

static int visit(uint8_t scratchpad[9])
{
	uint8_t out[10] = {0x55};
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .in = scratchpad, .in_n = 9};

	memcpy(out + 1, sim_net_slave(&ds.net, "t")->rom, 8);
	out[9] = 0xbe;
	return ds.wire->ops->run(ds.wire, &part);
}

/* As a whole there is one status at the end. */
static void test_where_messages_are_slow_a_whole_reading_has_the_fewest(void)
{
	static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
	uint8_t scratchpad[9];

	for (int64_t between = 600; between <= 1800; between += 600) {
		begin(between * US);
		TEST_ASSERT_TRUE(ds2482_visits(ds2482_link_of(ds.wire)->chip));
		messages = 0;
		TEST_ASSERT_EQUAL_INT(0, visit(scratchpad));
		TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, scratchpad, 5);
		TEST_ASSERT_EQUAL_UINT(1 + (between < 1200) + 10 + 3 * 9 + 2, messages);
		tearDown();
		setUp();
	}
}

/* A transaction of a group has some 40 messages: two of those take longer than others may wait. */
static void test_where_messages_are_slow_there_are_no_groups(void)
{
	begin(1000 * US);
	TEST_ASSERT_EQUAL_UINT(1, ds.wire->ops->many(ds.wire));
	tearDown();
	setUp();
	begin(0);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2, ds.wire->ops->many(ds.wire));
}

/* Then the time of a byte is waited for by reading on. */
static void test_where_messages_are_quick_there_is_one_more_between(void)
{
	begin(0);
	messages = 0;
	ds_check_scratchpad();
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(1 + 2 * 10 + 3 * 9, messages);
}

/* Some errors at first, and then it works as ever; what is read is right. */
static void check_settles(void)
{
	static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
	unsigned errors = 0, last = 0;

	for (unsigned n = 1; n <= 60; n++) {
		uint8_t scratchpad[9];

		if (is_whole ? visit(scratchpad) : ds_read_scratchpad("t", scratchpad)) {
			errors++;
			last = n;
			continue;
		}
		TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, scratchpad, 5);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT(8, errors);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(jitter ? 45 : 12, last);
	tearDown();
	setUp();
}

/* Slow while it is measured, then of any pace. */
static void become_quick(void)
{
	static const int64_t later[] = {0, 50, 100, 200, 250, 300, 350, 380};

	for (unsigned i = 0; i < sizeof(later) / sizeof(later[0]); i++) {
		begin(400 * US);
		between_ns = later[i] * US;
		check_settles();
		begin(250 * US);
		between_ns = later[i] / 2 * US;
		check_settles();
	}
}

static void test_a_whole_reading_becomes_quick_the_same_way(void)
{
	static const int64_t later[] = {0, 50, 100, 200, 250, 300, 350, 380};

	for (unsigned i = 0; i < 2 * sizeof(later) / sizeof(later[0]); i++) {
		begin((i & 1 ? 600 : 400) * US);
		between_ns = later[i / 2] * US;
		is_whole = true;
		check_settles();
	}
}

static void test_an_adapter_that_becomes_quick_gives_errors_and_no_false_bytes(void)
{
	is_plain = false;
	become_quick();
}

static void test_a_refused_command_is_noticed_by_either_error(void)
{
	is_plain = true;
	become_quick();
	is_plain = false;
}

static void test_an_adapter_of_changing_pace_is_right_too(void)
{
	for (uint32_t seed = 1; seed <= 60; seed++) {
		jitter = seed;
		begin(seed % 5 * 100 * US);
		check_settles();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_where_messages_are_slow_a_written_byte_is_one);
	RUN_TEST(test_where_messages_are_slow_a_whole_reading_has_the_fewest);
	RUN_TEST(test_where_messages_are_slow_there_are_no_groups);
	RUN_TEST(test_where_messages_are_quick_there_is_one_more_between);
	RUN_TEST(test_a_whole_reading_becomes_quick_the_same_way);
	RUN_TEST(test_an_adapter_that_becomes_quick_gives_errors_and_no_false_bytes);
	RUN_TEST(test_a_refused_command_is_noticed_by_either_error);
	RUN_TEST(test_an_adapter_of_changing_pace_is_right_too);
	return UNITY_END();
}
