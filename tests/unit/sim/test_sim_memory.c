/* SPDX-License-Identifier: MIT */
/* DS2431, DS2433, DS2423 and DS2430A against their data sheets. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void check_crc16(const uint8_t *data, unsigned n)
{
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, data, n)); /* data and its inverted CRC */
}

/* Write Scratchpad to its end, with the checksum that follows. */
static void write_scratchpad(uint16_t at, uint8_t first, unsigned n)
{
	uint8_t out[40] = {0x0F, (uint8_t)at, (uint8_t)(at >> 8)};

	for (unsigned i = 0; i < n; i++)
		out[3 + i] = (uint8_t)(first + i);
	hand_skip(&hand, 0);
	hand_write(&hand, out, 3 + n);
	hand_read(&hand, out + 3 + n, 2);
	check_crc16(out, 5 + n);
}

static uint8_t read_scratchpad(uint16_t at, uint8_t first, unsigned n)
{
	uint8_t out[40] = {0xAA};

	hand_skip(&hand, 1, 0xAA);
	hand_read(&hand, out + 1, 5 + n);
	check_crc16(out, 6 + n);
	TEST_ASSERT_EQUAL_HEX16(at, out[1] | out[2] << 8);
	TEST_ASSERT_EQUAL_HEX8(first, out[4]);
	TEST_ASSERT_EQUAL_HEX8((uint8_t)(first + n - 1), out[3 + n]);
	return out[3];
}

static uint8_t memory_at(uint16_t at)
{
	hand_skip(&hand, 3, 0xF0, at & 0xFF, at >> 8);
	return hand_byte(&hand);
}

static void test_a_ds2431_is_written_by_scratchpad_and_key(void)
{
	slave = hand_plug(&hand, &sim_ds2431, 1);
	TEST_ASSERT_EQUAL_HEX8(0, memory_at(0x28));
	write_scratchpad(0x28, 0x50, 8);
	TEST_ASSERT_EQUAL_HEX8(0x07, read_scratchpad(0x28, 0x50, 8));
	hand_skip(&hand, 4, 0x55, 0x28, 0x00, 0x06); /* wrong key */
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand.now += 20 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0, memory_at(0x28));
	hand_skip(&hand, 4, 0x55, 0x28, 0x00, 0x07);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x50, memory_at(0x28));
	TEST_ASSERT_EQUAL_HEX8(0x57, memory_at(0x2F));
	TEST_ASSERT_EQUAL_HEX8(0x87, read_scratchpad(0x28, 0x50, 8)); /* AA is set */
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x50, memory_at(0x28));
	TEST_ASSERT_EQUAL_HEX8(0xAA, memory_at(0x85));
}

static void test_a_parasite_loses_the_copy_without_current(void)
{
	slave = hand_plug(&hand, &sim_ds2431, 1);
	slave->parasite = true;
	write_scratchpad(0, 1, 8);
	hand_skip(&hand, 4, 0x55, 0, 0, 7);
	sim_wire_strong(&hand.wire, true, hand.now);
	hand.now += 5 * HAND_MS;
	sim_wire_strong(&hand.wire, false, hand.now);
	hand.now += 20 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0, memory_at(0));
}

static void test_a_ds2433_copies_from_offset_to_end(void)
{
	slave = hand_plug(&hand, &sim_ds2433, 1);
	write_scratchpad(0x1F4, 0x10, 12); /* offset 14h to the end of the page */
	TEST_ASSERT_EQUAL_HEX8(0x1F, read_scratchpad(0x1F4, 0x10, 12));
	hand_skip(&hand, 4, 0x55, 0xF4, 0x01, 0x1F);
	hand.now += 6 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory_at(0x1F3));
	TEST_ASSERT_EQUAL_HEX8(0x10, memory_at(0x1F4));
	TEST_ASSERT_EQUAL_HEX8(0x1B, memory_at(0x1FF));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand)); /* behind the end */

	hand_skip(&hand, 5, 0x0F, 0x40, 0x00, 0x77, 0x78); /* part of a page: no checksum */
	TEST_ASSERT_EQUAL_HEX8(0x01, read_scratchpad(0x40, 0x77, 2));
	hand_skip(&hand, 4, 0x55, 0x40, 0x00, 0x01);
	hand.now += 6 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x78, memory_at(0x41));
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory_at(0x42));
}

static uint32_t counter(unsigned page)
{
	uint16_t at = (uint16_t)(page * 32 + 31);
	uint8_t out[3 + 1 + 4 + 4 + 2] = {0xA5, (uint8_t)at, (uint8_t)(at >> 8)};

	hand_skip(&hand, 3, 0xA5, at & 0xFF, at >> 8);
	hand_read(&hand, out + 3, 11);
	check_crc16(out, sizeof(out));
	return out[4] | out[5] << 8 | out[6] << 16 | (uint32_t)out[7] << 24;
}

static void test_a_ds2423_counts_falling_edges(void)
{
	const struct sim_curve blink = {
		.shape = SIM_SQUARE, .a = 1, .b = 0, .span_ns = 10 * HAND_MS};

	slave = hand_plug(&hand, &sim_ds2423, 1);
	TEST_ASSERT_EQUAL_INT(0, slave->family->option(slave, "count.B", 1000));
	TEST_ASSERT_EQUAL_UINT32(0, counter(14));
	TEST_ASSERT_EQUAL_UINT32(1000, counter(15));
	TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFF, counter(3));
	slave->input[1] = blink;
	hand.now = 604800000 * HAND_MS; /* a week, jumped over */
	TEST_ASSERT_UINT32_WITHIN(20, 60480000 + 1000, counter(15));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_UINT32_WITHIN(40, 60480000 + 1000, counter(15));
	write_scratchpad(0x1C0, 1, 32);
	hand_skip(&hand, 4, 0x5A, 0xC0, 0x01, 0x1F);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(5, memory_at(0x1C4));
}

static void test_counter_pages_follow_each_other_with_a_checksum_each(void)
{
	uint8_t out[3 + 42] = {0xA5, 0xC0, 0x01};

	slave = hand_plug(&hand, &sim_ds2423, 1);
	hand_skip(&hand, 3, 0xA5, 0xC0, 0x01);
	hand_read(&hand, out + 3, 42);
	check_crc16(out, 45);
	hand_read(&hand, out, 42);
	check_crc16(out, 42);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_ds2430a_has_addresses_of_one_byte(void)
{
	slave = hand_plug(&hand, &sim_ds2430a, 1);
	hand_skip(&hand, 5, 0x0F, 0x1E, 1, 2, 3); /* it wraps */
	hand_skip(&hand, 2, 0xAA, 0x1E);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(2, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(3, hand_byte(&hand));
	hand_skip(&hand, 2, 0x55, 0xA5);
	hand.now += 11 * HAND_MS;
	sim_slave_brownout(slave, hand.now);
	hand_skip(&hand, 2, 0xF0, 0x1F);
	TEST_ASSERT_EQUAL_HEX8(2, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(3, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_ds2430a_locks_its_application_register(void)
{
	slave = hand_plug(&hand, &sim_ds2430a, 1);
	hand_skip(&hand, 2, 0x66, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_skip(&hand, 4, 0x99, 0x02, 0x55, 0x66);
	hand_skip(&hand, 2, 0x5A, 0xA5);
	hand.now += 11 * HAND_MS;
	hand_skip(&hand, 2, 0x66, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0xFC, hand_byte(&hand));
	hand_skip(&hand, 3, 0x99, 0x02, 0x11);
	hand_skip(&hand, 2, 0xC3, 0x02);
	TEST_ASSERT_EQUAL_HEX8(0x55, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x66, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2431_is_written_by_scratchpad_and_key);
	RUN_TEST(test_a_parasite_loses_the_copy_without_current);
	RUN_TEST(test_a_ds2433_copies_from_offset_to_end);
	RUN_TEST(test_a_ds2423_counts_falling_edges);
	RUN_TEST(test_counter_pages_follow_each_other_with_a_checksum_each);
	RUN_TEST(test_a_ds2430a_has_addresses_of_one_byte);
	RUN_TEST(test_a_ds2430a_locks_its_application_register);
	return UNITY_END();
}
