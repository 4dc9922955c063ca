/* SPDX-License-Identifier: MIT */
/* Tests of the simulated i2c-tiny-usb adapter. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/kernel/tiny_usb.h"

static struct {
	uint8_t address;
	bool read;
	uint8_t data[64];
	size_t len;
	int answer;
	unsigned messages;
} bus;
static struct tiny_usb usb;
static uint8_t data[64];

static int message(void *ctx, uint8_t address, bool read, uint8_t *bytes, size_t len)
{
	TEST_ASSERT_EQUAL_PTR(&bus, ctx);
	TEST_ASSERT_TRUE(len <= sizeof(bus.data));
	bus.address = address;
	bus.read = read;
	bus.len = len;
	bus.messages++;
	if (read && !bus.answer)
		memset(bytes, 0x5a, len);
	else if (!read)
		memcpy(bus.data, bytes, len);
	return bus.answer;
}

void setUp(void)
{
	memset(&bus, 0, sizeof(bus));
	memset(data, 0, sizeof(data));
	usb = (struct tiny_usb){.message = message, .ctx = &bus};
}

void tearDown(void)
{
}

static int control(uint8_t type, uint8_t request, uint16_t value, uint16_t index, uint16_t len)
{
	const uint8_t setup[8] = {
		type,           request,
		(uint8_t)value, (uint8_t)(value >> 8),
		(uint8_t)index, (uint8_t)(index >> 8),
		(uint8_t)len,   (uint8_t)(len >> 8),
	};

	return tiny_usb_control(&usb, setup, data, sizeof(data));
}

static int i2c_status(void)
{
	TEST_ASSERT_EQUAL_INT(1, control(0xc1, 3, 0, 0, 1));
	return data[0];
}

static void test_the_kernel_finds_the_ids_of_its_driver(void)
{
	static const uint8_t ids[] = {0x03, 0x04, 0x31, 0xc6};

	TEST_ASSERT_EQUAL_INT(18, control(0x80, 6, 0x100, 0, 64));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(ids, data + 8, sizeof(ids));
}

static void test_a_descriptor_is_cut_to_what_was_asked_for(void)
{
	TEST_ASSERT_EQUAL_INT(9, control(0x80, 6, 0x200, 0, 9));
	TEST_ASSERT_EQUAL_UINT8(18, data[2]);
	TEST_ASSERT_EQUAL_UINT8(0, data[9]);
}

static void test_descriptors_that_a_full_speed_device_lacks_stall(void)
{
	TEST_ASSERT_EQUAL_INT(-EPIPE, control(0x80, 6, 0x600, 0, 10));
	TEST_ASSERT_EQUAL_INT(-EPIPE, control(0x80, 6, 0xf00, 0, 5));
	TEST_ASSERT_EQUAL_INT(-EPIPE, control(0x80, 6, 0x309, 0x409, 255));
}

static void test_the_delay_is_taken(void)
{
	TEST_ASSERT_EQUAL_INT(0, control(0x41, 2, 10, 0, 0));
}

static void test_a_write_reaches_the_address_and_is_acknowledged(void)
{
	data[0] = 0xd2;
	data[1] = 0xe1;
	TEST_ASSERT_EQUAL_INT(2, control(0x41, 7, 0, 0x18, 2));
	TEST_ASSERT_EQUAL_HEX8(0x18, bus.address);
	TEST_ASSERT_FALSE(bus.read);
	TEST_ASSERT_EQUAL_INT(2, (int)bus.len);
	TEST_ASSERT_EQUAL_HEX8(0xe1, bus.data[1]);
	TEST_ASSERT_EQUAL_INT(1, i2c_status());
}

static void test_a_read_brings_the_bytes(void)
{
	TEST_ASSERT_EQUAL_INT(3, control(0xc1, 6, 1, 0x1b, 3));
	TEST_ASSERT_TRUE(bus.read);
	TEST_ASSERT_EQUAL_HEX8(0x5a, data[2]);
	TEST_ASSERT_EQUAL_HEX8(0, data[3]);
}

static void test_a_refused_address_moves_all_and_is_told_by_the_status(void)
{
	bus.answer = -ENXIO;
	TEST_ASSERT_EQUAL_INT(2, control(0x41, 7, 0, 0x19, 2));
	TEST_ASSERT_EQUAL_INT(2, i2c_status());
	bus.answer = 0;
	TEST_ASSERT_EQUAL_INT(0, control(0x41, 7, 0, 0x18, 0));
	TEST_ASSERT_EQUAL_INT(1, i2c_status());
}

static void test_refused_data_stalls(void)
{
	bus.answer = -EIO;
	TEST_ASSERT_EQUAL_INT(-EPIPE, control(0x41, 7, 0, 0x18, 2));
}

static void test_no_random_request_leaves_its_room(void)
{
	const unsigned seed = 403;

	srand(seed);
	for (int round = 0; round < 20000; round++) {
		uint8_t setup[8], room[16 + 8];
		int moved;

		memset(room, 0xa5, sizeof(room));
		for (unsigned i = 0; i < sizeof(setup); i++)
			setup[i] = (uint8_t)(rand() >> 3);
		moved = tiny_usb_control(&usb, setup, room, 16);
		TEST_ASSERT_TRUE_MESSAGE(moved == -EPIPE || (moved >= 0 && moved <= 16),
		                         "seed 403");
		TEST_ASSERT_EACH_EQUAL_HEX8_MESSAGE(0xa5, room + 16, 8, "seed 403");
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_kernel_finds_the_ids_of_its_driver);
	RUN_TEST(test_a_descriptor_is_cut_to_what_was_asked_for);
	RUN_TEST(test_descriptors_that_a_full_speed_device_lacks_stall);
	RUN_TEST(test_the_delay_is_taken);
	RUN_TEST(test_a_write_reaches_the_address_and_is_acknowledged);
	RUN_TEST(test_a_read_brings_the_bytes);
	RUN_TEST(test_a_refused_address_moves_all_and_is_told_by_the_status);
	RUN_TEST(test_refused_data_stalls);
	RUN_TEST(test_no_random_request_leaves_its_room);
	return UNITY_END();
}
