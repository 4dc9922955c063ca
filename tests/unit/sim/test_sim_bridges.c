/* SPDX-License-Identifier: MIT */
/* DS28E17 and DS28E18: their packets, and the I2C sensors behind them. */
#include <stdarg.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *e17, *e18;
static uint8_t got[200];

static void plug(struct sim_slave **slave, const struct sim_family *family)
{
	*slave = hand_plug(&hand, family, 1);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(*slave, "sht4x", 0x44));
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(*slave, "bme280", 0x76));
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(*slave, "vcnl4040", 0x60));
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(*slave, "mcp23017", 0x20));
}

void setUp(void)
{
	hand_clear(&hand);
	e17 = e18 = NULL;
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void set(struct sim_slave *slave, const char *input, double value)
{
	sim_slave_advance(slave, hand.now);
	slave->input[sim_slave_input(slave, input)] = sim_constant(value);
}

/* --- DS28E17 ---------------------------------------------------------------------------------- */

/* A packet with its checksum, turned over by wrong; waits until the bridge is not busy. */
static void packet(uint8_t wrong, const uint8_t *bytes, unsigned n)
{
	uint16_t crc = (uint16_t)~sim_crc16(0, bytes, n);
	uint8_t sum[2] = {(uint8_t)(crc ^ wrong), (uint8_t)(crc >> 8)};
	unsigned slots = 0;

	hand_match(&hand, e17);
	hand_write(&hand, bytes, n);
	hand_write(&hand, sum, 2);
	while (hand_bit(&hand, true) && slots++ < 10000)
		;
	TEST_ASSERT_LESS_THAN_UINT(10000, slots);
}

/* Write; returns the status, and the byte that was refused above it. */
static unsigned put17(unsigned n, ...)
{
	uint8_t bytes[40];
	va_list list;
	unsigned status;

	va_start(list, n);
	for (unsigned i = 0; i < n; i++)
		bytes[i] = (uint8_t)va_arg(list, int);
	va_end(list);
	packet(0, bytes, n);
	status = hand_byte(&hand);
	return status | (unsigned)hand_byte(&hand) << 8;
}

static void get17(uint8_t address, uint8_t n)
{
	const uint8_t bytes[] = {0x87, (uint8_t)(address << 1 | 1), n};

	packet(0, bytes, 3);
	TEST_ASSERT_EQUAL_HEX8(0, hand_byte(&hand));
	hand_read(&hand, got, n);
}

static void registers17(uint8_t address, uint8_t at, uint8_t n)
{
	TEST_ASSERT_EQUAL_HEX16(0, put17(5, 0x2D, address << 1, 1, at, n));
	hand_read(&hand, got, n);
}

static void test_a_ds28e17_says_what_was_wrong_with_a_packet(void)
{
	const uint8_t bytes[] = {0x4B, 0x88, 1, 0xFD};

	plug(&e17, &sim_ds28e17);
	packet(1, bytes, 4);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x01, hand_byte(&hand), "checksum");
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0002, put17(4, 0x4B, 0x10, 1, 0), "nobody there");
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0100, put17(4, 0x4B, 0x88, 1, 0x55), "first byte");
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0008, put17(3, 0x69, 1, 0x55), "no START before");
}

static void test_a_ds28e17_writes_in_several_packets(void)
{
	plug(&e17, &sim_ds28e17);
	TEST_ASSERT_EQUAL_HEX16(0, put17(4, 0x5A, 0x40, 1, 0x00));
	TEST_ASSERT_EQUAL_HEX16(0, put17(3, 0x69, 1, 0xF0));
	TEST_ASSERT_EQUAL_HEX16(0, put17(3, 0x78, 1, 0x0F));
	registers17(0x20, 0, 2);
	TEST_ASSERT_EQUAL_HEX8(0xF0, got[0]);
	TEST_ASSERT_EQUAL_HEX8(0x0F, got[1]);
	TEST_ASSERT_EQUAL_HEX16(0x0008, put17(3, 0x69, 1, 0x55));
}

static void test_a_ds28e17_keeps_its_speed_until_it_restarts(void)
{
	plug(&e17, &sim_ds28e17);
	hand_skip(&hand, 1, 0xE1);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
	hand_skip(&hand, 2, 0xD2, 2);
	hand_skip(&hand, 1, 0xE1);
	TEST_ASSERT_EQUAL_HEX8(2, hand_byte(&hand));
	sim_slave_brownout(e17, hand.now);
	hand_skip(&hand, 1, 0xE1);
	TEST_ASSERT_EQUAL_HEX8(1, hand_byte(&hand));
}

static void test_a_sht4x_measures_after_a_command_and_gives_the_result_once(void)
{
	const uint8_t read[] = {0x87, 0x89, 6};

	plug(&e17, &sim_ds28e17);
	set(e17, "temperature", 25);
	set(e17, "humidity", 40);
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0002, put17(5, 0x2D, 0x88, 1, 0xFD, 6), "it measures");
	hand.now += 9 * HAND_MS;
	get17(0x44, 6);
	TEST_ASSERT_EQUAL_HEX8(0x66, got[0]);
	TEST_ASSERT_EQUAL_HEX8(0x66, got[1]);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x93, got[2], "CRC8 of 6666h");
	TEST_ASSERT_EQUAL_HEX8(0x5E, got[3]); /* (40 + 6) / 125 of 65535 */
	TEST_ASSERT_EQUAL_HEX8(0x35, got[4]);
	packet(0, read, 3);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x02, hand_byte(&hand), "there is no other");
}

static void test_a_bme280_measures_when_it_is_forced(void)
{
	plug(&e17, &sim_ds28e17);
	set(e17, "temperature", 25.08);
	set(e17, "pressure", 1006.5327);
	set(e17, "humidity", 55);
	registers17(0x76, 0xD0, 1);
	TEST_ASSERT_EQUAL_HEX8(0x60, got[0]);
	registers17(0x76, 0xF7, 8);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x80, got[3], "nothing was measured");
	TEST_ASSERT_EQUAL_HEX16(0, put17(7, 0x4B, 0xEC, 4, 0xF2, 1, 0xF4, 0xB5));
	registers17(0x76, 0xF3, 1);
	TEST_ASSERT_EQUAL_HEX8(0x08, got[0]);
	hand.now += 80 * HAND_MS;
	registers17(0x76, 0xF3, 1);
	TEST_ASSERT_EQUAL_HEX8(0, got[0]);
	registers17(0x76, 0xF7, 8);
	/* The example of the data sheet of the BMP280: 25.08 degrees and 100653 Pa. */
	TEST_ASSERT_INT_WITHIN(20, 519888, got[3] << 12 | got[4] << 4 | got[5] >> 4);
	TEST_ASSERT_INT_WITHIN(20, 415148, got[0] << 12 | got[1] << 4 | got[2] >> 4);
	TEST_ASSERT_NOT_EQUAL(0x8000, got[6] << 8 | got[7]);
}

static void test_a_vcnl4040_measures_what_is_switched_on(void)
{
	plug(&e17, &sim_ds28e17);
	set(e17, "light", 123.4);
	set(e17, "proximity", 777);
	registers17(0x60, 0x0C, 2);
	TEST_ASSERT_EQUAL_HEX16(0x0186, got[0] | got[1] << 8);
	registers17(0x60, 0x09, 2);
	TEST_ASSERT_EQUAL_INT(0, got[0] | got[1] << 8);
	TEST_ASSERT_EQUAL_HEX16(0, put17(6, 0x4B, 0xC0, 3, 0x00, 0x40, 0x00));
	TEST_ASSERT_EQUAL_HEX16(0, put17(6, 0x4B, 0xC0, 3, 0x03, 0x00, 0x00));
	registers17(0x60, 0x09, 2);
	TEST_ASSERT_EQUAL_INT_MESSAGE(2468, got[0] | got[1] << 8, "0.05 lux a step");
	registers17(0x60, 0x08, 2);
	TEST_ASSERT_EQUAL_INT(777, got[0] | got[1] << 8);
}

static void test_a_mcp23017_has_inputs_and_outputs(void)
{
	plug(&e17, &sim_ds28e17);
	set(e17, "pins", 0xA55A);
	registers17(0x20, 0x12, 2);
	TEST_ASSERT_EQUAL_HEX16(0xA55A, got[0] | got[1] << 8);
	TEST_ASSERT_EQUAL_HEX16(0, put17(6, 0x4B, 0x40, 3, 0x14, 0x0C, 0x30));
	TEST_ASSERT_EQUAL_HEX16(0, put17(6, 0x4B, 0x40, 3, 0x00, 0xF0, 0x0F));
	registers17(0x20, 0x12, 2);
	TEST_ASSERT_EQUAL_HEX16(0x355C, got[0] | got[1] << 8);
	sim_slave_brownout(e17, hand.now);
	registers17(0x20, 0x12, 2);
	TEST_ASSERT_EQUAL_HEX16(0xA55A, got[0] | got[1] << 8);
}

/* --- DS28E18 ---------------------------------------------------------------------------------- */

/* A device function; its result is in got, and its length is returned. */
static unsigned function18(const uint8_t *bytes, unsigned n)
{
	uint8_t head[2] = {0x66, (uint8_t)n}, sum[2], length;
	uint16_t crc = (uint16_t)~sim_crc16(sim_crc16(0, head, 2), bytes, n);
	const uint8_t release = 0xAA;

	hand_skip(&hand, 2, head[0], head[1]);
	hand_write(&hand, bytes, n);
	hand_read(&hand, sum, 2);
	TEST_ASSERT_EQUAL_HEX16(crc, sum[0] | sum[1] << 8);
	hand_write(&hand, &release, 1);
	hand.now += 100 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFF, hand_byte(&hand), "dummy");
	length = hand_byte(&hand);
	hand_read(&hand, got, length);
	hand_read(&hand, sum, 2);
	crc = (uint16_t)~sim_crc16(sim_crc16(0, &length, 1), got, length);
	TEST_ASSERT_EQUAL_HEX16(crc, sum[0] | sum[1] << 8);
	return length;
}

#define FUNCTION18(...) \
	function18((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static void test_a_ds28e18_has_its_id_after_the_first_command(void)
{
	uint8_t rom[2][8];

	plug(&e18, &sim_ds28e18);
	TEST_ASSERT_EQUAL_UINT(1, hand_search(&hand, 0xF0, rom, 2));
	TEST_ASSERT_EQUAL_HEX8(0x56, rom[0][0]);
	TEST_ASSERT_EQUAL_HEX8(0x00, rom[0][1]);
	TEST_ASSERT_EQUAL_HEX8(0xB2, rom[0][7]);
	TEST_ASSERT_EQUAL_UINT(1, FUNCTION18(0x83, 0x0B, 0x03, 0xA5, 0x0F));
	TEST_ASSERT_EQUAL_HEX8(0xAA, got[0]);
	TEST_ASSERT_EQUAL_UINT(1, hand_search(&hand, 0xF0, rom, 2));
	TEST_ASSERT_EQUAL_HEX8(0x01, rom[0][1]);
	TEST_ASSERT_EQUAL_UINT(3, FUNCTION18(0x7C, 0x0B, 0x03));
	TEST_ASSERT_EQUAL_HEX8(0xA5, got[1]);
	TEST_ASSERT_EQUAL_UINT(5, FUNCTION18(0x7A));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x02, got[1], "it was restarted");
	FUNCTION18(0x7A);
	TEST_ASSERT_EQUAL_HEX8(0x00, got[1]);
}

static void test_a_ds28e18_runs_a_sequence(void)
{
	plug(&e18, &sim_ds28e18);
	set(e18, "temperature", 25);
	FUNCTION18(0x33, 0x00, 18 << 1, 0);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x44, got[0], "nothing was written yet");
	FUNCTION18(0x11, 0x00, 0x00, 0xCC, 0x02, 0xE3, 2, 0x88, 0xFD, 0x03, 0xDD, 4, 0x02, 0xE3, 1,
	           0x89, 0xD3, 3, 0xFF, 0xFF, 0xFF, 0x03);
	TEST_ASSERT_EQUAL_HEX8(0xAA, got[0]);
	FUNCTION18(0x33, 0x00, 19 << 1, 0);
	TEST_ASSERT_EQUAL_HEX8(0xAA, got[0]);
	TEST_ASSERT_EQUAL_UINT(4, FUNCTION18(0x22, 15, 3 << 1));
	TEST_ASSERT_EQUAL_HEX8(0xAA, got[0]);
	TEST_ASSERT_EQUAL_HEX8(0x66, got[1]);
	TEST_ASSERT_EQUAL_HEX8(0x66, got[2]);
	TEST_ASSERT_EQUAL_HEX8(0x93, got[3]);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(129, FUNCTION18(0x22, 0, 0), "128 bytes");
}

static void test_a_ds28e18_says_which_byte_was_refused(void)
{
	plug(&e18, &sim_ds28e18);
	FUNCTION18(0x11, 0x00, 0x00, 0x02, 0xE3, 2, 0x10, 0xFD, 0x03);
	TEST_ASSERT_EQUAL_UINT(3, FUNCTION18(0x33, 0x00, 6 << 1, 0));
	TEST_ASSERT_EQUAL_HEX8(0x88, got[0]);
	TEST_ASSERT_EQUAL_HEX8(4, got[1]);
	FUNCTION18(0x33, 0x00, 4 << 1, 0);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x55, got[0], "it ends within a command");
	FUNCTION18(0x99);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x77, got[0], "no such function");
}

static void test_a_ds28e18_does_nothing_without_its_release_byte(void)
{
	const uint8_t wrong = 0xAB;

	plug(&e18, &sim_ds28e18);
	hand_skip(&hand, 4, 0x66, 2, 0x55, 0x02);
	hand_byte(&hand);
	hand_byte(&hand);
	hand_write(&hand, &wrong, 1);
	hand.now += 10 * HAND_MS;
	FUNCTION18(0x6A);
	TEST_ASSERT_EQUAL_HEX8(0x00, got[1]);
	FUNCTION18(0x55, 0x02);
	FUNCTION18(0x6A);
	TEST_ASSERT_EQUAL_HEX8(0x02, got[1]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds28e17_says_what_was_wrong_with_a_packet);
	RUN_TEST(test_a_ds28e17_writes_in_several_packets);
	RUN_TEST(test_a_ds28e17_keeps_its_speed_until_it_restarts);
	RUN_TEST(test_a_sht4x_measures_after_a_command_and_gives_the_result_once);
	RUN_TEST(test_a_bme280_measures_when_it_is_forced);
	RUN_TEST(test_a_vcnl4040_measures_what_is_switched_on);
	RUN_TEST(test_a_mcp23017_has_inputs_and_outputs);
	RUN_TEST(test_a_ds28e18_has_its_id_after_the_first_command);
	RUN_TEST(test_a_ds28e18_runs_a_sequence);
	RUN_TEST(test_a_ds28e18_says_which_byte_was_refused);
	RUN_TEST(test_a_ds28e18_does_nothing_without_its_release_byte);
	return UNITY_END();
}
