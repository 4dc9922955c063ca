/* SPDX-License-Identifier: MIT */
/* The loggers: clock, missions, logs, alarms and passwords are as their data sheets say. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

#define MINUTE (60000 * HAND_MS)

static struct hand hand;
static struct sim_slave *slave;
static uint8_t page[34];

void setUp(void)
{
	hand_clear(&hand);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void plug(const struct sim_family *family)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, family, 1);
}

static void set(unsigned input, double value)
{
	sim_slave_advance(slave, hand.now);
	slave->input[input] = sim_constant(value);
}

/* --- DS1921 ---------------------------------------------------------------------------------- */

/* A page with its checksum, which covers the command and the address too. */
static const uint8_t *read_21(unsigned at)
{
	const uint8_t sent[] = {0xA5, (uint8_t)at, (uint8_t)(at >> 8)};
	uint16_t crc;

	hand_skip(&hand, 3, sent[0], sent[1], sent[2]);
	hand_read(&hand, page, 34);
	crc = (uint16_t)~sim_crc16(sim_crc16(0, sent, 3), page, 32);
	TEST_ASSERT_EQUAL_HEX16(crc, page[32] | page[33] << 8);
	return page;
}

static uint8_t byte_21(unsigned at)
{
	return read_21(at & ~31u)[at % 32];
}

static void write_bytes(unsigned at, unsigned n, const uint8_t *bytes, uint8_t copy)
{
	uint8_t end = (uint8_t)((at + n - 1) % 32);

	hand_skip(&hand, 3, 0x0F, at & 0xFF, at >> 8);
	hand_write(&hand, bytes, n);
	hand_skip(&hand, 4, copy, at & 0xFF, at >> 8, end);
	if (copy == 0x99)
		hand_write(&hand, (const uint8_t[8]){0}, 8);
	hand.now += HAND_MS;
}

static void write_21(unsigned at, uint8_t byte)
{
	write_bytes(at, 1, &byte, 0x55);
}

static void clear_21(uint8_t control)
{
	write_21(0x20E, 0x40 | control);
	hand_skip(&hand, 1, 0x3C);
	hand.now += HAND_MS;
}

static void test_a_clock_counts_over_the_end_of_february_and_of_the_century(void)
{
	static const struct {
		uint8_t before[7], after[7];
	} ends[] = {
		{{0x59, 0x59, 0x23, 3, 0x28, 0x82, 0x26}, {0, 0, 0, 4, 0x01, 0x83, 0x26}},
		{{0x59, 0x59, 0x23, 7, 0x28, 0x82, 0x24}, {0, 0, 0, 1, 0x29, 0x82, 0x24}},
		{{0x59, 0x59, 0x23, 5, 0x31, 0x12, 0x99}, {0, 0, 0, 6, 0x01, 0x81, 0x00}},
		{{0x59, 0x59, 0x71, 5, 0x31, 0x81, 0x05}, {0, 0, 0x52, 6, 0x01, 0x82, 0x05}},
	};

	plug(&sim_ds1921g);
	for (unsigned i = 0; i < 4; i++) {
		write_bytes(0x200, 7, ends[i].before, 0x55);
		hand.now += 1000 * HAND_MS;
		TEST_ASSERT_EQUAL_HEX8_ARRAY(ends[i].after, read_21(0x200), 7);
	}
	write_21(0x20E, 0x90); /* the oscillator stops */
	hand.now += 5 * MINUTE;
	TEST_ASSERT_EQUAL_HEX8(0, byte_21(0x201));
}

static void test_a_forced_conversion_takes_its_time_and_counts(void)
{
	plug(&sim_ds1921g);
	set(0, 23);
	hand_skip(&hand, 1, 0x44);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x00, byte_21(0x214), "it converts");
	hand.now += 91 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_21(0x214));
	TEST_ASSERT_EQUAL_HEX8(0x7E, page[0x11]);
	TEST_ASSERT_EQUAL_HEX8(1, page[0x1D]);
	plug(&sim_ds1921h);
	set(0, 20);
	hand_skip(&hand, 1, 0x44);
	hand.now += 91 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(44, byte_21(0x211));
}

/* Limits 10 and 30 degrees, each minute; three samples at 20, two at 31, one at 20. */
static void mission_21(void)
{
	static const uint8_t clock[7] = {0, 0x30, 0x12, 1, 0x22, 0x91, 0x26};

	plug(&sim_ds1921g);
	write_bytes(0x200, 7, clock, 0x55);
	clear_21(0x03);
	write_bytes(0x20B, 3, (const uint8_t[]){100, 140, 1}, 0x55);
	set(0, 20);
	hand.now += 3 * MINUTE;
	set(0, 31);
	hand.now += 2 * MINUTE;
	set(0, 20);
	hand.now += MINUTE;
}

static void test_a_mission_logs_counts_and_notes_when_it_was_too_warm(void)
{
	static const uint8_t log[7] = {120, 120, 120, 142, 142, 120, 0};
	static const uint8_t high[5] = {4, 0, 0, 2, 0};

	mission_21();
	TEST_ASSERT_EQUAL_HEX8(0xA2, byte_21(0x214) & 0xEF);
	TEST_ASSERT_EQUAL_UINT8(6, page[0x1A]);
	TEST_ASSERT_EQUAL_UINT8(6, page[0x1D]);
	TEST_ASSERT_EQUAL_HEX8(0x30, page[0x15]);
	TEST_ASSERT_EQUAL_HEX8(0x12, page[0x16]);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(log, read_21(0x1000), 7);
	TEST_ASSERT_EQUAL_UINT8(4, read_21(0x820)[28]);
	TEST_ASSERT_EQUAL_UINT8(2, read_21(0x840)[6]);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(high, read_21(0x240) + 16, 5);
	TEST_ASSERT_EQUAL_UINT8(0, read_21(0x220)[3]);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	write_21(0x214, 0xFD);
	TEST_ASSERT_FALSE_MESSAGE(hand_in_alarm(&hand, slave), "the flag was cleared");
	write_21(0x214, 0xDF);
	hand.now += 5 * MINUTE;
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(6, byte_21(0x21A), "it is at its end");
}

static void test_a_mission_ends_at_a_write_and_starts_only_with_cleared_memory(void)
{
	mission_21();
	write_21(0x20B, 90);
	hand.now += 2 * MINUTE;
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_21(0x214) & 0xF8);
	TEST_ASSERT_EQUAL_UINT8(6, page[0x1A]);
	write_21(0x20D, 1);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x80, byte_21(0x214) & 0xF8, "not cleared");
	write_21(0x20E, 0x40);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_21(0x20E)); /* the reading took the permission away */
	hand_skip(&hand, 1, 0x3C);
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_21(0x214) & 0xF8);
	clear_21(0);
	TEST_ASSERT_EQUAL_HEX8(0xC0, byte_21(0x214) & 0xF8);
	TEST_ASSERT_EQUAL_UINT8(0, page[0x1A]);
	write_21(0x20D, 1);
	TEST_ASSERT_EQUAL_HEX8(0xA0, byte_21(0x214) & 0xF8);
}

static void test_a_log_that_is_full_stops_or_rolls_over(void)
{
	for (unsigned rollover = 0; rollover < 2; rollover++) {
		plug(&sim_ds1921g);
		clear_21(rollover ? 0x08 : 0x00);
		write_bytes(0x20B, 3, (const uint8_t[]){0, 250, 1}, 0x55);
		set(0, 20);
		hand.now += 2048 * MINUTE;
		set(0, 25);
		hand.now += MINUTE;
		TEST_ASSERT_EQUAL_UINT8(rollover ? 130 : 120, read_21(0x1000)[0]);
		TEST_ASSERT_EQUAL_UINT8(1, byte_21(0x21A));
		TEST_ASSERT_EQUAL_UINT8(8, page[0x1B]);
	}
}

static void test_the_clock_alarm_sets_its_flag_in_a_mission(void)
{
	plug(&sim_ds1921g);
	clear_21(0x01);
	write_bytes(0x207, 7, (const uint8_t[]){0, 0x02, 0x80, 0x80, 0, 250, 1}, 0x55);
	hand.now += MINUTE;
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	hand.now += MINUTE;
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
}

/* --- DS1922, DS1923 -------------------------------------------------------------------------- */

static bool read_41(unsigned at, const uint8_t *password)
{
	const uint8_t sent[] = {0x69, (uint8_t)at, (uint8_t)(at >> 8)};

	hand_skip(&hand, 3, sent[0], sent[1], sent[2]);
	hand_write(&hand, password ? password : (const uint8_t[8]){0}, 8);
	hand_read(&hand, page, 34);
	return (uint16_t)~sim_crc16(sim_crc16(0, sent, 3), page, 32) == (page[32] | page[33] << 8);
}

static uint8_t byte_41(unsigned at)
{
	TEST_ASSERT_TRUE(read_41(at & ~31u, NULL));
	return page[at % 32];
}

static void command_41(uint8_t code)
{
	hand_skip(&hand, 10, code, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF);
	hand.now += HAND_MS;
}

static void mission_41(uint8_t control)
{
	static const uint8_t rate[2] = {10, 0};

	command_41(0x96);
	write_bytes(0x206, 2, rate, 0x99);
	write_bytes(0x208, 4, (const uint8_t[]){102, 142, 0, 255}, 0x99); /* 10 and 30 degrees */
	write_bytes(0x210, 4, (const uint8_t[]){3, 0, 3, control}, 0x99);
	command_41(0xCC);
}

static void test_a_forced_conversion_measures_both_quantities_of_a_ds1923(void)
{
	plug(&sim_ds1923);
	TEST_ASSERT_EQUAL_HEX8(0x20, byte_41(0x226));
	set(0, 21.5);
	set(1, 50);
	hand_skip(&hand, 2, 0x55, 0xFF);
	TEST_ASSERT_FALSE_MESSAGE(read_41(0x200, NULL), "the memory is blocked");
	hand.now += 601 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(125, byte_41(0x20D)); /* T/2 - 41 */
	TEST_ASSERT_EQUAL_HEX8(0, page[0x0C]);
	/* 0.958 V + 50 * 0.0307 V of 5.02 V in 4096 parts: 2034 */
	TEST_ASSERT_EQUAL_HEX16(2034 << 4, page[0x0E] | page[0x0F] << 8);
	TEST_ASSERT_EQUAL_UINT8(1, byte_41(0x223));
	plug(&sim_ds1922t);
	set(0, 100);
	hand_skip(&hand, 2, 0x55, 0xFF);
	hand.now += 601 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(202, byte_41(0x20D)); /* T/2 - 1 */
}

static void test_a_mission_of_a_ds1922_logs_from_its_start_on_with_8_or_16_bits(void)
{
	plug(&sim_ds1922l);
	set(0, 20.25);
	mission_41(0x05);
	TEST_ASSERT_EQUAL_HEX8(0xC2, byte_41(0x215));
	hand.now += 21000 * HAND_MS;
	TEST_ASSERT_EQUAL_UINT8(3, byte_41(0x220));
	TEST_ASSERT_TRUE(read_41(0x1000, NULL));
	TEST_ASSERT_EQUAL_HEX8(122, page[0]);
	TEST_ASSERT_EQUAL_HEX8(0x80, page[1]);
	TEST_ASSERT_EQUAL_HEX8(122, page[4]);
	TEST_ASSERT_EQUAL_HEX8(0, page[6]);
	set(0, 31);
	hand.now += 10000 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x72, byte_41(0x214));
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	command_41(0x33);
	TEST_ASSERT_EQUAL_HEX8(0xC0, byte_41(0x215));
	command_41(0xCC);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xC0, byte_41(0x215), "not cleared");
	command_41(0x96);
	TEST_ASSERT_EQUAL_HEX8(0xC8, byte_41(0x215));
	TEST_ASSERT_EQUAL_UINT8(0, byte_41(0x220));
}

static void test_two_quantities_share_the_log(void)
{
	static const struct {
		uint8_t control;
		uint16_t data;
	} kinds[] = {{0x03, 0x2000}, {0x0F, 0x2000}, {0x07, 0x2400}, {0x0B, 0x1A00}};

	for (unsigned i = 0; i < 4; i++) {
		plug(&sim_ds1923);
		set(0, 20);
		set(1, 50);
		mission_41(kinds[i].control);
		hand.now += 1000 * HAND_MS;
		TEST_ASSERT_EQUAL_HEX8(122, byte_41(0x1000));
		TEST_ASSERT_EQUAL_HEX8(2034 >> 4, byte_41(kinds[i].data));
	}
}

static void test_a_mission_waits_for_its_delay_and_protects_its_registers(void)
{
	plug(&sim_ds1922l);
	write_bytes(0x216, 3, (const uint8_t[]){2, 0, 0}, 0x99);
	mission_41(0x01);
	hand.now += MINUTE;
	TEST_ASSERT_EQUAL_UINT8(0, byte_41(0x220));
	write_bytes(0x206, 1, (const uint8_t[]){99}, 0x99);
	TEST_ASSERT_EQUAL_UINT8(10, byte_41(0x206));
	write_bytes(0x20, 1, (const uint8_t[]){99}, 0x99);
	TEST_ASSERT_EQUAL_UINT8(99, byte_41(0x20));
	hand.now += MINUTE;
	TEST_ASSERT_EQUAL_UINT8(1, byte_41(0x220));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x02, byte_41(0x21A), "the time stamp");
}

static void test_passwords_guard_reading_and_writing_and_cannot_be_read(void)
{
	static const uint8_t block[17] = {0xAA, 1, 2, 3, 4, 5, 6, 7, 8, 9, 8, 7, 6, 5, 4, 3, 2};

	plug(&sim_ds1922l);
	write_bytes(0x227, 17, block, 0x99);
	TEST_ASSERT_FALSE(read_41(0x220, NULL));
	TEST_ASSERT_TRUE(read_41(0x220, block + 1));
	TEST_ASSERT_EQUAL_HEX8(0xAA, page[7]);
	TEST_ASSERT_EACH_EQUAL_HEX8(0, page + 8, 24);
	TEST_ASSERT_TRUE(read_41(0x200, block + 9));
	command_41(0x96);
	TEST_ASSERT_TRUE(read_41(0x200, block + 9));
	TEST_ASSERT_EQUAL_HEX8(0xC0, page[0x15]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_clock_counts_over_the_end_of_february_and_of_the_century);
	RUN_TEST(test_a_forced_conversion_takes_its_time_and_counts);
	RUN_TEST(test_a_mission_logs_counts_and_notes_when_it_was_too_warm);
	RUN_TEST(test_a_mission_ends_at_a_write_and_starts_only_with_cleared_memory);
	RUN_TEST(test_a_log_that_is_full_stops_or_rolls_over);
	RUN_TEST(test_the_clock_alarm_sets_its_flag_in_a_mission);
	RUN_TEST(test_a_forced_conversion_measures_both_quantities_of_a_ds1923);
	RUN_TEST(test_a_mission_of_a_ds1922_logs_from_its_start_on_with_8_or_16_bits);
	RUN_TEST(test_two_quantities_share_the_log);
	RUN_TEST(test_a_mission_waits_for_its_delay_and_protects_its_registers);
	RUN_TEST(test_passwords_guard_reading_and_writing_and_cannot_be_read);
	return UNITY_END();
}
