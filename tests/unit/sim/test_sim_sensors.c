/* SPDX-License-Identifier: MIT */
/* The sensors of CMC Industrial Electronics and the SmartSlave of iButtonLink. */
#include "unity.h"

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

static void input(const char *name, double value)
{
	sim_slave_advance(slave, hand.now);
	slave->input[sim_slave_input(slave, name)] = sim_constant(value);
	hand.now += HAND_MS;
}

static int reading(void)
{
	uint8_t bytes[3];

	hand_skip(&hand, 1, 0xBE);
	hand_read(&hand, bytes, 3);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, sim_crc8(0, bytes, 3), "the checksum is right");
	return bytes[0] | bytes[1] << 8;
}

static void test_each_sensor_gives_a_word_with_a_checksum(void)
{
	slave = hand_plug(&hand, &sim_mrs001, 1);
	input("rpm", -250);
	TEST_ASSERT_EQUAL_HEX16((uint16_t)-250, reading());
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_mcm001, 1);
	input("current", 1.23);
	TEST_ASSERT_EQUAL_INT(123, reading());
	hand_clear(&hand);
	slave = hand_plug(&hand, &sim_mam001, 1);
	input("volts", 7.5);
	TEST_ASSERT_EQUAL_INT(7500, reading());
}

static void test_a_contact_is_closed_shorted_or_interrupted(void)
{
	slave = hand_plug(&hand, &sim_mdi001, 1);
	TEST_ASSERT_EQUAL_HEX16(0x8000, reading());
	input("contact.0", 1);
	input("contact.1", 2);
	input("contact.3", 3);
	TEST_ASSERT_EQUAL_HEX16(0x8821, reading());
}

static void read_page(uint8_t page[34])
{
	hand_skip(&hand, 2, 0xF0, 0x00);
	hand_read(&hand, page, 34);
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0xB001, sim_crc16(0, page, 34), "the checksum is right");
}

static void test_the_smart_slave_is_busy_until_it_has_converted(void)
{
	uint8_t page[34];

	slave = hand_plug(&hand, &sim_iblss, 1);
	input("temperature", -5.5);
	input("humidity", 61.25);
	read_page(page);
	TEST_ASSERT_EQUAL_HEX8(0x04, page[0]);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, page[8], "it has not converted yet");
	hand_skip(&hand, 1, 0xB4);
	hand.now += 100 * HAND_MS;
	read_page(page);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(1, page[2], "it is busy");
	hand.now += 900 * HAND_MS;
	read_page(page);
	TEST_ASSERT_EQUAL_HEX8(0, page[2]);
	TEST_ASSERT_EQUAL_HEX8(1, page[8]);
	TEST_ASSERT_EQUAL_INT(-704, (int16_t)(page[4] << 8 | page[5]));
	TEST_ASSERT_EQUAL_INT(7840, page[6] << 8 | page[7]);
	sim_slave_brownout(slave, hand.now);
	read_page(page);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, page[8], "a restart forgets the result");
}

static void test_the_smart_slave_has_a_light(void)
{
	size_t size;

	slave = hand_plug(&hand, &sim_iblss, 1);
	hand_skip(&hand, 3, 0xA5, 0x00, 0x01);
	TEST_ASSERT_EQUAL_HEX8(1, *sim_slave_memory(slave, &size));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_sensor_gives_a_word_with_a_checksum);
	RUN_TEST(test_a_contact_is_closed_shorted_or_interrupted);
	RUN_TEST(test_the_smart_slave_is_busy_until_it_has_converted);
	RUN_TEST(test_the_smart_slave_has_a_light);
	return UNITY_END();
}
