/* SPDX-License-Identifier: MIT */
/* The memory iButtons and the EPROMs: each command does what the chip's data sheet says. */
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

static uint8_t *plug(const struct sim_family *family)
{
	size_t size;

	slave = hand_plug(&hand, family, 1);
	return sim_slave_memory(slave, &size);
}

static void send(const uint8_t *bytes, unsigned n)
{
	hand_skip(&hand, 0);
	hand_write(&hand, bytes, n);
}

static void check_zeros_after_copy(void)
{
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
}

static void test_a_ds1992_copies_what_was_written_and_has_no_checksums(void)
{
	static const uint8_t pad[] = {0x22, 0x00, 0x03, 0xA1, 0xA2, 0xFF};
	const uint8_t *memory = plug(&sim_ds1992);
	uint8_t in[sizeof(pad)];

	hand_skip(&hand, 5, 0x0F, 0x22, 0x00, 0xA1, 0xA2);
	hand_skip(&hand, 1, 0xAA);
	hand_read(&hand, in, sizeof(in));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(pad, in, sizeof(pad));
	hand_skip(&hand, 4, 0x55, 0x22, 0x00, 0x04);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x00, memory[0x22]);
	hand_skip(&hand, 4, 0x55, 0x22, 0x00, 0x03);
	check_zeros_after_copy();
	TEST_ASSERT_EQUAL_HEX8(0xA1, memory[0x22]);
	TEST_ASSERT_EQUAL_HEX8(0xA2, memory[0x23]);
	hand_skip(&hand, 3, 0xF0, 0x7F, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand)); /* beyond its end */
}

static void test_a_byte_too_many_sets_the_overflow_flag_of_a_ds1993(void)
{
	plug(&sim_ds1993);
	hand_skip(&hand, 5, 0x0F, 0x1F, 0x01, 0x11, 0x22);
	hand_skip(&hand, 1, 0xAA);
	TEST_ASSERT_EQUAL_HEX8(0x1F, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x01, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x5F, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x11, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void check_last_byte(const struct sim_family *family, uint16_t at)
{
	uint8_t low = at & 0xFF, high = (uint8_t)(at >> 8);

	plug(family);
	hand_skip(&hand, 4, 0x0F, low, high, 0x5A);
	hand_skip(&hand, 4, 0x55, low, high, 0x1F);
	check_zeros_after_copy();
	hand_skip(&hand, 3, 0xF0, low, high);
	TEST_ASSERT_EQUAL_HEX8(0x5A, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_clear(&hand);
}

static void test_each_memory_ends_where_its_size_says(void)
{
	check_last_byte(&sim_ds1992, 0x7F);
	check_last_byte(&sim_ds1993, 0x1FF);
	check_last_byte(&sim_ds1995, 0x7FF);
	check_last_byte(&sim_ds1996, 0x1FFF);
}

static void check_count_of_page_13(uint32_t count)
{
	uint8_t io[3 + 32 + 8 + 2] = {0xA5, 0xA0, 0x01};

	send(io, 3);
	hand_read(&hand, io + 3, sizeof(io) - 3);
	check_crc16(io, sizeof(io));
	TEST_ASSERT_EQUAL_UINT32(count, io[35] | (uint32_t)io[36] << 8);
	TEST_ASSERT_EQUAL_HEX8(0x55, io[39]);
}

static void test_a_ds1963l_counts_how_often_a_page_is_written(void)
{
	uint8_t io[3 + 32 + 8 + 2] = {0xA5, 0x60, 0x01};

	plug(&sim_ds1963l);
	check_count_of_page_13(0);
	for (unsigned i = 0; i < 2; i++) {
		hand_skip(&hand, 4, 0x0F, 0xA0, 0x01, 0x77);
		hand_skip(&hand, 4, 0x5A, 0xA0, 0x01, 0x00);
		hand.now += HAND_MS;
	}
	check_count_of_page_13(2);
	send(io, 3); /* page 11 has no counter */
	hand_read(&hand, io + 3, sizeof(io) - 3);
	check_crc16(io, sizeof(io));
	TEST_ASSERT_EQUAL_HEX8(0xFF, io[35]);
}

static void check_scratchpad_of_ds1963s(uint8_t first)
{
	uint8_t io[1 + 3 + 32 + 2] = {0xAA};

	send(io, 1);
	hand_read(&hand, io + 1, sizeof(io) - 1);
	check_crc16(io, sizeof(io));
	TEST_ASSERT_EQUAL_HEX8(first, io[4]);
}

static void test_a_ds1963s_hides_its_scratchpad_until_it_is_erased(void)
{
	const uint8_t *memory = plug(&sim_ds1963s);

	hand_skip(&hand, 4, 0x0F, 0x00, 0x01, 0x77);
	check_scratchpad_of_ds1963s(0xFF);
	hand_skip(&hand, 4, 0x55, 0x00, 0x01, 0x00);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x00, memory[0x100]);
	hand_skip(&hand, 3, 0xC3, 0x00, 0x00);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	hand_skip(&hand, 4, 0x0F, 0x00, 0x01, 0x77);
	check_scratchpad_of_ds1963s(0x77);
	hand_skip(&hand, 4, 0x55, 0x00, 0x01, 0x00);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x77, memory[0x100]);
	hand_skip(&hand, 3, 0xF0, 0x60, 0x02); /* counter of page 8 */
	TEST_ASSERT_EQUAL_HEX8(0x01, hand_byte(&hand));
	hand_skip(&hand, 3, 0xF0, 0x00, 0x02); /* a secret */
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_ds1963s_that_computes_is_not_upset_by_a_reset(void)
{
	uint8_t io[3 + 32 + 8 + 2] = {0xA5, 0x00, 0x01};

	plug(&sim_ds1963s);
	send(io, 3);
	hand_read(&hand, io + 3, sizeof(io) - 3);
	check_crc16(io, sizeof(io));
	TEST_ASSERT_TRUE(hand_reset(&hand));
	hand.now += 2 * HAND_MS;
	hand_skip(&hand, 3, 0xF0, 0x00, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
}

static void test_a_ds2505_has_checksums_after_redirection_byte_and_page(void)
{
	uint8_t *memory = plug(&sim_ds2505);
	uint8_t head[6] = {0xA5, 0x3E, 0x00}, page[4], next[3];

	memory[0x3E] = 0x12;
	memory[0x3F] = 0x34;
	memory[2048 + 0x101] = 0xFE;
	send(head, 3);
	hand_read(&hand, head + 3, 3);
	check_crc16(head, 6);
	TEST_ASSERT_EQUAL_HEX8(0xFE, head[3]);
	hand_read(&hand, page, 4);
	check_crc16(page, 4);
	TEST_ASSERT_EQUAL_HEX8(0x12, page[0]);
	TEST_ASSERT_EQUAL_HEX8(0x34, page[1]);
	hand_read(&hand, next, 3);
	check_crc16(next, 3);
	TEST_ASSERT_EQUAL_HEX8(0xFF, next[0]);
}

static void check_end_of_eprom(const struct sim_family *family, uint16_t at)
{
	uint8_t io[3 + 1 + 2] = {0xF0, at & 0xFF, (uint8_t)(at >> 8)};

	plug(family)[at] = 0x42;
	send(io, 3);
	hand_read(&hand, io + 3, 3);
	check_crc16(io, 6);
	TEST_ASSERT_EQUAL_HEX8(0x42, io[3]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_clear(&hand);
}

static void test_an_eprom_ends_with_a_checksum(void)
{
	check_end_of_eprom(&sim_ds2505, 0x7FF);
	check_end_of_eprom(&sim_ds1985u, 0x7FF);
	check_end_of_eprom(&sim_ds2506, 0x1FFF);
	check_end_of_eprom(&sim_ds1986u, 0x1FFF);
}

static void test_the_status_of_a_ds2506_has_a_checksum_after_eight_bytes(void)
{
	uint8_t *memory = plug(&sim_ds2506), io[3 + 8 + 2] = {0xAA, 0xF8, 0x01};

	memory[8192 + 0x1FF] = 0xAB;
	send(io, 3);
	hand_read(&hand, io + 3, sizeof(io) - 3);
	check_crc16(io, sizeof(io));
	TEST_ASSERT_EQUAL_HEX8(0xAB, io[10]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_an_eprom_without_12_volts_answers_a_write_and_keeps_its_byte(void)
{
	uint8_t *memory = plug(&sim_ds2505), io[6] = {0x0F, 0x10, 0x00, 0x00};

	send(io, 4);
	hand_read(&hand, io + 4, 2);
	check_crc16(io, 6);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory[0x10]);
}

static void test_a_ds1982u_is_a_ds2502_with_contents(void)
{
	uint8_t head[4] = {0xC3, 0x20, 0x00}, page[33];

	plug(&sim_ds1982u)[0x20] = 0x29;
	send(head, 3);
	hand_read(&hand, head + 3, 1);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, head, 4));
	hand_read(&hand, page, 33);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, page, 33));
	TEST_ASSERT_EQUAL_HEX8(0x29, page[0]);
	TEST_ASSERT_EQUAL_HEX8(0x89, slave->rom[0]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds1992_copies_what_was_written_and_has_no_checksums);
	RUN_TEST(test_a_byte_too_many_sets_the_overflow_flag_of_a_ds1993);
	RUN_TEST(test_each_memory_ends_where_its_size_says);
	RUN_TEST(test_a_ds1963l_counts_how_often_a_page_is_written);
	RUN_TEST(test_a_ds1963s_hides_its_scratchpad_until_it_is_erased);
	RUN_TEST(test_a_ds1963s_that_computes_is_not_upset_by_a_reset);
	RUN_TEST(test_a_ds2505_has_checksums_after_redirection_byte_and_page);
	RUN_TEST(test_an_eprom_ends_with_a_checksum);
	RUN_TEST(test_the_status_of_a_ds2506_has_a_checksum_after_eight_bytes);
	RUN_TEST(test_an_eprom_without_12_volts_answers_a_write_and_keeps_its_byte);
	RUN_TEST(test_a_ds1982u_is_a_ds2502_with_contents);
	return UNITY_END();
}
