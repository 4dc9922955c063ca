/* SPDX-License-Identifier: MIT */
/* The memories: each command does what the chip's data sheet says. */
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
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "count.B", 1000));
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

/* DS28EC20, "Memory function flow chart". */
static void test_a_ds28ec20_sends_pages_and_their_checksums(void)
{
	uint8_t out[3 + 34] = {0xA5, 0xE0, 0x09};

	slave = hand_plug(&hand, &sim_ds28ec20, 1);
	write_scratchpad(0x9E0, 0x10, 32);
	hand_skip(&hand, 4, 0x55, 0xE0, 0x09, 0x1F);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	hand_skip(&hand, 3, 0xA5, 0xE0, 0x09); /* the last page */
	hand_read(&hand, out + 3, 34);
	check_crc16(out, 37);
	TEST_ASSERT_EQUAL_HEX8(0x10, out[3]);
	TEST_ASSERT_EQUAL_HEX8(0x2F, out[34]);
	hand_read(&hand, out, 34); /* the register page: open blocks, user bytes */
	check_crc16(out, 34);
	TEST_ASSERT_EQUAL_HEX8(0x00, out[0]);
	hand_read(&hand, out, 34); /* the factory byte */
	check_crc16(out, 34);
	TEST_ASSERT_EQUAL_HEX8(0x55, out[0]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_ds28ec20_reads_its_scratchpad_to_the_end_and_copies_what_was_written(void)
{
	uint8_t out[1 + 3 + 16 + 2] = {0xAA};

	slave = hand_plug(&hand, &sim_ds28ec20, 1);
	hand_skip(&hand, 5, 0x0F, 0x30, 0x01, 0x77, 0x78);
	hand_skip(&hand, 1, 0xAA);
	hand_read(&hand, out + 1, 21);
	check_crc16(out, 22);
	TEST_ASSERT_EQUAL_HEX8(0x11, out[3]);
	TEST_ASSERT_EQUAL_HEX8(0x78, out[5]);
	hand_skip(&hand, 4, 0x55, 0x30, 0x01, 0x11);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x77, memory_at(0x130));
	TEST_ASSERT_EQUAL_HEX8(0x78, memory_at(0x131));
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory_at(0x132));
}

/* The BS flag. */
static void test_a_read_before_the_copy_is_a_bad_sequence_for_a_ds28ec20(void)
{
	slave = hand_plug(&hand, &sim_ds28ec20, 1);
	write_scratchpad(0x20, 1, 32);
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory_at(0x20));
	hand_skip(&hand, 4, 0x55, 0x20, 0x00, 0x1F);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, memory_at(0x20));
	write_scratchpad(0x20, 1, 32);
	TEST_ASSERT_EQUAL_HEX8(0x1F, read_scratchpad(0x20, 1, 32));
	hand_skip(&hand, 4, 0x55, 0x20, 0x00, 0x1F);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x01, memory_at(0x20));
}

static void test_a_ds28ec20_has_a_page_that_is_read_only(void)
{
	slave = hand_plug(&hand, &sim_ds28ec20, 1);
	hand_skip(&hand, 4, 0x0F, 0x20, 0x0A, 0x00);
	hand_skip(&hand, 4, 0x55, 0x20, 0x0A, 0x00);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x55, memory_at(0xA20));
}

/* A command, its address, and the CRC8 of both. */
static void begin_ds2502(uint8_t command, uint8_t at)
{
	uint8_t out[4] = {command, at, 0};

	hand_skip(&hand, 3, command, at, 0);
	out[3] = hand_byte(&hand);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, out, 4));
}

static void read_ds2502(unsigned n, uint8_t first, uint8_t last)
{
	uint8_t in[129];

	hand_read(&hand, in, n + 1);
	TEST_ASSERT_EQUAL_HEX8(first, in[0]);
	TEST_ASSERT_EQUAL_HEX8(last, in[n - 1]);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, in, n + 1));
}

static uint8_t *plug_ds2502(void)
{
	size_t size;
	uint8_t *memory;

	slave = hand_plug(&hand, &sim_ds2502, 1);
	memory = sim_slave_memory(slave, &size);
	TEST_ASSERT_EQUAL_size_t(128 + 8, size);
	for (unsigned i = 0; i < 128; i++)
		memory[i] = (uint8_t)i;
	return memory;
}

static void test_a_ds2502_ends_its_memory_and_its_status_with_a_checksum(void)
{
	plug_ds2502()[128] = 0xFE; /* page 0 is write-protected */
	begin_ds2502(0xF0, 0x00);
	read_ds2502(128, 0x00, 0x7F);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	begin_ds2502(0xF0, 0x7D);
	read_ds2502(3, 0x7D, 0x7F);
	begin_ds2502(0xAA, 0x00);
	read_ds2502(8, 0xFE, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_a_ds2502_sends_pages_with_a_checksum_of_their_data_each(void)
{
	plug_ds2502();
	begin_ds2502(0xC3, 0x45);
	read_ds2502(27, 0x45, 0x5F);
	read_ds2502(32, 0x60, 0x7F);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

/* Its first checksum is of command, address and byte; the next starts with the low address. */
static void test_a_ds2502_without_12_volts_answers_a_write_and_keeps_its_byte(void)
{
	const uint8_t first[] = {0x0F, 0x10, 0x00, 0x00}, second = 0x5A;
	const uint8_t *memory = plug_ds2502();

	hand_skip(&hand, 4, 0x0F, 0x10, 0x00, 0x00);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, first, 4), hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x10, hand_byte(&hand));
	hand_write(&hand, &second, 1);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0x11, &second, 1), hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x11, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x10, memory[0x10]);
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
	RUN_TEST(test_a_ds28ec20_sends_pages_and_their_checksums);
	RUN_TEST(test_a_ds28ec20_reads_its_scratchpad_to_the_end_and_copies_what_was_written);
	RUN_TEST(test_a_read_before_the_copy_is_a_bad_sequence_for_a_ds28ec20);
	RUN_TEST(test_a_ds28ec20_has_a_page_that_is_read_only);
	RUN_TEST(test_a_ds2502_ends_its_memory_and_its_status_with_a_checksum);
	RUN_TEST(test_a_ds2502_sends_pages_with_a_checksum_of_their_data_each);
	RUN_TEST(test_a_ds2502_without_12_volts_answers_a_write_and_keeps_its_byte);
	return UNITY_END();
}
