/* SPDX-License-Identifier: MIT */
/* The ROM layer, bit by bit. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;

void setUp(void)
{
	hand_clear(&hand);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void test_the_checksums_are_those_of_application_note_27(void)
{
	static const uint8_t rom[8] = {0x02, 0x1C, 0xB8, 0x01, 0x00, 0x00, 0x00, 0xA2};

	TEST_ASSERT_EQUAL_HEX8(0xA2, sim_crc8(0, rom, 7));
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, rom, 8));
	TEST_ASSERT_EQUAL_HEX16(0xBB3D, sim_crc16(0, (const uint8_t *)"123456789", 9));
}

static void test_nobody_gives_no_presence(void)
{
	TEST_ASSERT_FALSE(hand_reset(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_read_rom_of_two_is_their_and(void)
{
	const uint8_t read_rom = 0x33;

	hand_plug(&hand, &sim_ds2401, 0x0F);
	hand_plug(&hand, &sim_ds2401, 0xF1);
	hand_reset(&hand);
	hand_write(&hand, &read_rom, 1);
	TEST_ASSERT_EQUAL_HEX8(0x01, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x01, hand_byte(&hand));
}

static void test_a_search_finds_all_in_order(void)
{
	uint8_t rom[40][8];
	unsigned n = 24;

	for (unsigned i = 0; i < n; i++)
		hand_plug(&hand, i % 2 ? &sim_ds2401 : &sim_ds18b20, (uint8_t)(i * 37 + 5));
	TEST_ASSERT_EQUAL_UINT(n, hand_search(&hand, 0xF0, rom, 40));
	for (unsigned i = 0; i < n; i++) {
		TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, rom[i], 8));
		for (unsigned k = 0; k < i; k++)
			TEST_ASSERT_NOT_EQUAL(0, memcmp(rom[i], rom[k], 8));
	}
}

static void test_only_the_matched_one_answers(void)
{
	struct sim_slave *first = hand_plug(&hand, &sim_ds18b20, 1);
	uint8_t scratchpad[9];
	const uint8_t read = 0xBE;

	sim_slave_option(hand_plug(&hand, &sim_ds18b20, 2), "high", 11);
	sim_slave_power_on(hand.wire.slaves[1], 0);
	hand_match(&hand, first);
	hand_write(&hand, &read, 1);
	hand_read(&hand, scratchpad, 9);
	TEST_ASSERT_EQUAL_UINT8(75, scratchpad[2]);
	hand_match(&hand, hand.wire.slaves[1]);
	TEST_ASSERT_EQUAL_UINT(1, hand.wire.active_count);
	hand_write(&hand, &read, 1);
	hand_read(&hand, scratchpad, 9);
	TEST_ASSERT_EQUAL_UINT8(11, scratchpad[2]);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
}

static void test_what_is_unplugged_is_gone_and_restarts_when_it_comes_back(void)
{
	struct sim_slave *slave = hand_plug(&hand, &sim_ds18b20, 1);

	sim_wire_plug(&hand.wire, slave, false, hand.now);
	TEST_ASSERT_FALSE(hand_reset(&hand));
	sim_wire_plug(&hand.wire, slave, true, hand.now);
	TEST_ASSERT_TRUE(hand_reset(&hand));
	TEST_ASSERT_EQUAL_UINT64(2, slave->power_ons);
}

static void test_overdrive_is_entered_by_command_and_left_by_a_long_reset(void)
{
	const uint8_t skip = 0x3C, read = 0xBE;
	struct sim_slave *fast = hand_plug(&hand, &sim_ds28ea00, 1);

	hand_plug(&hand, &sim_ds18b20, 2);
	hand.overdrive = true;
	TEST_ASSERT_FALSE(hand_reset(&hand));
	hand.overdrive = false;
	hand_reset(&hand);
	hand_write(&hand, &skip, 1);
	TEST_ASSERT_TRUE(fast->overdrive);
	TEST_ASSERT_EQUAL_UINT(1, hand.wire.active_count);
	hand.overdrive = true;
	hand_write(&hand, &read, 1);
	TEST_ASSERT_EQUAL_HEX8(0x50, hand_byte(&hand));
	TEST_ASSERT_TRUE(hand_reset(&hand));
	hand.overdrive = false;
	TEST_ASSERT_TRUE(hand_reset(&hand));
	TEST_ASSERT_FALSE(fast->overdrive);
}

static void test_every_third_answer_is_corrupted_and_the_checksum_shows_it(void)
{
	struct sim_slave *slave = hand_plug(&hand, &sim_ds18b20, 1);
	unsigned wrong = 0;
	uint8_t scratchpad[9];

	slave->corrupt_every = 3;
	for (unsigned i = 0; i < 30; i++) {
		hand_skip(&hand, 1, 0xBE);
		hand_read(&hand, scratchpad, 9);
		wrong += sim_crc8(0, scratchpad, 9) != 0;
	}
	TEST_ASSERT_EQUAL_UINT(10, wrong);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_checksums_are_those_of_application_note_27);
	RUN_TEST(test_nobody_gives_no_presence);
	RUN_TEST(test_read_rom_of_two_is_their_and);
	RUN_TEST(test_a_search_finds_all_in_order);
	RUN_TEST(test_only_the_matched_one_answers);
	RUN_TEST(test_what_is_unplugged_is_gone_and_restarts_when_it_comes_back);
	RUN_TEST(test_overdrive_is_entered_by_command_and_left_by_a_long_reset);
	RUN_TEST(test_every_third_answer_is_corrupted_and_the_checksum_shows_it);
	return UNITY_END();
}
