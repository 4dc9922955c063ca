/* SPDX-License-Identifier: MIT */
/* DS2436: its conversions, its cycle counter and its memory do what the data sheet says. */
#include "unity.h"

#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *slave;

void setUp(void)
{
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_ds2436, 1);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static unsigned word_at(uint8_t at)
{
	unsigned low;

	hand_skip(&hand, 2, 0xB2, at);
	low = hand_byte(&hand);
	return low | (unsigned)hand_byte(&hand) << 8;
}

static uint8_t scratch(uint8_t at)
{
	hand_skip(&hand, 2, 0x11, at);
	return hand_byte(&hand);
}

static void command(uint8_t code)
{
	hand_skip(&hand, 1, code);
	hand.now += 11 * HAND_MS;
}

static void test_a_conversion_fills_its_register_after_ten_milliseconds(void)
{
	slave->input[0] = sim_constant(-25.0625);
	slave->input[1] = sim_constant(3.6);
	TEST_ASSERT_EQUAL_HEX16(0, word_at(0x60));
	hand_skip(&hand, 1, 0xD2);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x01, word_at(0x62) & 0xFF, "TB");
	TEST_ASSERT_EQUAL_HEX16(0, word_at(0x60));
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX16(0xE6F0, word_at(0x60));
	TEST_ASSERT_EQUAL_HEX8(0x00, word_at(0x62) & 0xFF);
	hand_skip(&hand, 1, 0xB4);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x08, word_at(0x62) & 0xFF, "ADB");
	hand.now += 11 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX16(0x0168, word_at(0x77));
}

static void test_cycles_are_counted_up_to_the_end_and_survive(void)
{
	command(0xB5);
	command(0xB5);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_UINT(2, word_at(0x82));
	command(0xB8);
	TEST_ASSERT_EQUAL_UINT(0, word_at(0x82));
	hand_skip(&hand, 1, 0xB5);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x02, word_at(0x62) & 0xFF, "NVB");
}

static void test_a_page_is_in_its_scratchpad_until_it_is_copied(void)
{
	static const struct {
		uint8_t at, copy, recall;
		bool survives;
	} pages[] = {{0x17, 0x22, 0x71, true}, {0x27, 0x25, 0x77, true}, {0x40, 0x28, 0x7A, false}};

	for (unsigned i = 0; i < 3; i++) {
		hand_skip(&hand, 3, 0x17, pages[i].at, 0x5A);
		TEST_ASSERT_EQUAL_HEX8(0x5A, scratch(pages[i].at));
		command(pages[i].recall);
		TEST_ASSERT_EQUAL_HEX8(0x00, scratch(pages[i].at));
		hand_skip(&hand, 3, 0x17, pages[i].at, 0x5A);
		command(pages[i].copy);
		hand_skip(&hand, 3, 0x17, pages[i].at, 0x33);
		command(pages[i].recall);
		TEST_ASSERT_EQUAL_HEX8(0x5A, scratch(pages[i].at));
		sim_slave_brownout(slave, hand.now);
		command(pages[i].recall);
		TEST_ASSERT_EQUAL_HEX8(pages[i].survives ? 0x5A : 0, scratch(pages[i].at));
	}
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFF, scratch(0x18), "page 1 has 24 bytes");
}

static void test_a_locked_page_is_not_copied_until_it_is_unlocked(void)
{
	command(0x43);
	TEST_ASSERT_EQUAL_HEX8(0x04, word_at(0x62) & 0xFF);
	hand_skip(&hand, 3, 0x17, 0, 0x5A);
	command(0x22);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x04, word_at(0x62) & 0xFF, "the lock survives");
	TEST_ASSERT_EQUAL_HEX8(0x00, scratch(0));
	command(0x44);
	hand_skip(&hand, 3, 0x17, 0, 0x5A);
	command(0x22);
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x5A, scratch(0));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_conversion_fills_its_register_after_ten_milliseconds);
	RUN_TEST(test_cycles_are_counted_up_to_the_end_and_survive);
	RUN_TEST(test_a_page_is_in_its_scratchpad_until_it_is_copied);
	RUN_TEST(test_a_locked_page_is_not_copied_until_it_is_unlocked);
	return UNITY_END();
}
