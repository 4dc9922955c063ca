/* SPDX-License-Identifier: MIT */
/* The thermometers against the tables of their data sheets. */
#include <string.h>

#include "unity.h"

#include "hal/sim/chips/thermometer.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds18b20, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static int scratchpad(uint8_t out[9])
{
	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, out, 9);
	return (int16_t)(out[0] | out[1] << 8);
}

static int measure(double celsius)
{
	uint8_t out[9];

	slave->input[SIM_TEMPERATURE] = sim_constant(celsius);
	hand_skip(&hand, 1, 0x44);
	hand.now += 800 * HAND_MS;
	return scratchpad(out);
}

static void test_the_scratchpad_starts_as_figure_8_says(void)
{
	static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
	uint8_t out[9];

	scratchpad(out);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, out, 5);
	TEST_ASSERT_EQUAL_HEX8(0xFF, out[5]);
	TEST_ASSERT_EQUAL_HEX8(0x10, out[7]);
}

static void test_temperatures_are_coded_as_table_1_says(void)
{
	static const struct {
		double celsius;
		uint16_t raw;
	} table[] = {{125, 0x07D0},      {85, 0x0550}, {25.0625, 0x0191}, {10.125, 0x00A2},
	             {0.5, 0x0008},      {0, 0x0000},  {-0.5, 0xFFF8},    {-10.125, 0xFF5E},
	             {-25.0625, 0xFE6F}, {-55, 0xFC90}};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		TEST_ASSERT_EQUAL_HEX16(table[i].raw, measure(table[i].celsius));
}

static void test_a_ds18s20_counts_as_its_data_sheet_says(void)
{
	uint8_t out[9];

	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds18s20, 1);
	TEST_ASSERT_EQUAL_HEX16(0x00AA, scratchpad(out));
	TEST_ASSERT_EQUAL_HEX16(0x0032, measure(25));
	TEST_ASSERT_EQUAL_HEX16(0xFFCE, measure(-25));
	for (int raw = -55 * 16; raw <= 85 * 16; raw++) {
		int whole;
		double finer;

		measure(raw / 16.0);
		whole = (int16_t)(scratchpad(out)) >> 1;
		finer = whole - 0.25 + (out[7] - out[6]) / (double)out[7];
		TEST_ASSERT_EQUAL_DOUBLE(raw / 16.0, finer);
	}
}

static void test_a_conversion_takes_what_the_resolution_needs(void)
{
	static const int64_t takes[4] = {93750000, 187500000, 375000000, 750000000};

	for (int bits = 9; bits <= 12; bits++) {
		int64_t begun;

		hand_skip(&hand, 4, 0x4E, 75, 70, (bits - 9) << 5 | 0x1F);
		hand_skip(&hand, 1, 0x44);
		begun = hand.now;
		while (!hand_bit(&hand, true))
			TEST_ASSERT_LESS_THAN_INT64(800 * HAND_MS, hand.now - begun);
		TEST_ASSERT_INT64_WITHIN(200000, takes[bits - 9], hand.now - begun);
		TEST_ASSERT_EQUAL_HEX16(0x0191 & ~((1 << (12 - bits)) - 1), measure(25.0625));
	}
}

static void test_the_value_is_the_old_one_until_the_conversion_ends(void)
{
	uint8_t out[9];

	slave->input[SIM_TEMPERATURE] = sim_constant(10);
	hand_skip(&hand, 1, 0x44);
	hand.now += 700 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX16(0x0550, scratchpad(out));
	hand.now += 100 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX16(0x00A0, scratchpad(out));
}

static void test_the_eeprom_keeps_what_was_copied_and_only_that(void)
{
	uint8_t out[9];

	hand_skip(&hand, 4, 0x4E, 30, 0xF6, 0x3F);
	hand_skip(&hand, 1, 0x48);
	hand.now += 11 * HAND_MS;
	hand_skip(&hand, 4, 0x4E, 1, 2, 0x7F);
	sim_slave_power_on(slave, hand.now);
	scratchpad(out);
	TEST_ASSERT_EQUAL_UINT8(30, out[2]);
	TEST_ASSERT_EQUAL_HEX8(0xF6, out[3]);
	TEST_ASSERT_EQUAL_HEX8(0x3F, out[4]);
	hand_skip(&hand, 4, 0x4E, 1, 2, 0x7F);
	hand_skip(&hand, 1, 0xB8);
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	scratchpad(out);
	TEST_ASSERT_EQUAL_UINT8(30, out[2]);
}

static void test_the_alarm_is_set_by_a_conversion_beyond_the_limits(void)
{
	hand_skip(&hand, 4, 0x4E, 30, 10, 0x7F);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	measure(20);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	measure(30);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	measure(29.9375);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	measure(10.5);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	measure(11);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
}

static void test_the_power_supply_is_told(void)
{
	hand_skip(&hand, 1, 0xB4);
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	slave->parasite = true;
	hand_skip(&hand, 1, 0xB4);
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
}

static void test_without_the_strong_pullup_a_parasite_restarts(void)
{
	uint8_t out[9];

	slave->parasite = true;
	slave->input[SIM_TEMPERATURE] = sim_constant(10);
	TEST_ASSERT_EQUAL_HEX16(0x0550, measure(10));
	TEST_ASSERT_EQUAL_UINT64(2, slave->power_ons);

	hand_skip(&hand, 1, 0x44);
	sim_wire_strong(&hand.wire, true, hand.now);
	hand.now += 760 * HAND_MS;
	sim_wire_strong(&hand.wire, false, hand.now);
	TEST_ASSERT_EQUAL_HEX16(0x00A0, scratchpad(out));
	TEST_ASSERT_EQUAL_UINT64(2, slave->power_ons);

	hand_skip(&hand, 1, 0x44);
	sim_wire_strong(&hand.wire, true, hand.now);
	hand.now += 600 * HAND_MS;
	sim_wire_strong(&hand.wire, false, hand.now);
	TEST_ASSERT_EQUAL_HEX16(0x0550, scratchpad(out));
}

static void test_a_clone_ignores_the_resolution(void)
{
	uint8_t out[9];

	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "fixed", 1));
	hand_skip(&hand, 4, 0x4E, 75, 70, 0x1F);
	scratchpad(out);
	TEST_ASSERT_EQUAL_HEX8(0x7F, out[4]);
	TEST_ASSERT_EQUAL_HEX16(0x0191, measure(25.0625));
}

static void test_a_ds1825_shows_its_address_pins(void)
{
	uint8_t out[9];

	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds1825, 1);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "address", 9));
	sim_slave_power_on(slave, 0);
	scratchpad(out);
	TEST_ASSERT_EQUAL_HEX8(0x79, out[4]);
}

static void test_a_ds28ea00_reads_and_writes_its_pins(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds28ea00, 1);
	hand_skip(&hand, 1, 0xF5);
	TEST_ASSERT_EQUAL_HEX8(0x0F, hand_byte(&hand));
	hand_skip(&hand, 3, 0xA5, 0xFE, 0x01);
	TEST_ASSERT_EQUAL_HEX8(0xAA, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x3C, hand_byte(&hand));
	hand_skip(&hand, 1, 0xF5);
	slave->input[SIM_PIN_B] = sim_constant(0);
	TEST_ASSERT_EQUAL_HEX8(0x3C, hand_byte(&hand)); /* sampled before */
	TEST_ASSERT_EQUAL_HEX8(0x78, hand_byte(&hand));
	hand_skip(&hand, 3, 0xA5, 0xFF, 0x01);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_scratchpad_starts_as_figure_8_says);
	RUN_TEST(test_temperatures_are_coded_as_table_1_says);
	RUN_TEST(test_a_ds18s20_counts_as_its_data_sheet_says);
	RUN_TEST(test_a_conversion_takes_what_the_resolution_needs);
	RUN_TEST(test_the_value_is_the_old_one_until_the_conversion_ends);
	RUN_TEST(test_the_eeprom_keeps_what_was_copied_and_only_that);
	RUN_TEST(test_the_alarm_is_set_by_a_conversion_beyond_the_limits);
	RUN_TEST(test_the_power_supply_is_told);
	RUN_TEST(test_without_the_strong_pullup_a_parasite_restarts);
	RUN_TEST(test_a_clone_ignores_the_resolution);
	RUN_TEST(test_a_ds1825_shows_its_address_pins);
	RUN_TEST(test_a_ds28ea00_reads_and_writes_its_pins);
	return UNITY_END();
}
