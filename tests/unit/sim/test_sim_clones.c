/* SPDX-License-Identifier: MIT */
/* The clones of the DS18B20 do what the catalogue of their kinds says, and the MAX31825. */
#include "unity.h"

#include "hal/sim/chips/thermometer.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;
static uint8_t pad[9];

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

static int scratchpad(void)
{
	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, pad, 9);
	return (int16_t)(pad[0] | pad[1] << 8);
}

static int measure(double celsius, int ms)
{
	slave->input[SIM_TEMPERATURE] = sim_constant(celsius);
	hand_skip(&hand, 1, 0x44);
	hand.now += ms * HAND_MS;
	return scratchpad();
}

static void test_each_kind_starts_with_its_own_scratchpad(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t first[8];
	} kinds[] = {
		{&sim_ds18b20, {0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10}},
		{&sim_ds18b20_a3, {0x50, 0x05, 0x7F, 0x80, 0x7F, 0xFF, 0x0C, 0x10}},
		{&sim_ds18b20_b1, {0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10}},
		{&sim_ds18b20_c, {0x50, 0x05, 0x55, 0x00, 0x7F, 0xFF, 0x0C, 0x10}},
		{&sim_ds18b20_d1, {0x90, 0x01, 0x55, 0x05, 0x7F, 0x7E, 0x81, 0x66}},
		{&sim_ds18b20_e, {0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x10, 0x10}},
		{&sim_ds18b20_g, {0x50, 0x05, 0x55, 0xAA, 0x7F, 0xFF, 0x0C, 0x10}},
		{&sim_ds18b20_h, {0x50, 0x05, 0x55, 0xAA, 0x7F, 0xFF, 0x0C, 0x10}},
	};

	for (unsigned i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		plug(kinds[i].family);
		scratchpad();
		TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(kinds[i].first, pad, 8, kinds[i].family->name);
	}
}

static void test_each_kind_converts_in_its_own_time(void)
{
	static const struct {
		const struct sim_family *family;
		int ms;
	} kinds[] = {{&sim_ds18b20_a2, 505}, {&sim_ds18b20_b1, 728}, {&sim_ds18b20_c, 30},
	             {&sim_ds18b20_d1, 11},  {&sim_ds18b20_d2, 523}, {&sim_ds18b20_e, 25},
	             {&sim_ds18b20_f, 27},   {&sim_ds18b20_h, 279}};

	for (unsigned i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		plug(kinds[i].family);
		TEST_ASSERT_NOT_EQUAL_INT(-16, measure(-1, kinds[i].ms - 10));
		TEST_ASSERT_EQUAL_INT_MESSAGE(-16, measure(-1, kinds[i].ms + 1),
		                              kinds[i].family->name);
	}
	plug(&sim_ds18b20_h);
	hand_skip(&hand, 4, 0x4E, 0x55, 0x55, 0x1F);
	TEST_ASSERT_EQUAL_INT(-16, measure(-1, 102));
	plug(&sim_ds18b20_d2);
	hand_skip(&hand, 4, 0x4E, 0x55, 0x55, 0x1F);
	TEST_ASSERT_NOT_EQUAL_INT(-16, measure(-1, 500));
}

static void test_byte_6_gives_a_kind_away(void)
{
	plug(&sim_ds18b20_a2);
	measure(25.0625, 800);
	TEST_ASSERT_EQUAL_HEX8(0x0F, pad[6]);
	plug(&sim_ds18b20_g);
	measure(25.0625, 800);
	TEST_ASSERT_EQUAL_HEX8(0x1F, pad[6]);
	plug(&sim_ds18b20_b2);
	measure(25.0625, 800);
	TEST_ASSERT_EQUAL_HEX8(0x0C, pad[6]);
	hand_skip(&hand, 4, 0x4E, 0x11, 0x22, 0x3F);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x3F, pad[6], "the configuration is there too");
	hand_skip(&hand, 6, 0x4E, 0x11, 0x22, 0x3F, 0x66, 0x77);
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8(0x3F, pad[4]);
	TEST_ASSERT_EQUAL_HEX8(0x66, pad[6]);
	TEST_ASSERT_EQUAL_HEX8(0x77, pad[7]);
}

static void store(uint8_t high)
{
	hand_skip(&hand, 4, 0x4E, high, 0x00, 0x7F);
	hand_skip(&hand, 1, 0x48);
	hand.now += 11 * HAND_MS;
	sim_slave_brownout(slave, hand.now);
	scratchpad();
}

static void test_an_eeprom_of_kind_c_endures_eight_copies_and_one_of_kind_f_is_none(void)
{
	plug(&sim_ds18b20_c);
	for (uint8_t i = 1; i <= 8; i++) {
		store(i);
		TEST_ASSERT_EQUAL_UINT8(i, pad[2]);
	}
	store(9);
	TEST_ASSERT_EQUAL_UINT8(8, pad[2]);
	plug(&sim_ds18b20_f);
	store(9);
	TEST_ASSERT_EQUAL_UINT8(0x55, pad[2]);
}

static void test_a_capacitor_keeps_the_scratchpad_over_a_loss_of_power(void)
{
	plug(&sim_ds18b20_d1);
	measure(30, 12);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_INT(30 * 16, scratchpad());
	plug(&sim_ds18b20_d2);
	measure(30, 600);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_INT(25 * 16, scratchpad());
}

static void test_busy_slots_come_late_or_not_at_all(void)
{
	plug(&sim_ds18b20_a3);
	hand_skip(&hand, 1, 0x44);
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	hand.now += HAND_MS;
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
	plug(&sim_ds18b20_f);
	hand_skip(&hand, 1, 0x44);
	hand.now += HAND_MS;
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
	plug(&sim_ds18b20_c);
	hand_skip(&hand, 1, 0x44);
	TEST_ASSERT_FALSE(hand_bit(&hand, true));
}

static void test_kind_d_does_not_work_without_a_supply_line(void)
{
	plug(&sim_ds18b20_d2);
	slave->parasite = true;
	scratchpad();
	TEST_ASSERT_EACH_EQUAL_HEX8(0xFF, pad, 9);
	hand_skip(&hand, 1, 0x44);
	TEST_ASSERT_TRUE(hand_bit(&hand, true));
}

static void test_a_max31825_has_its_own_scratchpad_and_times(void)
{
	static const uint8_t first[8] = {0, 0, 0x15, 0x60, 0x07, 0xFF, 0x90, 0xFC};

	plug(&sim_max31825);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "address", 0x15));
	scratchpad();
	TEST_ASSERT_EQUAL_HEX8_ARRAY(first, pad, 8);
	TEST_ASSERT_EQUAL_INT(-161, measure(-10.0625, 161));
	hand_skip(&hand, 6, 0x4E, 0x00, 0x01, 0x40, 0x00, 0x00); /* 8 bits; 0 to 20 */
	TEST_ASSERT_EQUAL_INT(-176, measure(-10.0625, 31));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x55, pad[2], "below TL");
	TEST_ASSERT_EQUAL_INT(320, measure(20, 31));
	TEST_ASSERT_EQUAL_HEX8(0x15, pad[2]);
	TEST_ASSERT_EQUAL_INT(336, measure(21, 31));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x95, pad[2], "above TH");
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
}

static void test_a_max31825_is_selected_by_its_location(void)
{
	plug(&sim_max31825);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "address", 0x15));
	hand_skip(&hand, 3, 0x70, 0x15, 0xBE);
	hand_read(&hand, pad, 9);
	TEST_ASSERT_EQUAL_HEX8(0x15, pad[2]);
	hand_skip(&hand, 3, 0x70, 0x16, 0xBE);
	TEST_ASSERT_EQUAL_HEX8(0xFF, hand_byte(&hand));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_kind_starts_with_its_own_scratchpad);
	RUN_TEST(test_each_kind_converts_in_its_own_time);
	RUN_TEST(test_byte_6_gives_a_kind_away);
	RUN_TEST(test_an_eeprom_of_kind_c_endures_eight_copies_and_one_of_kind_f_is_none);
	RUN_TEST(test_a_capacitor_keeps_the_scratchpad_over_a_loss_of_power);
	RUN_TEST(test_busy_slots_come_late_or_not_at_all);
	RUN_TEST(test_kind_d_does_not_work_without_a_supply_line);
	RUN_TEST(test_a_max31825_has_its_own_scratchpad_and_times);
	RUN_TEST(test_a_max31825_is_selected_by_its_location);
	return UNITY_END();
}
