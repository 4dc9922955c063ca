/* SPDX-License-Identifier: MIT */
/* The LCD controller: display, EEPROM, pins and counters, all by the scratchpad. */
#include <string.h>

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

static void input(const char *name, double value)
{
	sim_slave_advance(slave, hand.now);
	slave->input[sim_slave_input(slave, name)] = sim_constant(value);
	hand.now += HAND_MS;
}

static const uint8_t *seen(void)
{
	size_t size;

	return sim_slave_memory(slave, &size);
}

static void scratchpad(uint8_t *bytes, unsigned n)
{
	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, bytes, n);
}

static void test_text_is_printed_where_the_scratchpad_says(void)
{
	slave = hand_plug(&hand, &sim_lcd, 1);
	hand_skip(&hand, 1, 0x03);
	hand_skip(&hand, 4, 0x4E, 0x40, 'H', 'i');
	hand_skip(&hand, 1, 0x48);
	TEST_ASSERT_EQUAL_STRING_LEN(" Hi ", seen() + 112 + 0x3F, 4);
	hand_skip(&hand, 1, 0x49);
	TEST_ASSERT_EQUAL_STRING_LEN("    ", seen() + 112 + 0x3F, 4);
	hand_skip(&hand, 1, 0x08);
	TEST_ASSERT_EQUAL_HEX8(1, seen()[240]);
	TEST_ASSERT_EQUAL_HEX8(1, seen()[241]);
	hand_skip(&hand, 1, 0x05);
	hand_skip(&hand, 1, 0x07);
	TEST_ASSERT_EQUAL_HEX8(0, seen()[240]);
	TEST_ASSERT_EQUAL_HEX8(0, seen()[241]);
}

static void test_register_and_data_are_those_of_the_display(void)
{
	uint8_t byte;

	slave = hand_plug(&hand, &sim_lcd, 1);
	hand_skip(&hand, 2, 0x10, 0x80 | 5);
	hand_skip(&hand, 2, 0x12, 'x');
	hand_skip(&hand, 1, 0x11);
	scratchpad(&byte, 1);
	TEST_ASSERT_EQUAL_HEX8(6, byte);
	hand_skip(&hand, 2, 0x10, 0x80 | 5);
	hand_skip(&hand, 1, 0x13);
	scratchpad(&byte, 1);
	TEST_ASSERT_EQUAL_HEX8('x', byte);
}

static void test_the_eeprom_is_written_in_four_ms_a_byte_and_kept(void)
{
	uint8_t bytes[3];

	slave = hand_plug(&hand, &sim_lcd, 1);
	hand_skip(&hand, 5, 0x4E, 0x10, 1, 2, 3);
	hand_skip(&hand, 1, 0x39);
	TEST_ASSERT_EQUAL_HEX8(0xFF, seen()[0x10]);
	hand.now += 13 * HAND_MS;
	sim_slave_advance(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(1, seen()[0x10]);
	sim_slave_brownout(slave, hand.now);
	hand_skip(&hand, 3, 0x4E, 0x11, 2);
	hand_skip(&hand, 1, 0x37);
	scratchpad(bytes, 3);
	TEST_ASSERT_EQUAL_HEX8(2, bytes[0]);
	TEST_ASSERT_EQUAL_HEX8(3, bytes[1]);
}

static void test_changes_from_outside_are_counted_until_they_are_read(void)
{
	uint8_t bytes[8];

	slave = hand_plug(&hand, &sim_lcd, 1);
	input("gpio.1", 0);
	input("gpio.1", 1);
	hand_skip(&hand, 2, 0x21, 0x80 | 0x07); /* the chip itself pulls pin 3 */
	hand_skip(&hand, 1, 0x22);
	scratchpad(bytes, 1);
	TEST_ASSERT_EQUAL_HEX8(0x07, bytes[0]);
	hand_skip(&hand, 1, 0x23);
	scratchpad(bytes, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(((uint8_t[]){0, 0, 2, 0, 0, 0, 0, 0}), bytes, 8);
	hand_skip(&hand, 1, 0x23);
	scratchpad(bytes, 8);
	TEST_ASSERT_EACH_EQUAL_HEX8(0, bytes, 8);
}

static void test_the_version_has_sixteen_characters(void)
{
	uint8_t text[16];

	slave = hand_plug(&hand, &sim_lcd, 1);
	hand_skip(&hand, 1, 0x41);
	scratchpad(text, 16);
	TEST_ASSERT_EQUAL_STRING_LEN("LCD 1.00 L.Swart", text, 16);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_text_is_printed_where_the_scratchpad_says);
	RUN_TEST(test_register_and_data_are_those_of_the_display);
	RUN_TEST(test_the_eeprom_is_written_in_four_ms_a_byte_and_kept);
	RUN_TEST(test_changes_from_outside_are_counted_until_they_are_read);
	RUN_TEST(test_the_version_has_sixteen_characters);
	return UNITY_END();
}
