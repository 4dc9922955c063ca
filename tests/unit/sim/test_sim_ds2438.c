/* SPDX-License-Identifier: MIT */
/* DS2438 against its data sheet. */
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

enum { TEMPERATURE, VDD, VAD, VSENS };

static struct hand hand;
static struct sim_slave *slave;
static uint8_t out[9];

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2438, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void page(int n)
{
	hand_skip(&hand, 2, 0xBE, n);
	hand_read(&hand, out, 9);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, out, 9));
}

static void recalled(int n)
{
	hand_skip(&hand, 2, 0xB8, n);
	page(n);
}

static void convert(int command, unsigned input, double value)
{
	slave->input[input] = sim_constant(value);
	hand_skip(&hand, 1, command);
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	recalled(0);
}

static void test_temperatures_are_coded_as_table_2_says(void)
{
	static const struct {
		double celsius;
		uint16_t raw;
	} table[] = {{125, 0x7D00},  {25.0625, 0x1910},  {0.5, 0x0080}, {0, 0x0000},
	             {-0.5, 0xFF80}, {-25.0625, 0xE6F0}, {-55, 0xC900}};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		convert(0x44, TEMPERATURE, table[i].celsius);
		TEST_ASSERT_EQUAL_HEX16(table[i].raw, out[1] | out[2] << 8);
	}
}

static void test_the_voltage_is_that_of_the_input_that_ad_selects(void)
{
	slave->input[VAD] = sim_constant(1.23);
	convert(0xB4, VDD, 5.05);
	TEST_ASSERT_EQUAL_UINT(505, out[3] | out[4] << 8);
	hand_skip(&hand, 3, 0x4E, 0, 0x00); /* in the scratchpad it is in force */
	convert(0xB4, VDD, 5.05);
	TEST_ASSERT_EQUAL_UINT(123, out[3] | out[4] << 8);
	TEST_ASSERT_EQUAL_HEX8(0x0F, out[0]); /* and the recall brought the old one back */
}

static void test_the_current_is_measured_all_the_time_while_iad_is_set(void)
{
	slave->input[VSENS] = sim_constant(-24.41);
	recalled(0);
	TEST_ASSERT_EQUAL_INT(-100, (int16_t)(out[5] | out[6] << 8));
	hand_skip(&hand, 3, 0x4E, 0, 0x0E);
	hand_skip(&hand, 2, 0x48, 0);
	hand.now += 11 * HAND_MS;
	slave->input[VSENS] = sim_constant(24.41);
	recalled(0);
	TEST_ASSERT_EQUAL_INT(-100, (int16_t)(out[5] | out[6] << 8));
}

static void test_a_busy_part_says_so_in_its_status(void)
{
	hand_skip(&hand, 1, 0xB4);
	page(0);
	TEST_ASSERT_EQUAL_HEX8(0x4F, out[0]);
	hand.now += 11 * HAND_MS;
	hand_skip(&hand, 1, 0x44);
	page(0);
	TEST_ASSERT_EQUAL_HEX8(0x1F, out[0]);
}

static void test_pages_are_kept_when_they_were_copied(void)
{
	hand_skip(&hand, 10, 0x4E, 3, 1, 2, 3, 4, 5, 6, 7, 8);
	page(3);
	TEST_ASSERT_EQUAL_HEX8(8, out[7]);
	recalled(3);
	TEST_ASSERT_EQUAL_HEX8(0, out[7]);
	hand_skip(&hand, 10, 0x4E, 3, 1, 2, 3, 4, 5, 6, 7, 8);
	hand_skip(&hand, 2, 0x48, 3);
	hand.now += 11 * HAND_MS;
	sim_slave_brownout(slave, hand.now);
	page(3); /* the scratchpad holds the memory's contents at once */
	TEST_ASSERT_EQUAL_HEX8(8, out[7]);
}

static void test_the_elapsed_time_meter_counts_seconds_from_what_was_written(void)
{
	hand.now += 5500 * HAND_MS;
	recalled(1);
	TEST_ASSERT_EQUAL_UINT8(5, out[0]);
	hand_skip(&hand, 6, 0x4E, 1, 0x00, 0x01, 0x00, 0x00);
	hand_skip(&hand, 2, 0x48, 1);
	hand.now += 7100 * HAND_MS;
	recalled(1);
	TEST_ASSERT_EQUAL_UINT(256 + 7, out[0] | out[1] << 8);
}

static void test_a_ds2437_answers_the_same_commands_with_its_own_family_code(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2437, 1);
	TEST_ASSERT_EQUAL_HEX8(0x1E, slave->rom[0]);
	convert(0x44, TEMPERATURE, 25.0625);
	TEST_ASSERT_EQUAL_HEX16(0x1910, out[1] | out[2] << 8);
}

static void test_a_program_that_plays_one_has_no_page_8(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2438_emulated, 1);
	hand_skip(&hand, 3, 0x4E, 0x03, 0x5A);
	hand_skip(&hand, 3, 0x4E, 0x0B, 0xA5);
	page(3);
	TEST_ASSERT_EQUAL_HEX8(0x5A, out[0]);
	hand_skip(&hand, 2, 0xBE, 0x0B);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_temperatures_are_coded_as_table_2_says);
	RUN_TEST(test_the_voltage_is_that_of_the_input_that_ad_selects);
	RUN_TEST(test_the_current_is_measured_all_the_time_while_iad_is_set);
	RUN_TEST(test_a_busy_part_says_so_in_its_status);
	RUN_TEST(test_pages_are_kept_when_they_were_copied);
	RUN_TEST(test_the_elapsed_time_meter_counts_seconds_from_what_was_written);
	RUN_TEST(test_a_ds2437_answers_the_same_commands_with_its_own_family_code);
	RUN_TEST(test_a_program_that_plays_one_has_no_page_8);
	return UNITY_END();
}
