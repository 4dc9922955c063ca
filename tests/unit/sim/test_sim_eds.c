/* SPDX-License-Identifier: MIT */
/* EDS's sensors: registers, limits, alarms, relay and counters do what is published of them. */
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

static void plug(const struct sim_family *family)
{
	slave = hand_plug(&hand, family, 1);
}

static void pass(int64_t ms)
{
	hand.now += ms * HAND_MS;
}

static void input(const char *name, double level)
{
	int i = sim_slave_input(slave, name);

	TEST_ASSERT_TRUE_MESSAGE(i >= 0, name);
	sim_slave_advance(slave, hand.now);
	slave->input[i] = sim_constant(level);
	pass(300);
}

static uint32_t get(uint8_t at, unsigned bytes)
{
	uint32_t value = 0;

	hand_skip(&hand, 3, 0xF0, at, 0);
	for (unsigned i = 0; i < bytes; i++)
		value |= (uint32_t)hand_byte(&hand) << (8 * i);
	return value;
}

static void put(uint8_t at, unsigned bytes, uint32_t value)
{
	uint8_t out[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
	                  (uint8_t)(value >> 24)};
	uint8_t key[3];

	hand_skip(&hand, 3, 0x0F, at, 0);
	hand_write(&hand, out, bytes);
	hand_skip(&hand, 1, 0xAA);
	hand_read(&hand, key, 3);
	hand_skip(&hand, 4, 0x55, key[0], key[1], key[2]);
	pass(700);
}

static void clear(void)
{
	hand_skip(&hand, 1, 0x33);
}

static void test_the_first_page_names_the_kind(void)
{
	static const struct {
		const struct sim_family *family;
		uint16_t id;
	} kinds[] = {{&sim_eds0064, 0x64}, {&sim_eds0065, 0x65}, {&sim_eds0066, 0x66},
	             {&sim_eds0067, 0x67}, {&sim_eds0068, 0x68}, {&sim_eds0070, 0x70},
	             {&sim_eds0071, 0x71}, {&sim_eds0072, 0x72}, {&sim_eds0080, 0x80},
	             {&sim_eds0082, 0x82}, {&sim_eds0083, 0x83}, {&sim_eds0085, 0x85},
	             {&sim_eds0090, 0x90}};

	for (unsigned i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		hand_clear(&hand);
		plug(kinds[i].family);
		TEST_ASSERT_EQUAL_HEX16(kinds[i].id, get(0x1E, 2));
		TEST_ASSERT_EQUAL_CHAR('O', get(0, 1));
		put(0, 1, 'x');
		TEST_ASSERT_EQUAL_CHAR_MESSAGE('O', get(0, 1), "nobody writes the tag");
	}
}

static void test_each_page_is_read_with_its_checksum(void)
{
	uint8_t page[3 + 32 + 2] = {0xA5, 0, 0};

	plug(&sim_eds0064);
	hand_skip(&hand, 3, 0xA5, 0, 0);
	hand_read(&hand, page + 3, 32 + 2);
	TEST_ASSERT_EQUAL_HEX8(0x64, page[3 + 0x1E]);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, page, sizeof(page)));
	hand_read(&hand, page, 32 + 2);
	TEST_ASSERT_EQUAL_HEX16(0xB001, sim_crc16(0, page, 32 + 2));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x40, page[2], "20 degrees");
}

static void test_the_environment_is_in_its_registers(void)
{
	plug(&sim_eds0068);
	input("temperature", -10.5);
	input("humidity", 60);
	input("pressure", 1000);
	input("light", 70000);
	TEST_ASSERT_EQUAL_HEX16(0xFF58, get(0x22, 2));
	TEST_ASSERT_EQUAL_UINT32(60 * 16, get(0x24, 2));
	TEST_ASSERT_EQUAL_UINT32(1000 * 2048, get(0x2C, 3));
	TEST_ASSERT_EQUAL_UINT32(60477, get(0x2F, 3)); /* 29.53 inHg */
	TEST_ASSERT_EQUAL_UINT32(70000, get(0x32, 3));
	input("temperature", 25);
	TEST_ASSERT_INT_WITHIN(2, 16 * 16.7, get(0x26, 2)); /* a table of dew points */
	TEST_ASSERT_INT_WITHIN(4, 16 * 30, get(0x28, 2));   /* a table of the humidex */
	TEST_ASSERT_INT_WITHIN(16, 16 * 25, get(0x2A, 2));
	hand_clear(&hand);
	plug(&sim_eds0064);
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, get(0x24, 2), "it has no humidity");
}

static void test_an_enabled_limit_sets_its_flag_until_the_alarms_are_cleared(void)
{
	plug(&sim_eds0064);
	put(0x42, 2, 0xF61E); /* above 30, below -10 */
	input("temperature", 31);
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0, get(0x3A, 2), "it is not enabled");
	put(0x40, 2, 0x0003);
	TEST_ASSERT_EQUAL_HEX16(0x0001, get(0x3A, 2));
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	input("temperature", -11);
	TEST_ASSERT_EQUAL_HEX16(0x0003, get(0x3A, 2));
	clear();
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0x0002, get(0x3A, 2), "it is still cold");
	input("temperature", 20);
	clear();
	TEST_ASSERT_EQUAL_HEX16(0, get(0x3A, 2));
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX16_MESSAGE(0xF61E, get(0x42, 2), "limits last");
}

static void test_a_copy_can_be_read_after_its_time_and_not_before(void)
{
	plug(&sim_eds0068);
	hand_skip(&hand, 6, 0x0F, 0x58, 0, 0x11, 0x22, 0x33);
	hand_skip(&hand, 4, 0x55, 0x58, 0, 0x1A);
	pass(100);
	TEST_ASSERT_EQUAL_HEX32(0, get(0x58, 3));
	pass(600);
	TEST_ASSERT_EQUAL_HEX32(0x332211, get(0x58, 3));
	hand_skip(&hand, 4, 0x0F, 0x58, 0, 0x44);
	hand_skip(&hand, 4, 0x55, 0x58, 0, 0x1A);
	pass(700);
	TEST_ASSERT_EQUAL_HEX32_MESSAGE(0x332211, get(0x58, 3), "the key is wrong");
}

static void test_relay_and_led_follow_the_alarm_or_the_host(void)
{
	plug(&sim_eds0064);
	put(0x42, 2, 0xF61E);
	put(0x40, 2, 0x0003);
	put(0x5E, 1, 0x04); /* the relay while there is an alarm, the LED until it is cleared */
	TEST_ASSERT_EQUAL_HEX8(0, get(0x5F, 1));
	put(0x5F, 1, 0x03);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, get(0x5F, 1), "the alarm decides");
	input("temperature", 31);
	TEST_ASSERT_EQUAL_HEX8(0x03, get(0x5F, 1));
	input("temperature", 20);
	TEST_ASSERT_EQUAL_HEX8(0x02, get(0x5F, 1));
	clear();
	TEST_ASSERT_EQUAL_HEX8(0, get(0x5F, 1));
	put(0x5E, 1, 0x0A);
	put(0x5F, 1, 0x01);
	TEST_ASSERT_EQUAL_HEX8(0x01, get(0x5F, 1));
	put(0x5E, 1, 0x0F);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0, get(0x5F, 1), "always off");
}

static void test_vibration_has_a_peak_that_decays_and_its_extremes(void)
{
	plug(&sim_eds0070);
	input("vibration", 100);
	clear();
	input("vibration", 900);
	input("vibration", 200);
	pass(10000);
	TEST_ASSERT_EQUAL_UINT32(200, get(0x24, 2));
	TEST_ASSERT_UINT32_WITHIN(10, 800, get(0x26, 2));
	TEST_ASSERT_EQUAL_UINT32(900, get(0x28, 2));
	TEST_ASSERT_EQUAL_UINT32(100, get(0x30, 2));
	put(0x44, 2, 500);
	put(0x40, 1, 0x04);
	TEST_ASSERT_EQUAL_HEX8(0, get(0x36, 1));
	input("vibration", 501);
	TEST_ASSERT_EQUAL_HEX8(0x04, get(0x36, 1));
}

/* IEC 60751: 100 ohms at 0 degrees, 138.51 at 100, 60.26 at -100. */
static void test_a_platinum_sensor_has_its_resistance(void)
{
	static const double table[][2] = {{0, 100}, {100, 138.51}, {-100, 60.26}, {850, 390.48}};

	plug(&sim_eds0071);
	for (unsigned i = 0; i < 4; i++) {
		input("temperature", table[i][0]);
		TEST_ASSERT_EQUAL_HEX32((uint32_t)(int32_t)(table[i][0] * 2048) & 0xFFFFFF,
		                        get(0x22, 3));
		TEST_ASSERT_INT_WITHIN(20, table[i][1] * 2048, get(0x25, 3));
	}
	put(0x48, 3, 200 * 2048);
	put(0x40, 1, 0x04);
	TEST_ASSERT_EQUAL_HEX8(0x04, get(0x36, 1));
}

static void test_seconds_and_samples_are_counted_from_power_on(void)
{
	plug(&sim_eds0072);
	pass(10100);
	TEST_ASSERT_EQUAL_UINT32(10, get(0x3C, 4));
	TEST_ASSERT_EQUAL_UINT32(10, get(0x38, 4));
	put(0x5D, 1, 5);
	pass(50000);
	TEST_ASSERT_UINT32_WITHIN(1, 20, get(0x38, 4));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_UINT32(0, get(0x3C, 4));
}

static void test_each_analog_channel_has_extremes_and_limits(void)
{
	plug(&sim_eds0082);
	input("volt.7", 5);
	clear();
	input("volt.7", 9.5);
	input("volt.7", 6);
	TEST_ASSERT_EQUAL_UINT32(6 * 2048, get(0x3E, 2));
	TEST_ASSERT_EQUAL_UINT32(5 * 2048, get(0x4E, 2));
	TEST_ASSERT_EQUAL_UINT32(19456, get(0x5E, 2));
	put(0x8C, 2, 7 * 2048);
	put(0x8E, 2, 1 * 2048);
	put(0x9A, 2, 0xC000);
	TEST_ASSERT_EQUAL_HEX16(0, get(0x2A, 2));
	input("volt.7", 8);
	TEST_ASSERT_EQUAL_HEX16(0x4000, get(0x2A, 2));
	input("volt.7", 0.5);
	TEST_ASSERT_EQUAL_HEX16(0xC000, get(0x2A, 2));
	hand_clear(&hand);
	plug(&sim_eds0083);
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(4 * 2048, get(0x36, 2), "4 mA");
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, get(0x38, 2), "it has four channels");
}

static void test_digital_inputs_are_latched_and_two_of_them_counted(void)
{
	plug(&sim_eds0090);
	TEST_ASSERT_EQUAL_HEX8(0xFF, get(0x22, 1));
	for (unsigned i = 0; i < 3; i++) {
		input("pin.1", 0);
		input("pin.1", 1);
		input("pin.2", 0);
		input("pin.2", 1);
	}
	TEST_ASSERT_EQUAL_HEX8(0xFF, get(0x22, 1));
	TEST_ASSERT_EQUAL_HEX8(0x06, get(0x23, 1));
	TEST_ASSERT_EQUAL_UINT32(3, get(0x34, 4));
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, get(0x38, 4), "it has no counter");
	put(0x54, 1, 0x02);
	put(0x55, 1, 0x04);
	TEST_ASSERT_EQUAL_UINT32(0, get(0x34, 4));
	TEST_ASSERT_EQUAL_HEX8(0x02, get(0x23, 1));
	TEST_ASSERT_EQUAL_HEX16(0, get(0x54, 2));
}

static void test_an_output_pulls_its_pin_down_and_a_level_can_alarm(void)
{
	plug(&sim_eds0090);
	put(0x5C, 1, 0x80);
	TEST_ASSERT_EQUAL_HEX8(0x80, get(0x24, 1));
	TEST_ASSERT_EQUAL_HEX8(0x7F, get(0x22, 1));
	TEST_ASSERT_EQUAL_HEX16(0, get(0x2A, 2));
	put(0x50, 2, 0x8000); /* channel 7, low */
	TEST_ASSERT_EQUAL_HEX16(0x8000, get(0x2A, 2));
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, slave));
	sim_slave_brownout(slave, hand.now);
	TEST_ASSERT_EQUAL_HEX8(0xFF, get(0x22, 1));
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, slave));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_first_page_names_the_kind);
	RUN_TEST(test_each_page_is_read_with_its_checksum);
	RUN_TEST(test_the_environment_is_in_its_registers);
	RUN_TEST(test_an_enabled_limit_sets_its_flag_until_the_alarms_are_cleared);
	RUN_TEST(test_a_copy_can_be_read_after_its_time_and_not_before);
	RUN_TEST(test_relay_and_led_follow_the_alarm_or_the_host);
	RUN_TEST(test_vibration_has_a_peak_that_decays_and_its_extremes);
	RUN_TEST(test_a_platinum_sensor_has_its_resistance);
	RUN_TEST(test_seconds_and_samples_are_counted_from_power_on);
	RUN_TEST(test_each_analog_channel_has_extremes_and_limits);
	RUN_TEST(test_digital_inputs_are_latched_and_two_of_them_counted);
	RUN_TEST(test_an_output_pulls_its_pin_down_and_a_level_can_alarm);
	return UNITY_END();
}
