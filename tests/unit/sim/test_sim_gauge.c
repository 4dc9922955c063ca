/* SPDX-License-Identifier: MIT */
/* Battery gauges: their registers, EEPROM, pins and flags do what their data sheets say. */
#include "unity.h"

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

static void plug(const struct sim_family *family)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, family, 1);
}

static uint8_t byte_at(uint8_t at)
{
	hand_skip(&hand, 2, 0x69, at);
	return hand_byte(&hand);
}

static int word_at(uint8_t at)
{
	int high;

	hand_skip(&hand, 2, 0x69, at);
	high = hand_byte(&hand);
	return (int16_t)(high << 8 | hand_byte(&hand));
}

static void put(uint8_t at, uint8_t byte)
{
	hand_skip(&hand, 3, 0x6C, at, byte);
}

static void command(uint8_t code, uint8_t at)
{
	hand_skip(&hand, 2, code, at);
	hand.now += 11 * HAND_MS;
}

static void input(const char *name, double value)
{
	int number = sim_slave_input(slave, name);

	TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(0, number, name);
	sim_slave_advance(slave, hand.now);
	slave->input[number] = sim_constant(value);
	hand.now += HAND_MS;
}

static void test_each_part_has_its_measurements_where_and_as_its_data_sheet_says(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t celsius, average;
		int volt, vis, mean; /* registers for 3.904 V and -10 mV */
	} parts[] = {
		{&sim_ds2740, 0, 0, 0, -6400, 0},
		{&sim_ds2751, 0x18, 0, 800 * 32, -640 * 8, 0},
		{&sim_ds2755, 0x18, 0x1A, 800 * 32, -640 * 8, -5120},
		{&sim_ds2760, 0x18, 0, 800 * 32, -640 * 8, 0},
		{&sim_ds2770, 0x18, 0, 800 * 32, -6400, 0},
		{&sim_ds2780, 0x0A, 0x08, 800 * 32, -6400, -6400},
		{&sim_ds2781, 0x0A, 0x08, 400 * 32, -6400, -6400},
	};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		plug(parts[i].family);
		input("temperature", -25.125);
		input("volt", 3.904);
		input("vis", -10);
		TEST_ASSERT_EQUAL_INT_MESSAGE(parts[i].volt, word_at(0x0C), parts[i].family->name);
		TEST_ASSERT_EQUAL_INT_MESSAGE(parts[i].vis, word_at(0x0E), parts[i].family->name);
		if (parts[i].celsius)
			TEST_ASSERT_EQUAL_INT_MESSAGE(-201 * 32, word_at(parts[i].celsius),
			                              parts[i].family->name);
		if (parts[i].average)
			TEST_ASSERT_EQUAL_INT_MESSAGE(parts[i].mean, word_at(parts[i].average),
			                              parts[i].family->name);
	}
}

static void test_the_current_is_accumulated_and_the_host_can_set_the_sum(void)
{
	plug(&sim_ds2760);
	input("vis", 25);
	hand.now += 3600 * 1000 * HAND_MS; /* 25 mVh: 4000 units */
	TEST_ASSERT_INT_WITHIN(1, 4000, word_at(0x10));
	hand_skip(&hand, 4, 0x6C, 0x10, 0xFF, 0x9C);
	TEST_ASSERT_INT_WITHIN(1, -100, word_at(0x10));
	input("vis", -25);
	hand.now += 3600 * 1000 * HAND_MS;
	TEST_ASSERT_INT_WITHIN(1, -4100, word_at(0x10));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_INT(0, word_at(0x10));
	plug(&sim_ds2780);
	hand_skip(&hand, 4, 0x6C, 0x10, 0x01, 0x00);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_INT_MESSAGE(256, word_at(0x10), "a DS2780 saves it");
}

static void test_a_bias_changes_the_current_where_the_part_has_one(void)
{
	plug(&sim_ds2760);
	put(0x33, 10); /* is subtracted, 15.625 uV each */
	TEST_ASSERT_EQUAL_INT(-10 * 8, word_at(0x0E));
	plug(&sim_ds2770);
	hand_skip(&hand, 4, 0x6C, 0x32, 0xFF, 0x00);
	TEST_ASSERT_EQUAL_INT(256, word_at(0x0E));
	plug(&sim_ds2781);
	put(0x7B, 0xF6); /* is added */
	TEST_ASSERT_EQUAL_INT(-10, word_at(0x0E));
	plug(&sim_ds2780);
	put(0x61, 64); /* adds 0.1 mV to what is accumulated */
	hand.now += 3600 * 1000 * HAND_MS;
	TEST_ASSERT_EQUAL_INT(0, word_at(0x0E));
	TEST_ASSERT_INT_WITHIN(1, 16, word_at(0x10));
}

static void test_the_pin_is_low_if_the_output_or_the_world_pulls_it(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t at, bit;
	} parts[] = {{&sim_ds2740, 8, 0x40}, {&sim_ds2751, 8, 0x40},    {&sim_ds2755, 8, 0x40},
	             {&sim_ds2760, 8, 0x40}, {&sim_ds2780, 0x15, 0x01}, {&sim_ds2781, 0x15, 0x01}};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		uint8_t at = parts[i].at, bit = parts[i].bit;

		plug(parts[i].family);
		TEST_ASSERT_TRUE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
		put(at, 0);
		TEST_ASSERT_FALSE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
		put(at, bit);
		TEST_ASSERT_TRUE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
		input("pin", 0);
		TEST_ASSERT_FALSE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
	}
}

static void test_a_block_is_copied_recalled_and_locked(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t reg, block, at;
	} parts[] = {{&sim_ds2751, 0x07, 0, 0x20}, {&sim_ds2755, 0x07, 2, 0x7F},
	             {&sim_ds2760, 0x07, 1, 0x3F}, {&sim_ds2770, 0x07, 2, 0x47},
	             {&sim_ds2780, 0x1F, 1, 0x70}, {&sim_ds2781, 0x1F, 0, 0x2F}};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		uint8_t reg = parts[i].reg, at = parts[i].at;

		plug(parts[i].family);
		put(at, 0x5A);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x5A, byte_at(at), parts[i].family->name);
		command(0xB8, at);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, byte_at(at), parts[i].family->name);
		put(at, 0x5A);
		hand_skip(&hand, 2, 0x48, at);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x80, byte_at(reg), "EEC");
		put(at, 0x33);
		hand.now += 11 * HAND_MS;
		TEST_ASSERT_EQUAL_HEX8(0, byte_at(reg));
		sim_slave_brownout(slave, hand.now);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x5A, byte_at(at), parts[i].family->name);
		command(0x6A, at);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, byte_at(reg), "without the bit");
		put(reg, 0x40);
		command(0x6A, at);
		TEST_ASSERT_EQUAL_HEX8(1 << parts[i].block, byte_at(reg));
		put(at, 0x77);
		put(reg, 0);
		sim_slave_brownout(slave, hand.now);
		TEST_ASSERT_EQUAL_HEX8(0x5A, byte_at(at));
		TEST_ASSERT_EQUAL_HEX8(1 << parts[i].block, byte_at(reg));
	}
}

static void test_the_status_takes_its_defaults_from_the_eeprom(void)
{
	static const struct sim_family *const parts[] = {&sim_ds2751, &sim_ds2755, &sim_ds2760};

	for (unsigned i = 0; i < 3; i++) {
		plug(parts[i]);
		put(1, 0x20);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, byte_at(1), "it is read-only");
		put(0x31, 0x20);
		TEST_ASSERT_EQUAL_HEX8(0, byte_at(1));
		command(0x48, 0x31);
		command(0xB8, 0x31);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x20, byte_at(1), parts[i]->name);
		sim_slave_brownout(slave, hand.now);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x20, byte_at(1), parts[i]->name);
	}
	plug(&sim_ds2770);
	put(0x31, 0x21);
	hand_skip(&hand, 1, 0x63);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, byte_at(1), "not from the shadow");
	command(0x48, 0x31);
	command(0xB8, 0x31);
	TEST_ASSERT_EQUAL_HEX8(0, byte_at(1));
	hand_skip(&hand, 1, 0x63);
	TEST_ASSERT_EQUAL_HEX8(0x21, byte_at(1));
}

static void test_a_power_on_is_flagged_until_the_host_clears_it(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t at, bit;
	} parts[] = {{&sim_ds2751, 8, 0x01},
	             {&sim_ds2755, 8, 0x80},
	             {&sim_ds2780, 1, 0x02},
	             {&sim_ds2781, 1, 0x02}};

	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		uint8_t at = parts[i].at, bit = parts[i].bit;

		plug(parts[i].family);
		TEST_ASSERT_TRUE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
		put(at, 0x40);
		TEST_ASSERT_FALSE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
		put(at, 0xFF);
		TEST_ASSERT_FALSE_MESSAGE(byte_at(at) & bit, "no host sets it");
		sim_slave_brownout(slave, hand.now);
		TEST_ASSERT_TRUE_MESSAGE(byte_at(at) & bit, parts[i].family->name);
	}
}

static void test_a_ds2760_keeps_the_flags_of_its_protection_until_they_are_cleared(void)
{
	static const struct {
		const char *name;
		uint8_t flag, pins;
	} conditions[] = {{"overvoltage", 0x80, 0x08},
	                  {"undervoltage", 0x40, 0x04},
	                  {"charge_overcurrent", 0x20, 0x08},
	                  {"discharge_overcurrent", 0x10, 0x04}};

	plug(&sim_ds2760);
	TEST_ASSERT_EQUAL_HEX8(0x03, byte_at(0));
	for (unsigned i = 0; i < 4; i++) {
		uint8_t set = conditions[i].flag | conditions[i].pins | 0x03;

		input(conditions[i].name, 1);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(set, byte_at(0), conditions[i].name);
		input(conditions[i].name, 0);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(set, byte_at(0), conditions[i].name);
		put(0, 0x03);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x03, byte_at(0), conditions[i].name);
	}
	put(0, 0xF2);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x06, byte_at(0), "DC is high without DE");
	command(0xB8, 0x30);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x03, byte_at(0), "both are the default");
	TEST_ASSERT_TRUE(byte_at(8) & 0x80);
	input("ps", 0);
	input("ps", 1);
	TEST_ASSERT_FALSE(byte_at(8) & 0x80);
	put(8, 0xC0);
	TEST_ASSERT_TRUE(byte_at(8) & 0x80);
}

static void test_a_ds2770_charges_and_counts_its_time(void)
{
	plug(&sim_ds2770);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(1));
	input("charger", 1);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x80, byte_at(1), "the source is present");
	hand_skip(&hand, 1, 0xB5);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x40, byte_at(1), "it charges");
	hand_skip(&hand, 1, 0xBE);
	TEST_ASSERT_EQUAL_HEX8(0x80, byte_at(1));
	hand_skip(&hand, 1, 0xB5);
	input("full", 1);
	input("charger", 0);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xC0, byte_at(1), "it is complete");
	put(1, 0);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(1));
	hand_skip(&hand, 4, 0x6C, 2, 0x01, 0x00);
	hand.now += 10 * 56250 * HAND_MS;
	TEST_ASSERT_EQUAL_INT(266, word_at(2));
}

static void test_a_ds2780_reports_what_it_found_of_the_battery(void)
{
	plug(&sim_ds2780);
	TEST_ASSERT_EQUAL_HEX8(0x02, byte_at(1));
	input("charged", 1);
	input("learning", 1);
	put(1, 0);
	TEST_ASSERT_EQUAL_HEX8(0x90, byte_at(1));
	input("volt", 2.4);
	input("volt", 3);
	TEST_ASSERT_EQUAL_HEX8(0x94, byte_at(1));
	put(1, 0);
	TEST_ASSERT_EQUAL_HEX8(0x90, byte_at(1));
	plug(&sim_ds2781);
	put(1, 0);
	input("volt", 4.8);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_at(1));
	put(0x60, 0x08);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x04, byte_at(1), "4.9 V with UVTH");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_part_has_its_measurements_where_and_as_its_data_sheet_says);
	RUN_TEST(test_the_current_is_accumulated_and_the_host_can_set_the_sum);
	RUN_TEST(test_a_bias_changes_the_current_where_the_part_has_one);
	RUN_TEST(test_the_pin_is_low_if_the_output_or_the_world_pulls_it);
	RUN_TEST(test_a_block_is_copied_recalled_and_locked);
	RUN_TEST(test_the_status_takes_its_defaults_from_the_eeprom);
	RUN_TEST(test_a_power_on_is_flagged_until_the_host_clears_it);
	RUN_TEST(test_a_ds2760_keeps_the_flags_of_its_protection_until_they_are_cleared);
	RUN_TEST(test_a_ds2770_charges_and_counts_its_time);
	RUN_TEST(test_a_ds2780_reports_what_it_found_of_the_battery);
	return UNITY_END();
}
