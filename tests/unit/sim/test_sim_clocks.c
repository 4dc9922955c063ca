/* SPDX-License-Identifier: MIT */
/* The clocks, the potentiometer, and the DS28E04: each command does what the data sheet says. */
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
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

/* The control byte and the counter of a DS2415. */
static uint8_t read_clock(uint32_t *seconds)
{
	uint8_t in[5];

	hand_skip(&hand, 1, 0x66);
	hand_read(&hand, in, 5);
	*seconds = in[1] | (uint32_t)in[2] << 8 | (uint32_t)in[3] << 16 | (uint32_t)in[4] << 24;
	return in[0];
}

static void check_clock(const struct sim_family *family)
{
	uint32_t seconds;

	slave = hand_plug(&hand, family, 1);
	hand_skip(&hand, 6, 0x99, 0x58, 0xFE, 0xFF, 0x00, 0x01);
	hand.now += 5 * NS_PER_S;
	TEST_ASSERT_EQUAL_HEX8(0x58, read_clock(&seconds));
	TEST_ASSERT_EQUAL_HEX32(0x0100FFFE, seconds); /* one bit of two does not start it */
	hand_skip(&hand, 2, 0x99, 0x5F);
	hand.now += 5 * NS_PER_S;
	TEST_ASSERT_EQUAL_HEX8(0x5C, read_clock(&seconds));
	TEST_ASSERT_EQUAL_HEX32(0x01010003, seconds);
	hand_clear(&hand);
}

static void test_a_clock_counts_seconds_while_both_bits_of_the_oscillator_are_set(void)
{
	check_clock(&sim_ds2415);
	check_clock(&sim_ds2417);
}

static void write_ds2404(uint16_t at, unsigned n, const uint8_t *data)
{
	uint8_t low = at & 0xFF, high = (uint8_t)(at >> 8);

	hand_skip(&hand, 3, 0x0F, low, high);
	hand_write(&hand, data, n);
	hand_skip(&hand, 4, 0x55, low, high, (low + n - 1) & 31);
	hand.now += HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
}

static void write_register(uint16_t at, uint8_t byte)
{
	write_ds2404(at, 1, &byte);
}

static uint32_t read_ds2404(uint16_t at, unsigned n)
{
	uint32_t value = 0;

	hand_skip(&hand, 3, 0xF0, at & 0xFF, at >> 8);
	for (unsigned i = 0; i < n; i++)
		value |= (uint32_t)hand_byte(&hand) << (8 * i);
	return value;
}

static void test_clock_and_timer_of_a_ds2404_run_with_the_oscillator(void)
{
	slave = hand_plug(&hand, &sim_ds2404, 1);
	hand.now += 10 * NS_PER_S;
	TEST_ASSERT_EQUAL_UINT32(0, read_ds2404(0x203, 4));
	write_register(0x201, 0x50); /* the timer stays stopped */
	hand.now += 10 * NS_PER_S;
	TEST_ASSERT_EQUAL_UINT32(10, read_ds2404(0x203, 4));
	TEST_ASSERT_EQUAL_UINT32(0, read_ds2404(0x208, 4));
	write_register(0x201, 0x10);
	hand.now += 10 * NS_PER_S;
	TEST_ASSERT_EQUAL_UINT32(20, read_ds2404(0x203, 4));
	TEST_ASSERT_EQUAL_UINT32(10, read_ds2404(0x208, 4));
	TEST_ASSERT_EQUAL_UINT32(1, read_ds2404(0x20C, 4));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_UINT32(2, read_ds2404(0x20C, 4));
	TEST_ASSERT_EQUAL_UINT32(20, read_ds2404(0x203, 4));
}

static void test_an_alarm_of_a_ds2404_ends_when_its_status_is_read(void)
{
	static const uint8_t in_5_s[] = {0, 5, 0, 0, 0};

	slave = hand_plug(&hand, &sim_ds2404, 1);
	write_register(0x200, 0x38); /* no interrupt is enabled */
	write_ds2404(0x210, 5, in_5_s);
	write_register(0x201, 0x50);
	hand.now += 6 * NS_PER_S;
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	write_register(0x200, 0x30);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	TEST_ASSERT_EQUAL_HEX8(0x31, read_ds2404(0x200, 1));
	TEST_ASSERT_EQUAL_HEX8(0x30, read_ds2404(0x200, 1));
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
}

static void test_write_protection_of_a_ds2404_is_for_good(void)
{
	static const uint8_t other[] = {0, 99, 0, 0, 0};

	slave = hand_plug(&hand, &sim_ds2404, 1);
	write_register(0x201, 0x41);
	write_ds2404(0x202, 5, other);
	TEST_ASSERT_EQUAL_UINT32(0, read_ds2404(0x203, 4));
	write_ds2404(0x207, 5, other);
	TEST_ASSERT_EQUAL_UINT32(99, read_ds2404(0x208, 4));
	write_register(0x201, 0x0E);
	TEST_ASSERT_EQUAL_HEX8(0x01, read_ds2404(0x201, 1));
	write_register(0x1FF, 0x77);
	TEST_ASSERT_EQUAL_HEX8(0x77, read_ds2404(0x1FF, 1));
}

static void check_position(uint8_t position)
{
	hand_skip(&hand, 1, 0xF0);
	TEST_ASSERT_EQUAL_HEX8(0x0C, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(position, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x00, hand_byte(&hand));
}

static void test_the_release_code_moves_the_wiper(void)
{
	static const uint8_t release = 0x96;

	slave = hand_plug(&hand, &sim_ds2890, 1);
	hand_skip(&hand, 2, 0x0F, 0x80);
	TEST_ASSERT_EQUAL_HEX8(0x80, hand_byte(&hand));
	check_position(0x00);
	hand_skip(&hand, 2, 0x0F, 0x80);
	TEST_ASSERT_EQUAL_HEX8(0x80, hand_byte(&hand));
	hand_write(&hand, &release, 1);
	check_position(0x80);
	sim_slave_brownout(slave, hand.now);
	check_position(0x00);
}

static void test_the_wiper_steps_and_stays_between_its_ends(void)
{
	static const uint8_t up = 0xC3, down = 0x99;

	slave = hand_plug(&hand, &sim_ds2890, 1);
	hand_skip(&hand, 1, down);
	TEST_ASSERT_EQUAL_HEX8(0, hand_byte(&hand));
	hand_write(&hand, &up, 1);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	hand_write(&hand, &up, 1);
	TEST_ASSERT_EQUAL_HEX8(2, hand_byte(&hand));
	check_position(2);
}

static void test_the_charge_pump_needs_a_valid_control_byte(void)
{
	static const uint8_t release = 0x96;

	slave = hand_plug(&hand, &sim_ds2890, 1);
	hand_skip(&hand, 2, 0x55, 0x40);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
	hand_skip(&hand, 2, 0x55, 0x4C);
	TEST_ASSERT_EQUAL_HEX8(0x4C, hand_byte(&hand));
	hand_write(&hand, &release, 1);
	hand_skip(&hand, 1, 0xAA);
	TEST_ASSERT_EQUAL_HEX8(0xF3, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x4C, hand_byte(&hand));
}

static uint8_t register_at(uint8_t at)
{
	hand_skip(&hand, 3, 0xF0, at, 0x02);
	return hand_byte(&hand);
}

static void test_a_ds28e04_is_written_by_scratchpad_and_key(void)
{
	uint8_t io[1 + 3 + 2 + 2] = {0xAA};

	slave = hand_plug(&hand, &sim_ds28e04, 1);
	hand_skip(&hand, 5, 0x0F, 0x21, 0x00, 0x11, 0x12);
	hand_skip(&hand, 1, 0xAA);
	hand_read(&hand, io + 1, sizeof(io) - 1);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, io, sizeof(io)));
	TEST_ASSERT_EQUAL_HEX8(0x02, io[3]);
	hand_skip(&hand, 4, 0x55, 0x21, 0x00, 0x02);
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	hand_skip(&hand, 3, 0xF0, 0x21, 0x00);
	TEST_ASSERT_EQUAL_HEX8(0x11, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x12, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x1C, register_at(0x18));
	TEST_ASSERT_EQUAL_HEX8(0xC8, register_at(0x25)); /* VCCP, POL, PORL */
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

static void test_pins_of_a_ds28e04_are_written_and_read(void)
{
	uint8_t io[1 + 32 + 2] = {0xF5};

	slave = hand_plug(&hand, &sim_ds28e04, 1);
	TEST_ASSERT_EQUAL_HEX8(3, register_at(0x20));
	hand_skip(&hand, 3, 0x5A, 0xFE, 0x01);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0xFE, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(2, register_at(0x20));
	TEST_ASSERT_EQUAL_HEX8(2, register_at(0x21));
	TEST_ASSERT_EQUAL_HEX8(1, register_at(0x22));
	hand_skip(&hand, 1, 0xC3);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0, register_at(0x22));
	hand_skip(&hand, 1, 0xF5);
	hand_read(&hand, io + 1, sizeof(io) - 1);
	TEST_ASSERT_EQUAL_HEX8(0xFE, io[1]);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, io, sizeof(io)));
}

static void test_a_ds28e04_answers_the_alarm_search_by_its_registers(void)
{
	slave = hand_plug(&hand, &sim_ds28e04, 1);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	hand_skip(&hand, 6, 0xCC, 0x23, 0x02, 0x01, 0x00, 0x00); /* pin 0, low, PORL off */
	TEST_ASSERT_EQUAL_HEX8(0xC0, register_at(0x25));
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	slave->input[0] = sim_constant(0);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	hand_skip(&hand, 4, 0xCC, 0x25, 0x02, 0x08);
	TEST_ASSERT_EQUAL_HEX8(0xC0, register_at(0x25)); /* PORL cannot be set */
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_clock_counts_seconds_while_both_bits_of_the_oscillator_are_set);
	RUN_TEST(test_clock_and_timer_of_a_ds2404_run_with_the_oscillator);
	RUN_TEST(test_an_alarm_of_a_ds2404_ends_when_its_status_is_read);
	RUN_TEST(test_write_protection_of_a_ds2404_is_for_good);
	RUN_TEST(test_the_release_code_moves_the_wiper);
	RUN_TEST(test_the_wiper_steps_and_stays_between_its_ends);
	RUN_TEST(test_the_charge_pump_needs_a_valid_control_byte);
	RUN_TEST(test_a_ds28e04_is_written_by_scratchpad_and_key);
	RUN_TEST(test_pins_of_a_ds28e04_are_written_and_read);
	RUN_TEST(test_a_ds28e04_answers_the_alarm_search_by_its_registers);
	return UNITY_END();
}
