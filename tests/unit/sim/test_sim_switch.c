/* SPDX-License-Identifier: MIT */
/* DS2408 and DS2413 against their data sheets. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2408, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

/* Read PIO Registers from 88h to the checksum, which is checked. */
static void registers(uint8_t out[8])
{
	uint8_t all[3 + 8 + 2] = {0xF0, 0x88, 0x00};

	hand_skip(&hand, 3, 0xF0, 0x88, 0x00);
	hand_read(&hand, all + 3, 10);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, all, 13)); /* as an inverted CRC16 does */
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	memcpy(out, all + 3, 8);
}

static void condition(uint8_t mask, uint8_t polarity, uint8_t control)
{
	hand_skip(&hand, 6, 0xCC, 0x8B, 0x00, mask, polarity, control);
}

static void drive(unsigned pin, double level)
{
	sim_slave_advance(slave, hand.now);
	slave->input[pin] = sim_constant(level);
	hand.now += HAND_MS;
}

static void test_a_ds2408_starts_with_all_off_and_porl_set(void)
{
	static const uint8_t expect[8] = {0xFF, 0xFF, 0, 0, 0, 0x88, 0xFF, 0xFF};
	uint8_t out[8];

	registers(out);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, out, 8);
	slave->parasite = true;
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0x08, out[5]);
}

static void test_a_byte_written_shows_on_the_pins_and_in_the_confirmation(void)
{
	uint8_t out[8];

	hand_skip(&hand, 3, 0x5A, 0xA5, 0x5A);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xA5, hand_byte(&hand));
	hand_write(&hand, (const uint8_t[]){0x0F, 0xF0}, 2); /* and again */
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x0F, hand_byte(&hand));
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0x0F, out[0]);
	TEST_ASSERT_EQUAL_HEX8(0x0F, out[1]);
	TEST_ASSERT_EQUAL_HEX8(0xFA, out[2]); /* bits that changed in either write */
	hand_skip(&hand, 3, 0x5A, 0xFF, 0x01);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0x0F, out[1]);
}

static void test_activity_is_latched_and_cleared_by_command(void)
{
	uint8_t out[8];

	drive(3, 0);
	drive(3, 1);
	drive(5, 0);
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0xDF, out[0]);
	TEST_ASSERT_EQUAL_HEX8(0x28, out[2]);
	hand_skip(&hand, 1, 0xC3);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0, out[2]);
}

static void test_a_pulse_between_two_looks_is_latched_unless_the_output_is_on(void)
{
	const struct sim_curve pulse = {.shape = SIM_STEPS,
	                                .steps = 3,
	                                .start_ns = hand.now,
	                                .step = {{0, 1}, {50 * HAND_MS, 0}, {60 * HAND_MS, 1}}};
	uint8_t out[8];

	hand_skip(&hand, 3, 0x5A, 0x7F, 0x80);
	hand_skip(&hand, 1, 0xC3);
	slave->input[0] = slave->input[7] = pulse;
	hand.now += 1000 * HAND_MS;
	registers(out);
	TEST_ASSERT_EQUAL_HEX8(0x01, out[2]);
	TEST_ASSERT_EQUAL_HEX8(0x7F, out[0]);
}

static void test_channel_access_read_samples_on_with_a_checksum_each_32(void)
{
	uint8_t all[1 + 32 + 2] = {0xF5};

	hand_skip(&hand, 1, 0xF5);
	hand_read(&hand, all + 1, 34);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, all, 35));
	drive(0, 0);
	hand_read(&hand, all, 34);
	TEST_ASSERT_EQUAL_HEX8(0xFF, all[0]); /* sampled before */
	TEST_ASSERT_EQUAL_HEX8(0xFE, all[31]);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, all, 34));
}

static void test_a_ds2408_answers_the_conditional_search_by_its_condition(void)
{
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave)); /* PORL */
	condition(0x03, 0x00, 0x00);                   /* pin 0 or 1 low */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	drive(1, 0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	condition(0x03, 0x00, 0x02); /* both low */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	drive(0, 0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	condition(0x04, 0x04, 0x01); /* activity on pin 2 */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	drive(2, 0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	condition(0, 0, 0x08); /* PORL cannot be set */
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	sim_slave_power_on(slave, hand.now);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
}

static void test_resume_reaches_the_one_that_was_matched(void)
{
	const uint8_t resume = 0xA5, read = 0xF5;

	hand_plug(&hand, &sim_ds2408, 2);
	hand_reset(&hand);
	hand_write(&hand, &resume, 1);
	TEST_ASSERT_EQUAL_UINT(0, hand.wire.active_count);
	hand_match(&hand, slave);
	hand_write(&hand, &read, 1);
	hand_reset(&hand);
	hand_write(&hand, &resume, 1);
	TEST_ASSERT_EQUAL_UINT(1, hand.wire.active_count);
	TEST_ASSERT_EQUAL_PTR(slave, hand.wire.active[0]);
	hand_skip(&hand, 0);
	hand_reset(&hand);
	hand_write(&hand, &resume, 1);
	TEST_ASSERT_EQUAL_UINT(0, hand.wire.active_count);
}

static void test_a_ds2413_reads_and_writes_two_pins(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2413, 1);
	hand_skip(&hand, 1, 0xF5);
	TEST_ASSERT_EQUAL_HEX8(0x0F, hand_byte(&hand));
	drive(0, 0);
	TEST_ASSERT_EQUAL_HEX8(0x0F, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x1E, hand_byte(&hand));
	hand_skip(&hand, 3, 0x5A, 0xFD, 0x02);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xD2, hand_byte(&hand));
	hand_write(&hand, (const uint8_t[]){0xFF, 0x00}, 2);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x1E, hand_byte(&hand));
	hand_skip(&hand, 3, 0x5A, 0xFC, 0x02);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_skip(&hand, 1, 0xF5);
	TEST_ASSERT_EQUAL_HEX8(0x1E, hand_byte(&hand));
}

static void test_a_program_that_plays_a_ds2413_sends_the_complement_itself(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2413_emulated, 1);
	hand_skip(&hand, 2, 0x5A, 0xFC);
	TEST_ASSERT_EQUAL_HEX8(0x03, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_skip(&hand, 1, 0xF5);
	TEST_ASSERT_EQUAL_HEX8(0xF0, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_skip(&hand, 2, 0x5A, 0xFF); /* a reset before the complement: nothing is taken */
	hand_skip(&hand, 1, 0xF5);
	TEST_ASSERT_EQUAL_HEX8(0xF0, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2408_starts_with_all_off_and_porl_set);
	RUN_TEST(test_a_byte_written_shows_on_the_pins_and_in_the_confirmation);
	RUN_TEST(test_activity_is_latched_and_cleared_by_command);
	RUN_TEST(test_a_pulse_between_two_looks_is_latched_unless_the_output_is_on);
	RUN_TEST(test_channel_access_read_samples_on_with_a_checksum_each_32);
	RUN_TEST(test_a_ds2408_answers_the_conditional_search_by_its_condition);
	RUN_TEST(test_resume_reaches_the_one_that_was_matched);
	RUN_TEST(test_a_ds2413_reads_and_writes_two_pins);
	RUN_TEST(test_a_program_that_plays_a_ds2413_sends_the_complement_itself);
	return UNITY_END();
}
