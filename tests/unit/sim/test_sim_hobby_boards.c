/* SPDX-License-Identifier: MIT */
/* The boards of Hobby Boards: values, settings, the commands of both moisture meters. */
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

static int word(uint8_t command)
{
	uint8_t bytes[2];

	hand_skip(&hand, 1, command);
	hand_read(&hand, bytes, 2);
	return (int16_t)(bytes[0] | bytes[1] << 8);
}

static uint8_t byte_of(uint8_t command)
{
	hand_skip(&hand, 1, command);
	return hand_byte(&hand);
}

static void test_each_board_has_its_type_and_a_version(void)
{
	static const struct {
		const struct sim_family *family;
		uint8_t type;
	} boards[] = {{&sim_hb_uvi_meter, 1}, {&sim_hb_moisture_meter, 2}, {&sim_hb_hub, 5},
	              {&sim_hb_barometer, 6}, {&sim_hb_humidity, 7},       {&sim_hb_multitemp, 9}};

	for (unsigned i = 0; i < 6; i++) {
		hand_clear(&hand);
		slave = hand_plug(&hand, boards[i].family, 1);
		TEST_ASSERT_EQUAL_HEX8(boards[i].type, byte_of(0x12));
		TEST_ASSERT_EQUAL_HEX16(0x0100, word(0x11));
	}
}

static void test_offsets_are_part_of_what_the_uvi_meter_says(void)
{
	slave = hand_plug(&hand, &sim_hb_uvi_meter, 1);
	input("uvi", 3.2);
	input("temperature", -4.5);
	TEST_ASSERT_EQUAL_HEX8(32, byte_of(0x24));
	TEST_ASSERT_EQUAL_INT(-9, word(0x21));
	hand_skip(&hand, 2, 0x25, 0xFB);
	hand_skip(&hand, 3, 0x22, 0x03, 0x00);
	TEST_ASSERT_EQUAL_HEX8(27, byte_of(0x24));
	TEST_ASSERT_EQUAL_HEX8(0xFB, byte_of(0x26));
	TEST_ASSERT_EQUAL_INT(-6, word(0x21));
	hand_skip(&hand, 2, 0x27, 0xFF);
	TEST_ASSERT_EQUAL_HEX8(0xFF, byte_of(0x28));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFB, byte_of(0x26), "settings are kept");
}

static void test_a_leaf_is_scaled_between_its_limits(void)
{
	uint8_t sensor[4];

	slave = hand_plug(&hand, &sim_hb_moisture_meter, 1);
	input("sensor.0", 250);
	input("sensor.1", 1750);
	hand_skip(&hand, 2, 0x22, 0x02); /* as versions before 1.80 have it */
	hand_skip(&hand, 1, 0x21);
	hand_read(&hand, sensor, 4);
	TEST_ASSERT_EQUAL_UINT8(199, sensor[0]);
	TEST_ASSERT_EQUAL_UINT8(50, sensor[1]);
	TEST_ASSERT_EQUAL_UINT8(100, sensor[2]);
	TEST_ASSERT_EQUAL_INT(3000, word(0x25));
	TEST_ASSERT_EQUAL_INT(500, word(0x27));
	TEST_ASSERT_EQUAL_INT(250, word(0x31));
}

static void test_moisture_meters_from_version_1_80_on_have_other_commands(void)
{
	slave = hand_plug(&hand, &sim_hb_moisture_meter, 1);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "version", 0x0150));
	hand_skip(&hand, 2, 0xA2, 0x05);
	TEST_ASSERT_EQUAL_HEX8(0x05, byte_of(0x22));
	hand_skip(&hand, 3, 0xA3, 0x10, 0x20);
	TEST_ASSERT_EQUAL_HEX16(0x2010, word(0x23));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xFF, byte_of(0x25), "no command of this version");
}

static void test_the_hub_switches_the_channels_that_are_named(void)
{
	slave = hand_plug(&hand, &sim_hb_hub, 1);
	hand_skip(&hand, 2, 0x21, 0x1B);
	TEST_ASSERT_EQUAL_HEX8(0x0B, byte_of(0x22));
	hand_skip(&hand, 2, 0x21, 0x02);
	TEST_ASSERT_EQUAL_HEX8(0x09, byte_of(0x22));
	hand_skip(&hand, 2, 0x60, 0x02); /* a single channel at a time */
	hand_skip(&hand, 2, 0x21, 0x14);
	TEST_ASSERT_EQUAL_HEX8(0x04, byte_of(0x22));
	TEST_ASSERT_EQUAL_HEX8(0x02, byte_of(0x61));
	input("short.2", 1);
	TEST_ASSERT_EQUAL_HEX8(0x04, byte_of(0x23));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0x00, byte_of(0x22));
}

static void test_weather_boards_measure_and_keep_their_settings_until_a_factory_reset(void)
{
	slave = hand_plug(&hand, &sim_hb_barometer, 1);
	input("pressure", 990);
	input("temperature", -1.5);
	TEST_ASSERT_EQUAL_INT(99, word(0x22));
	TEST_ASSERT_EQUAL_INT(-15, word(0x40));
	hand_skip(&hand, 3, 0xA6, 0x9C, 0xFF);
	TEST_ASSERT_EQUAL_INT(-100, word(0x26));
	hand_skip(&hand, 2, 0x94, 3);
	TEST_ASSERT_EQUAL_HEX8(3, byte_of(0x14));
	hand_skip(&hand, 1, 0xF7);
	TEST_ASSERT_EQUAL_INT(0, word(0x26));
	TEST_ASSERT_EQUAL_HEX8(1, byte_of(0x14));
	TEST_ASSERT_EQUAL_HEX8('n', byte_of(0x16));
}

static void test_humidity_is_corrected_by_its_offset(void)
{
	slave = hand_plug(&hand, &sim_hb_humidity, 1);
	input("humidity", 43.21);
	hand_skip(&hand, 3, 0xA4, 0x64, 0x00);
	TEST_ASSERT_EQUAL_INT(4321, word(0x22));
	TEST_ASSERT_EQUAL_INT(4421, word(0x21));
}

static void test_six_temperatures_come_in_a_row(void)
{
	uint8_t bytes[12];

	slave = hand_plug(&hand, &sim_hb_multitemp, 1);
	input("temperature.5", -10.3);
	hand_skip(&hand, 1, 0x21);
	hand_read(&hand, bytes, 12);
	TEST_ASSERT_EQUAL_HEX8(200, bytes[0]);
	TEST_ASSERT_EQUAL_INT(-103, (int16_t)(bytes[10] | bytes[11] << 8));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_board_has_its_type_and_a_version);
	RUN_TEST(test_offsets_are_part_of_what_the_uvi_meter_says);
	RUN_TEST(test_a_leaf_is_scaled_between_its_limits);
	RUN_TEST(test_moisture_meters_from_version_1_80_on_have_other_commands);
	RUN_TEST(test_the_hub_switches_the_channels_that_are_named);
	RUN_TEST(test_weather_boards_measure_and_keep_their_settings_until_a_factory_reset);
	RUN_TEST(test_humidity_is_corrected_by_its_offset);
	RUN_TEST(test_six_temperatures_come_in_a_row);
	return UNITY_END();
}
