/* SPDX-License-Identifier: MIT */
/* TMP1826: temperatures, settings and memory are as the data sheet says. */
#include "unity.h"

#include "hal/sim/chips/tmp1826.h"
#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;
static uint8_t pad[18];

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_tmp1826, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static int scratchpad(void)
{
	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, pad, 18);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, pad, 8), pad[8]);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, pad + 9, 8), pad[17]);
	return pad[0] | pad[1] << 8;
}

static int measure(double celsius)
{
	slave->input[0] = sim_constant(celsius);
	hand_skip(&hand, 1, 0x44);
	hand.now += 7 * HAND_MS;
	return scratchpad();
}

static uint8_t write_settings(uint8_t first, uint8_t offset)
{
	hand_skip(&hand, 10, 0x4E, first, 0x80, 0x12, 0x00, 0x0A, 0x00, 0x14, offset, 0x00);
	return hand_byte(&hand);
}

static void test_it_answers_with_the_code_of_a_ds2438_and_starts_at_zero(void)
{
	TEST_ASSERT_EQUAL_HEX8(0x26, slave->rom[0]);
	TEST_ASSERT_EQUAL_HEX16(0, scratchpad());
	TEST_ASSERT_EQUAL_HEX8(0x30, pad[2]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, pad[3]);
	TEST_ASSERT_EQUAL_HEX8(0x70, pad[4]);
	TEST_ASSERT_EQUAL_HEX8(0x80, pad[5]);
	TEST_ASSERT_EQUAL_HEX8(0xFF, pad[7]);
}

static void test_temperatures_are_coded_as_both_tables_say(void)
{
	static const struct {
		double celsius;
		uint16_t legacy, precise;
	} table[] = {{127, 0x07F0, 0x3F80}, {100, 0x0640, 0x3200}, {25, 0x0190, 0x0C80},
	             {1, 0x0010, 0x0080},   {0, 0x0000, 0x0000},   {-1, 0xFFF0, 0xFF80},
	             {-25, 0xFE70, 0xF380}};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		TEST_ASSERT_EQUAL_HEX16(table[i].legacy, measure(table[i].celsius));
	write_settings(0xF0, 0);
	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		TEST_ASSERT_EQUAL_HEX16(table[i].precise, measure(table[i].celsius));
	TEST_ASSERT_EQUAL_HEX16(0x0001, measure(0.0078125));
}

static void test_a_reading_of_the_status_clears_that_there_is_a_new_result(void)
{
	measure(25);
	TEST_ASSERT_EQUAL_HEX8(0x38, pad[2]);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8(0x30, pad[2]);
	measure(26);
	hand_skip(&hand, 1, 0x44);
	hand.now += 7 * HAND_MS;
	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, pad, 2);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x38, pad[2], "the status was not read");
}

static void test_a_conversion_takes_its_time_and_shows_no_busy_slot(void)
{
	slave->input[0] = sim_constant(25);
	hand_skip(&hand, 1, 0x44);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX16(0, scratchpad());
	hand.now += 7 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX16(0x0190, scratchpad());
}

static void test_settings_last_if_they_are_copied(void)
{
	const uint8_t sent[9] = {0xF0, 0x80, 0x12, 0x00, 0x0A, 0x00, 0x14, 0x80, 0x00};

	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, sent, 9), write_settings(0xF0, 0x80));
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0D00, measure(25), "with the offset of 1");
	TEST_ASSERT_EQUAL_HEX8(0x12, pad[6]);
	sim_slave_brownout(slave, hand.now);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8(0x00, pad[6]);
	write_settings(0xF0, 0);
	hand_skip(&hand, 1, 0x48);
	hand.now += 22 * HAND_MS;
	sim_slave_brownout(slave, hand.now);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8(0x12, pad[6]);
}

static void test_an_alert_answers_the_alarm_search(void)
{
	write_settings(0xF0, 0); /* 20 to 40 */
	measure(30);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	measure(41);
	TEST_ASSERT_EQUAL_HEX8(0xB8, pad[2]);
	slave->input[0] = sim_constant(19);
	hand_skip(&hand, 1, 0x44);
	hand.now += 7 * HAND_MS;
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
}

static uint8_t stage(uint8_t at, uint8_t first)
{
	hand_skip(&hand, 11, 0x0F, 0, at, first, 2, 3, 4, 5, 6, 7, 8);
	return hand_byte(&hand);
}

static void copy(uint8_t key)
{
	hand_skip(&hand, 2, 0x55, key);
	hand.now += 22 * HAND_MS;
}

/* Read EEPROM from an address on; the line stays high for tREADIDLE. */
static void read_from(uint8_t at)
{
	hand_skip(&hand, 3, 0xF0, 0, at);
	hand.now += HAND_MS;
}

static void test_the_memory_is_written_by_blocks_of_eight_and_read_by_them(void)
{
	const uint8_t sent[10] = {0, 0x28, 1, 2, 3, 4, 5, 6, 7, 8};
	uint8_t out[12];

	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, sent, 10), stage(0x28, 1));
	hand_skip(&hand, 3, 0xAA, 0, 0x28);
	hand_read(&hand, out, 9);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(sent + 2, out, 8);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, sent, 10), out[8]);
	hand_skip(&hand, 3, 0xAA, 0, 0x20);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFF, hand_byte(&hand), "another address");
	copy(0xA4);
	read_from(0x28);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	copy(0xA5);
	read_from(0x2B); /* from the beginning of the block */
	hand_read(&hand, out, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(sent + 2, out, 8);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFF, hand_byte(&hand), "the next block");
	((struct sim_tmp1826 *)slave->state)->checked_blocks = true;
	read_from(0x28);
	hand_read(&hand, out, 9);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(sent + 2, out, 8);
	TEST_ASSERT_EQUAL_HEX8(sim_crc8(0, out, 8), out[8]);
}

static void test_a_block_comes_after_the_time_that_it_takes_to_fetch_it(void)
{
	struct sim_tmp1826 *state = slave->state;

	state->memory[0] = 0x5A;
	hand_skip(&hand, 3, 0xF0, 0, 0);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	read_from(0);
	TEST_ASSERT_EQUAL_HEX8(0x5A, hand_byte(&hand));
}

static void test_a_page_that_is_locked_keeps_its_bytes(void)
{
	stage(0x28, 1);
	copy(0xA5);
	hand_skip(&hand, 4, 0x0F, 0x80, 0x01, 0x55);
	hand_byte(&hand);
	copy(0xA5);
	stage(0x28, 9);
	copy(0xA5);
	read_from(0x28);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	stage(0x48, 9);
	copy(0xA5);
	read_from(0x48);
	TEST_ASSERT_EQUAL_HEX8(9, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_answers_with_the_code_of_a_ds2438_and_starts_at_zero);
	RUN_TEST(test_temperatures_are_coded_as_both_tables_say);
	RUN_TEST(test_a_reading_of_the_status_clears_that_there_is_a_new_result);
	RUN_TEST(test_a_conversion_takes_its_time_and_shows_no_busy_slot);
	RUN_TEST(test_settings_last_if_they_are_copied);
	RUN_TEST(test_an_alert_answers_the_alarm_search);
	RUN_TEST(test_the_memory_is_written_by_blocks_of_eight_and_read_by_them);
	RUN_TEST(test_a_block_comes_after_the_time_that_it_takes_to_fetch_it);
	RUN_TEST(test_a_page_that_is_locked_keeps_its_bytes);
	return UNITY_END();
}
