/* SPDX-License-Identifier: MIT */
/* DS2405, DS2406 and DS2450 against their data sheets. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;
static uint8_t out[64];

void setUp(void)
{
	hand_clear(&hand);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void check_crc16(unsigned n)
{
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, out, n));
}

static void drive(unsigned input, double level)
{
	sim_slave_advance(slave, hand.now);
	slave->input[input] = sim_constant(level);
	hand.now += HAND_MS;
}

static void test_a_ds2405_is_turned_over_by_match_rom(void)
{
	uint8_t rom[4][8];

	slave = hand_plug(&hand, &sim_ds2405, 1);
	TEST_ASSERT_EQUAL_UINT(0, hand_search(&hand, 0xEC, rom, 4));
	hand_match(&hand, slave);
	TEST_ASSERT_FALSE(hand_bit(&hand, true)); /* on: it holds its pin low */
	TEST_ASSERT_EQUAL_UINT(1, hand_search(&hand, 0xEC, rom, 4));
	hand_match(&hand, slave);
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	drive(0, 0);
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
	TEST_ASSERT_EQUAL_UINT(1, hand_search(&hand, 0xF0, rom, 4)); /* changes nothing */
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
	TEST_ASSERT_EQUAL_UINT(0, hand_search(&hand, 0xEC, rom, 4));
}

static uint8_t status7(void)
{
	memcpy(out, (const uint8_t[]){0xAA, 0x07, 0x00}, 3);
	hand_skip(&hand, 3, 0xAA, 0x07, 0x00);
	hand_read(&hand, out + 3, 3);
	check_crc16(6);
	return out[3];
}

static void write_status7(uint8_t value)
{
	memcpy(out, (const uint8_t[]){0x55, 0x07, 0x00, value}, 4);
	hand_skip(&hand, 4, 0x55, 0x07, 0x00, value);
	hand_read(&hand, out + 4, 2);
	check_crc16(6);
}

static void test_the_status_of_a_ds2406_switches_its_pins(void)
{
	slave = hand_plug(&hand, &sim_ds2406, 1);
	TEST_ASSERT_EQUAL_HEX8(0xFF, status7());
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave)); /* pins high, as it starts */
	write_status7(0x5F);
	TEST_ASSERT_EQUAL_HEX8(0xDF, status7());
	slave->parasite = true;
	TEST_ASSERT_EQUAL_HEX8(0x5F, status7());
	write_status7(0x3F);
	TEST_ASSERT_EQUAL_HEX8(0x3F, status7());
}

static uint8_t access(uint8_t control, unsigned n)
{
	memcpy(out, (const uint8_t[]){0xF5, control, 0xFF}, 3);
	hand_skip(&hand, 3, 0xF5, control, 0xFF);
	hand_read(&hand, out + 3, n);
	return out[3];
}

static void test_channel_access_tells_the_state_of_both_channels(void)
{
	slave = hand_plug(&hand, &sim_ds2406, 1);
	drive(1, 0);
	TEST_ASSERT_EQUAL_HEX8(0x80 | 0x40 | 0x20 | 0x04 | 0x03, access(0x4D, 4));
	TEST_ASSERT_EQUAL_HEX8(0x55, out[4]); /* A and B in turns */
	check_crc16(7);
	TEST_ASSERT_EQUAL_HEX8(0xE7, access(0xC5, 2)); /* the latches are cleared behind it */
	TEST_ASSERT_EQUAL_HEX8(0xFF, out[4]);
	TEST_ASSERT_EQUAL_HEX8(0xC7, access(0x48, 2));
	TEST_ASSERT_EQUAL_HEX8(0x00, out[4]);
}

static void test_channel_access_writes_the_pins(void)
{
	slave = hand_plug(&hand, &sim_ds2406, 1);
	hand_skip(&hand, 3, 0xF5, 0x0C, 0xFF);
	hand_byte(&hand);
	hand_write(&hand, (const uint8_t[]){0xAA}, 1); /* A 0, B 1 */
	TEST_ASSERT_EQUAL_HEX8(0x40, status7() & 0x60);
	hand_skip(&hand, 3, 0xF5, 0x08, 0xFF);
	hand_byte(&hand);
	hand_write(&hand, (const uint8_t[]){0x00}, 1); /* B */
	TEST_ASSERT_EQUAL_HEX8(0x00, status7() & 0x60);
}

static void test_a_ds2406_answers_by_source_channel_and_polarity(void)
{
	slave = hand_plug(&hand, &sim_ds2406, 1);
	write_status7(0x60 | 0x08 | 0x06 | 0x00); /* level of A is 0 */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	drive(0, 0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	write_status7(0x60 | 0x10 | 0x02 | 0x01); /* activity on B */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	drive(1, 0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
}

static void read_page(uint8_t at)
{
	memcpy(out, (const uint8_t[]){0xAA, at, 0x00}, 3);
	hand_skip(&hand, 3, 0xAA, at, 0x00);
	hand_read(&hand, out + 3, 10);
	check_crc16(13);
}

/* One byte written: checksum over command, address and byte, then the byte itself. */
static void write_byte(uint8_t at, uint8_t value)
{
	memcpy(out, (const uint8_t[]){0x55, at, 0x00, value}, 4);
	hand_skip(&hand, 4, 0x55, at, 0x00, value);
	hand_read(&hand, out + 4, 3);
	check_crc16(6);
	TEST_ASSERT_EQUAL_HEX8(value, out[6]);
}

static void convert(uint8_t channels)
{
	memcpy(out, (const uint8_t[]){0x3C, channels, 0x00}, 3);
	hand_skip(&hand, 3, 0x3C, channels, 0x00);
	hand_read(&hand, out + 3, 2);
	check_crc16(5);
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
	hand.now += 6 * HAND_MS;
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
}

static void test_a_ds2450_starts_as_its_memory_map_says(void)
{
	static const uint8_t control[8] = {8, 0x8C, 8, 0x8C, 8, 0x8C, 8, 0x8C};
	static const uint8_t limits[8] = {0, 0xFF, 0, 0xFF, 0, 0xFF, 0, 0xFF};

	slave = hand_plug(&hand, &sim_ds2450, 1);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	read_page(8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(control, out + 3, 8);
	read_page(16);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(limits, out + 3, 8);
}

static void test_a_ds2450_converts_in_range_and_resolution(void)
{
	slave = hand_plug(&hand, &sim_ds2450, 1);
	slave->input[1] = sim_constant(1.28);
	slave->input[2] = sim_constant(1.28);
	write_byte(0x0A, 0x00); /* B: 16 bits */
	write_byte(0x0D, 0x01); /* C: 8 bits of 5.12 V */
	convert(0x06);
	read_page(0);
	TEST_ASSERT_EQUAL_HEX16(0, out[3] | out[4] << 8);
	TEST_ASSERT_EQUAL_HEX16(0x8000, out[5] | out[6] << 8);
	TEST_ASSERT_EQUAL_HEX16(0x4000, out[7] | out[8] << 8);
}

static void test_a_ds2450_is_in_alarm_beyond_its_limits(void)
{
	slave = hand_plug(&hand, &sim_ds2450, 1);
	for (uint8_t i = 0; i < 4; i++)
		write_byte((uint8_t)(0x09 + 2 * i), 0x0C);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	write_byte(0x10, 0x40);
	write_byte(0x11, 0xC0);
	slave->input[0] = sim_constant(1);
	convert(1);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	slave->input[0] = sim_constant(2.2);
	convert(1);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	read_page(8);
	TEST_ASSERT_EQUAL_HEX8(0x2C, out[4]);
	slave->input[0] = sim_constant(0.2);
	convert(1);
	read_page(8);
	TEST_ASSERT_EQUAL_HEX8(0x1C, out[4]);
}

static void test_bytes_written_in_a_row_have_checksums_that_start_with_their_address(void)
{
	slave = hand_plug(&hand, &sim_ds2450, 1);
	write_byte(0x10, 0x40);
	hand_write(&hand, (const uint8_t[]){0xC0}, 1);
	hand_read(&hand, out, 3);
	TEST_ASSERT_EQUAL_HEX16((uint16_t)~sim_crc16(0x0011, (const uint8_t[]){0xC0}, 1),
	                        out[0] | out[1] << 8);
	TEST_ASSERT_EQUAL_HEX8(0xC0, out[2]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2405_is_turned_over_by_match_rom);
	RUN_TEST(test_the_status_of_a_ds2406_switches_its_pins);
	RUN_TEST(test_channel_access_tells_the_state_of_both_channels);
	RUN_TEST(test_channel_access_writes_the_pins);
	RUN_TEST(test_a_ds2406_answers_by_source_channel_and_polarity);
	RUN_TEST(test_a_ds2450_starts_as_its_memory_map_says);
	RUN_TEST(test_a_ds2450_converts_in_range_and_resolution);
	RUN_TEST(test_a_ds2450_is_in_alarm_beyond_its_limits);
	RUN_TEST(test_bytes_written_in_a_row_have_checksums_that_start_with_their_address);
	return UNITY_END();
}
