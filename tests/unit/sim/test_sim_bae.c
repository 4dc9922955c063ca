/* SPDX-License-Identifier: MIT */
/* BAE 0910 and 0911: blocks, EEPROM, and functions that run for a while. */
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

/* The bytes of a command that writes; its checksum has to be right; then `confirmation`. */
static void write_command(const uint8_t *bytes, unsigned n, uint8_t confirmation)
{
	uint8_t crc[2];

	hand_skip(&hand, 0);
	hand_write(&hand, bytes, n);
	hand_read(&hand, crc, 2);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(sim_crc16(0, bytes, n), crc, 2));
	hand_write(&hand, &confirmation, 1);
	hand.now += 2 * HAND_MS;
}
#define WRITE(...) \
	write_command((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}), 0xBC)

static void read_block(unsigned at, uint8_t *bytes, uint8_t n)
{
	uint8_t head[4] = {0x14, (uint8_t)at, (uint8_t)(at >> 8), n}, crc[2];

	hand_skip(&hand, 0);
	hand_write(&hand, head, 4);
	hand_read(&hand, bytes, n);
	hand_read(&hand, crc, 2);
	TEST_ASSERT_EQUAL_HEX16(0xB001,
	                        sim_crc16(sim_crc16(sim_crc16(0, head, 4), bytes, n), crc, 2));
}

static void test_type_and_version_tell_the_parts_apart(void)
{
	uint8_t bytes[4];

	slave = hand_plug(&hand, &sim_bae0910, 1);
	hand_skip(&hand, 1, 0x12);
	hand_read(&hand, bytes, 2);
	TEST_ASSERT_EQUAL_HEX8(2, bytes[0]);
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_bae0911, 1);
	hand_skip(&hand, 1, 0x12);
	hand_read(&hand, bytes, 4);
	TEST_ASSERT_EQUAL_HEX8(3, bytes[0]);
	hand_skip(&hand, 1, 0x11);
	hand_read(&hand, bytes, 2);
	TEST_ASSERT_EQUAL_HEX8(0x0C, bytes[1]);
}

static void test_registers_are_written_when_it_is_confirmed(void)
{
	uint8_t bytes[2];

	slave = hand_plug(&hand, &sim_bae0910, 1);
	WRITE(0x15, 96, 0, 2, 0x12, 0x34);
	read_block(96, bytes, 2);
	TEST_ASSERT_EQUAL_HEX8(0x12, bytes[0]);
	write_command((const uint8_t[]){0x15, 96, 0, 1, 0x77}, 5, 0xBB);
	read_block(96, bytes, 2);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x12, bytes[0], "it was not confirmed");
	read_block(62, bytes, 2);
	TEST_ASSERT_EQUAL_INT(512, bytes[0] << 8 | bytes[1]);
}

static void test_the_clock_runs_from_what_was_written(void)
{
	uint8_t bytes[4];

	slave = hand_plug(&hand, &sim_bae0910, 1);
	WRITE(0x15, 40, 0, 4, 0, 0, 1, 0);
	hand.now += 5000 * HAND_MS;
	read_block(40, bytes, 4);
	TEST_ASSERT_EQUAL_HEX8(1, bytes[2]);
	TEST_ASSERT_EQUAL_UINT8(5, bytes[3]);
}

static void test_eeprom_bits_are_cleared_by_a_write_and_set_by_erasing(void)
{
	uint8_t byte;

	slave = hand_plug(&hand, &sim_bae0911, 1);
	WRITE(0x15, 0x05, 0x02, 1, 0xF0);
	WRITE(0x15, 0x05, 0x02, 1, 0x3F);
	read_block(0x205, &byte, 1);
	TEST_ASSERT_EQUAL_HEX8(0x30, byte);
	sim_slave_brownout(slave, hand.now);
	read_block(0x205, &byte, 1);
	TEST_ASSERT_EQUAL_HEX8(0x30, byte);
	WRITE(0x16, 0x00, 0x02);
	read_block(0x205, &byte, 1);
	TEST_ASSERT_EQUAL_HEX8(0xFF, byte);
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_bae0910, 1);
	WRITE(0x15, 0x01, 0xE2, 1, 0x42); /* the 0910 has it elsewhere */
	read_block(0xE201, &byte, 1);
	TEST_ASSERT_EQUAL_HEX8(0x42, byte);
}

static void query(uint8_t *bytes, unsigned n)
{
	hand_skip(&hand, 1, 0x1A);
	hand_read(&hand, bytes, n);
}

static void test_a_sector_of_the_card_is_written_and_read_in_sequences(void)
{
	uint8_t bytes[8];

	slave = hand_plug(&hand, &sim_bae0911, 1);
	WRITE(0x17, 4, 2, 0, 0, 0, 2, 0); /* sector 1 */
	query(bytes, 4);
	TEST_ASSERT_EQUAL_HEX8(0, bytes[0]);
	WRITE(0x18, 3, 2, 'o', 'w', 's');
	WRITE(0x17, 0, 3, 0);
	WRITE(0x17, 4, 4, 0, 0, 0, 2, 0);
	WRITE(0x19, 3, 0);
	query(bytes, 7);
	TEST_ASSERT_EQUAL_HEX8(0, bytes[0]);
	TEST_ASSERT_EQUAL_HEX8(3, bytes[1]);
	TEST_ASSERT_EQUAL_STRING_LEN("ows", bytes + 2, 3);
	WRITE(0x17, 4, 4, 0, 0x7F, 0, 0, 0);
	query(bytes, 4);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(1, bytes[0], "there is no such sector");
}

static void test_the_expander_answers_over_i2c(void)
{
	uint8_t bytes[8];

	slave = hand_plug(&hand, &sim_bae0911, 1);
	WRITE(0x17, 3, 0, 0, 0x40, 0x03, 0x5A);
	WRITE(0x17, 0, 1, 0);
	WRITE(0x17, 2, 0, 1, 0x40, 0x03);
	query(bytes, 5);
	TEST_ASSERT_EQUAL_HEX8(0, bytes[0]);
	TEST_ASSERT_EQUAL_HEX8(0x5A, bytes[2]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_type_and_version_tell_the_parts_apart);
	RUN_TEST(test_registers_are_written_when_it_is_confirmed);
	RUN_TEST(test_the_clock_runs_from_what_was_written);
	RUN_TEST(test_eeprom_bits_are_cleared_by_a_write_and_set_by_erasing);
	RUN_TEST(test_a_sector_of_the_card_is_written_and_read_in_sequences);
	RUN_TEST(test_the_expander_answers_over_i2c);
	return UNITY_END();
}
