/* SPDX-License-Identifier: MIT */
/* Other parts, other processes and kernel drivers at the addresses of a DS2482. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "hal/ds2482/master.h"
#include "unity.h"

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
		.open = open_other, .destroy = ds_forget, .name = "test"};

	second_bytes = 0;
	for (unsigned value = 0; value < 256; value++) {
		if ((value & 0xE1) == 0 && (value & DS2482_RST))
			continue; /* would be a DS2482 by all that can be seen */
		other_value = (uint8_t)value;
		TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ds_ops, &ds.host.env, &source, "",
		                                       &ds.master, ds.why, sizeof(ds.why)));
		TEST_ASSERT_EQUAL_INT(-ENXIO,
		                      ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)));
		ds.master->ops->destroy(ds.master);
		ds.master = NULL;
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
		.open = open_other, .destroy = ds_forget, .name = "test"};
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
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ds_ops, &ds.host.env, &source, "", &ds.master,
	                                       ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_INT(-EADDRINUSE, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(ds.why, holder), ds.why);
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

	taken = *ds.adapter.adapter.ops;
	taken.claim = driver_claim;
	ds.adapter.adapter.ops = &taken;
}

/* Its reset and configuration leave the chip as ours do. */
static void test_a_chip_that_a_driver_took_is_left_alone_soon(void)
{
	ds_start("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 as t temperature 20\n");
	ds_check_scratchpad();
	driver_takes_it();
	ds.host.now += HOST_S;
	uint64_t transfers = ds.adapter.adapter.transfers;
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(-EBUSY, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_UINT64(transfers, ds.adapter.adapter.transfers);
}

/* What looks like a restart may be a kernel driver that was bound to it: hands off. */
static void test_a_chip_that_a_driver_took_is_not_reset(void)
{
	ds_start("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 as t temperature 20\n");
	ds_event("reset 0x18");
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	driver_takes_it();
	uint64_t transfers = ds.adapter.adapter.transfers;
	TEST_ASSERT_EQUAL_INT(-EBUSY, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_UINT64(transfers, ds.adapter.adapter.transfers);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_other_parts_never_get_a_second_byte);
	RUN_TEST(test_a_chip_of_another_process_is_left_alone_and_said);
	RUN_TEST(test_a_chip_that_a_driver_took_is_left_alone_soon);
	RUN_TEST(test_a_chip_that_a_driver_took_is_not_reset);
	return UNITY_END();
}
