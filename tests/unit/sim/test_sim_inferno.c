/* SPDX-License-Identifier: MIT */
/* The soft devices of Inferno Embedded: commands with a checksum, lights, switches, firmware. */
#include <string.h>

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

/* The command, its bytes and their checksum; returns what the device thinks of them. */
static uint8_t send(const uint8_t *bytes, unsigned n)
{
	uint8_t crc = sim_crc8(sim_crc8(0, slave->rom, 8), bytes, n);

	hand_skip(&hand, 0);
	hand_write(&hand, bytes, n);
	hand_write(&hand, &crc, 1);
	return hand_byte(&hand);
}
#define SEND(...) send((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static uint8_t identity(uint8_t command)
{
	hand_skip(&hand, 1, command);
	return hand_byte(&hand);
}

static void test_a_wrong_checksum_is_refused(void)
{
	slave = hand_plug(&hand, &sim_inferno_rgbw, 1);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x02));
	TEST_ASSERT_EQUAL_HEX8(4, hand_byte(&hand));
	hand_skip(&hand, 2, 0x02, 0x00);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(1, identity(0xFF));
	TEST_ASSERT_EQUAL_HEX8(7, identity(0xFE));
}

static void test_a_light_fades_from_its_colour_to_the_next_when_that_is_committed(void)
{
	uint8_t light[7];

	slave = hand_plug(&hand, &sim_inferno_rgbw, 1);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x03, 1, 200, 0, 0, 100, 0xE8, 0x03, 0));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04, 1));
	hand_read(&hand, light, 7);
	TEST_ASSERT_EACH_EQUAL_HEX8(0, light, 7);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x05));
	hand.now += 500 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04, 1));
	hand_read(&hand, light, 7);
	TEST_ASSERT_UINT8_WITHIN(6, 100, light[0]);
	TEST_ASSERT_UINT8_WITHIN(6, 50, light[3]);
	TEST_ASSERT_INT_WITHIN(20, 480, light[4] | light[5] << 8);
	hand.now += 500 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04, 1));
	hand_read(&hand, light, 7);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(((uint8_t[]){200, 0, 0, 100, 0, 0, 0}), light, 7);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(1, SEND(0x04, 4), "there are four");
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x01));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04, 1));
	TEST_ASSERT_EQUAL_HEX8(0, hand_byte(&hand));
}

static void test_a_momentary_switch_is_kept_until_it_is_read(void)
{
	uint8_t active[2];

	slave = hand_plug(&hand, &sim_inferno_switches, 1);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04, 0, 2, 2));
	input("switch.0.2", 1);
	input("switch.0.2", 0);
	input("switch.1.0", 1);
	TEST_ASSERT_EQUAL_HEX8(0x03, identity(0xFD));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x06));
	hand_read(&hand, active, 2);
	TEST_ASSERT_EQUAL_HEX8(0x04, active[0]);
	TEST_ASSERT_EQUAL_HEX8(0x01, active[1]);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x06));
	hand_read(&hand, active, 2);
	TEST_ASSERT_EQUAL_HEX8(0x00, active[0]);
	TEST_ASSERT_EQUAL_HEX8(0x01, active[1]);
}

static void test_leds_and_relays_hold_what_is_written(void)
{
	uint8_t relays[4];

	slave = hand_plug(&hand, &sim_inferno_switches, 1);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x07, 1, 3, 1));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x08, 1));
	TEST_ASSERT_EQUAL_HEX8(0x08, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(1, SEND(0x07, 2, 0, 1));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x0B, 0, 1, 1));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x09, 0, 2, 1));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x0A, 0, 3, 30));
	for (uint8_t code = 0x0C; code <= 0x0E; code++) {
		TEST_ASSERT_EQUAL_HEX8(0, send(&code, 1));
		hand_read(&hand, relays, 4);
		TEST_ASSERT_EQUAL_HEX8(code == 0x0E ? 30 : 1, relays[code - 0x0C + 1]);
	}
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x0C));
	TEST_ASSERT_EQUAL_HEX8(0, (hand_read(&hand, relays, 4), relays[1]));
}

static void test_firmware_goes_in_by_blocks_with_a_checksum(void)
{
	static const uint8_t block[8] = {'o', 'w', 's', 'd', 1, 2, 3, 4};
	uint16_t crc = sim_crc16(0, block, 8);
	uint8_t end[4] = {(uint8_t)crc, (uint8_t)(crc >> 8)}, wrong[4] = {0}, answer[8];

	slave = hand_plug(&hand, &sim_inferno_rgbw, 1);
	SEND(0xFC);
	TEST_ASSERT_EQUAL_HEX8(2, identity(0xFF));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x00));
	hand_read(&hand, answer, 4);
	TEST_ASSERT_EQUAL_HEX8(0x20, answer[1]);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x04));
	hand_read(&hand, answer, 8);
	TEST_ASSERT_EQUAL_HEX8(0x28, answer[5]);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x01));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x06, 0, 0x20, 0, 0, 8, 0, 0, 0));
	hand_write(&hand, block, 8);
	hand_write(&hand, wrong, 4);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x06, 0, 0x20, 0, 0, 8, 0, 0, 0));
	hand_write(&hand, block, 8);
	hand_write(&hand, end, 4);
	TEST_ASSERT_EQUAL_HEX8(0, hand_byte(&hand));
	TEST_ASSERT_EQUAL_HEX8(0x04, identity(0xFD));
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x07, 0, 0x20, 0, 0, 8, 0, 0, 0));
	hand_read(&hand, answer, 2);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(end, answer, 2);
	TEST_ASSERT_EQUAL_HEX8(0, SEND(0x05));
	TEST_ASSERT_EQUAL_HEX8(1, identity(0xFF));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_wrong_checksum_is_refused);
	RUN_TEST(test_a_light_fades_from_its_colour_to_the_next_when_that_is_committed);
	RUN_TEST(test_a_momentary_switch_is_kept_until_it_is_read);
	RUN_TEST(test_leds_and_relays_hold_what_is_written);
	RUN_TEST(test_firmware_goes_in_by_blocks_with_a_checksum);
	return UNITY_END();
}
