/* SPDX-License-Identifier: MIT */
/* MAX31888: a conversion begins when its checksum was read; results go through the FIFO. */
#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_max31888, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void expect_checksum(const uint8_t *head, unsigned head_n, const uint8_t *bytes, unsigned n)
{
	uint16_t crc = sim_crc16(sim_crc16(0, head, head_n), bytes, n);
	uint8_t sum[2];

	hand_read(&hand, sum, 2);
	TEST_ASSERT_EQUAL_HEX8((uint8_t)~crc, sum[0]);
	TEST_ASSERT_EQUAL_HEX8((uint8_t)(~crc >> 8), sum[1]);
}

static void get(uint8_t at, uint8_t *bytes, unsigned n)
{
	const uint8_t head[3] = {0x33, at, (uint8_t)(n - 1)};

	hand_skip(&hand, 3, head[0], head[1], head[2]);
	hand_read(&hand, bytes, n);
	expect_checksum(head, 3, bytes, n);
}

static uint8_t reg(uint8_t at)
{
	uint8_t byte;

	get(at, &byte, 1);
	return byte;
}

static void put(uint8_t at, uint8_t byte)
{
	const uint8_t head[4] = {0xCC, at, 0, byte};

	hand_skip(&hand, 4, head[0], head[1], head[2], head[3]);
	expect_checksum(head, 4, NULL, 0);
}

static void convert(void)
{
	const uint8_t command = 0x44;

	hand_skip(&hand, 1, command);
	expect_checksum(&command, 1, NULL, 0);
	hand.now += 18 * HAND_MS;
	sim_slave_advance(slave, hand.now);
}

static int result(void)
{
	uint8_t bytes[2];

	get(0x08, bytes, 2);
	return (int16_t)(bytes[0] << 8 | bytes[1]);
}

static void test_a_result_is_there_after_18_ms(void)
{
	slave->input[0] = sim_constant(37);
	convert();
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(1, reg(7), "in the FIFO");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(1, reg(0), "ready");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, reg(0), "until it is read");
	TEST_ASSERT_EQUAL_INT(7400, result());
	TEST_ASSERT_EQUAL_HEX8(0, reg(7));
	slave->input[0] = sim_constant(-10.25);
	convert();
	TEST_ASSERT_EQUAL_INT(-2050, result());
}

static void test_without_its_checksum_being_read_nothing_is_converted(void)
{
	hand_skip(&hand, 1, 0x44);
	hand.now += 50 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0, reg(7));
	hand_skip(&hand, 1, 0x44);
	hand_byte(&hand);
	hand.now += 50 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, reg(7), "one byte of two");
	TEST_ASSERT_EQUAL_UINT64(0, slave->conversions);
}

static void test_the_fifo_keeps_32_results_in_their_order_and_counts_the_others(void)
{
	for (int i = 0; i < 34; i++) {
		slave->input[0] = sim_constant(i);
		convert();
	}
	TEST_ASSERT_EQUAL_HEX8(32, reg(7));
	TEST_ASSERT_EQUAL_HEX8(2, reg(6));
	TEST_ASSERT_EQUAL_INT(0, result());
	TEST_ASSERT_EQUAL_INT(200, result());
	put(0x0A, 0x10);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, reg(7), "flushed");
}

static void test_the_alarm_limits_are_compared_with_each_result(void)
{
	slave->input[0] = sim_constant(20);
	put(0x10, 0x0F); /* 4000 is 20 degrees */
	put(0x11, 0x9F);
	convert();
	TEST_ASSERT_EQUAL_HEX8(0x03, reg(0));
	put(0x11, 0xA0);
	put(0x12, 0x0F);
	put(0x13, 0xA1);
	convert();
	TEST_ASSERT_EQUAL_HEX8(0x05, reg(0));
}

static void test_a_restart_empties_it(void)
{
	convert();
	put(0x10, 0x11);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0, reg(7));
	TEST_ASSERT_EQUAL_HEX8(0x7F, reg(0x10));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_result_is_there_after_18_ms);
	RUN_TEST(test_without_its_checksum_being_read_nothing_is_converted);
	RUN_TEST(test_the_fifo_keeps_32_results_in_their_order_and_counts_the_others);
	RUN_TEST(test_the_alarm_limits_are_compared_with_each_result);
	RUN_TEST(test_a_restart_empties_it);
	return UNITY_END();
}
