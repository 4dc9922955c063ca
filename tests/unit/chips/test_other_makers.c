/* SPDX-License-Identifier: MIT */
/* Devices of other makers than the chips': read what they measure, written where they can be. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "tests/unit/aid/one_slave.h"

void setUp(void)
{
	one_slave_begin();
}

void tearDown(void)
{
	one_slave_end();
}

static void begin(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
}

static void start(void)
{
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static uint8_t *memory(void)
{
	size_t size;

	return sim_slave_memory(slave, &size);
}

static void test_sensors_with_one_word_are_read(void)
{
	begin("mRS001");
	wire_set(slave, "rpm", 321);
	start();
	reads("RPM", "         321");
	reads("reading", "         321");
	wire_set(slave, "rpm", -5);
	reads("RPM", "          -5");
	TEST_ASSERT_EQUAL_DOUBLE(-5, go(BUS_READ, "RPM", NULL)->number);
	reads("reading", "       65531");
	wire_set(slave, "rpm", -1);
	reads("RPM", "          -1");
	tearDown();
	setUp();
	begin("mCM001");
	wire_set(slave, "current", 3.21);
	start();
	reads("current", "        3.21");
	tearDown();
	setUp();
	begin("mAM001");
	wire_set(slave, "volts", 5);
	start();
	reads("volts", "           5");
	reads("current", "        0.01");
}

static void test_contacts_are_open_closed_shorted_or_interrupted(void)
{
	begin("mDI001");
	for (int i = 0; i < 4; i++)
		wire_set(slave,
		         (const char *[]){"contact.0", "contact.1", "contact.2", "contact.3"}[i],
		         i);
	start();
	reads("switch_closed.ALL", "0,1,0,0");
	reads("loop_shorted.BYTE", "           4");
	reads("loop_open.BYTE", "           8");
	reads("loop_open.3", "1");
	reads("open", "           8");
	reads("shorted", "           4");
	reads("switch", "           2");
	refuses(-EACCES, BUS_WRITE, "switch_closed.0", "1");
}

static void test_a_room_is_measured(void)
{
	begin("IBLSS");
	wire_set(slave, "temperature", -12.5);
	wire_set(slave, "humidity", 61.25);
	start();
	reads("TH/latesttemp", "       -12.5");
	reads("TH/temperature", "       -12.5");
	reads("TH/humidity", "       61.25");
	reads("TH/latesttemp", "       -12.5");
	reads("TH/latesthumidity", "       61.25");
	wire_set(slave, "temperature", 30);
	reads("TH/temperature", "          30");
	reads("firmware", "1.2");
	reads("subtype", "TH");
	writes("TH/led", "1");
	TEST_ASSERT_EQUAL_HEX8(1, memory()[0]);
	sim_slave_brownout(slave, wire_time());
	reads("TH/latesttemp", "          30");
}

static void set_option(const char *name, double value)
{
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, name, value));
}

static void test_a_room_whose_checksum_covers_the_command_is_measured(void)
{
	begin("IBLSS");
	set_option("command", 1);
	wire_set(slave, "temperature", 21.25);
	start();
	reads("TH/temperature", "       21.25");
	reads("firmware", "1.2");
}

static void test_a_room_with_another_checksum_has_no_value(void)
{
	begin("IBLSS");
	set_option("command", 2);
	wire_set(slave, "temperature", 21.25);
	start();
	refuses(-EBADMSG, BUS_READ, "TH/temperature", NULL);
	refuses(-EBADMSG, BUS_READ, "firmware", NULL);
}

static void test_a_uvi_meter_keeps_its_offsets_below_zero_too(void)
{
	begin("HB_UVI_METER");
	wire_set(slave, "uvi", 5.5);
	wire_set(slave, "temperature", -3.5);
	start();
	reads("type", "HB_UVI_METER");
	reads("type_number", "           1");
	reads("version", "1.0");
	reads("version_number", "         256");
	reads("UVI/UVI", "         5.5");
	reads("temperature", "        -3.5");
	writes("UVI/UVI_offset", "-0.5");
	reads("UVI/UVI_offset", "        -0.5");
	reads("UVI/UVI", "           5");
	writes("temperature_offset", "-1.5");
	reads("temperature_offset", "        -1.5");
	reads("temperature", "          -5");
	reads("UVI/in_case", "0");
	writes("UVI/in_case", "1");
	reads("UVI/in_case", "1");
	refuses(-EINVAL, BUS_WRITE, "UVI/UVI_offset", "12.8");
	refuses(-EIO, BUS_WRITE, "UVI/UVI_offset", "-0.1");
}

static void test_a_value_of_a_uvi_meter_is_refused_when_its_offset_may_be_a_disturbed_read(void)
{
	begin("HB_UVI_METER");
	start();
	reads("UVI/UVI", "           3");
	memory()[27] = 0xff;
	refuses(-EIO, BUS_READ, "UVI/UVI", NULL);
	refuses(-EIO, BUS_READ, "UVI/UVI_offset", NULL);
	writes("UVI/UVI_offset", "0");
	reads("UVI/UVI", "           3");
}

static void moisture_of(unsigned version)
{
	begin("HB_MOISTURE_METER");
	memory()[0] = (uint8_t)version;
	wire_set(slave, "sensor.0", 1750);
	wire_set(slave, "sensor.1", 120);
	start();
	reads("type", "HB_MOISTURE_METER");
	reads("moisture/is_leaf.BYTE", "           0");
	reads("moisture/is_moisture.BYTE", "          15");
	writes("moisture/is_leaf.0", "1");
	reads("moisture/is_leaf.ALL", "1,0,0,0");
	reads("moisture/is_moisture.ALL", "0,1,1,1");
	writes("moisture/calibrate/min", "1000");
	writes("moisture/calibrate/max", "2500");
	reads("moisture/calibrate/min", "        1000");
	reads("moisture/calibrate/max", "        2500");
	reads("moisture/calibrate/raw.0", "        1750");
	reads("moisture/sensor.0", "          50");
	reads("moisture/sensor.1", "         120");
	refuses(-ENOENT, BUS_READ, "barometer/pressure", NULL);
	refuses(-ENOENT, BUS_READ, "hub/config", NULL);
}

static void test_a_moisture_meter_of_either_version_is_read_and_written(void)
{
	moisture_of(79);
	tearDown();
	setUp();
	moisture_of(80);
}

static void test_a_hub_switches_its_branches(void)
{
	begin("HB_HUB");
	wire_set(slave, "short.2", 1);
	start();
	reads("hub/branch.BYTE", "           0");
	writes("hub/branch.BYTE", "5");
	reads("hub/branch.ALL", "1,0,1,0");
	writes("hub/branch.1", "1");
	reads("hub/branch.BYTE", "           7");
	writes("hub/branch.0", "0");
	reads("hub/branch.BYTE", "           6");
	reads("hub/short.BYTE", "           4");
	writes("hub/config", "2");
	writes("hub/branch.BYTE", "8");
	reads("hub/branch.BYTE", "           8");
	reads("hub/config", "           2");
	writes("hub/branch.BYTE", "9");
	reads("hub/branch.BYTE", "           9");
	reads("hub/config", "           0");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
	sim_slave_brownout(slave, wire_time());
	reads("hub/branch.BYTE", "           0");
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host_events(&host, BUS_POR),
	                               "somebody else may have switched it");
}

static bool listed(const char *property)
{
	char path[1 + ROM_TEXT_MAX] = "/";

	rom_print(slave->rom, ROM_F_I, path + 1);
	TEST_ASSERT_EQUAL_INT(0, exchange(BUS_DIR, BUS_INPUT, path, NULL)->err);
	slave_data[host.answer[0].len] = '\0';
	return strstr((char *)slave_data, property);
}

static void test_a_directory_has_what_the_board_has(void)
{
	begin("HB_BAROMETER");
	start();
	TEST_ASSERT_TRUE(listed("barometer"));
	TEST_ASSERT_FALSE(listed("moisture"));
}

static void test_a_barometer_is_read_and_written(void)
{
	begin("HB_BAROMETER");
	wire_set(slave, "pressure", 990);
	wire_set(slave, "temperature", -7.5);
	start();
	reads("barometer/pressure", "         990");
	reads("barometer/temperature", "        -7.5");
	reads("barometer/location", "nowhere");
	writes("barometer/location", "on the roof");
	reads("barometer/location", "on the roof");
	writes("barometer/altitude", "-12");
	reads("barometer/altitude", "         -12");
	writes("barometer/polling_frequency", "4");
	reads("barometer/polling_frequency", "           4");
	reads("barometer/polling_available", "           7");
	writes("barometer/config", "3");
	reads("barometer/config", "           3");
	reads("type", "HobbyBoards_EF");
	writes("barometer/reboot", "1");
	writes("barometer/reset", "0");
	reads("barometer/config", "           3");
	writes("barometer/reset", "1");
	reads("barometer/config", "           0");
	refuses(-EINVAL, BUS_WRITE, "barometer/location", "a text of 21 letters.");
}

static void test_a_hygrometer_and_six_thermometers_are_read(void)
{
	begin("HB_HUMIDITY");
	wire_set(slave, "humidity", 45.5);
	start();
	writes("humidity/humidity_offset", "-2.5");
	reads("humidity/humidity_offset", "        -2.5");
	reads("humidity/humidity_raw", "        45.5");
	reads("humidity/humidity_corrected", "          43");
	tearDown();
	setUp();
	begin("HB_MULTITEMP");
	wire_set(slave, "temperature.5", -10.5);
	start();
	reads("multitemp/temperature.5", "       -10.5");
	reads("multitemp/temperature.0", "          20");
	refuses(-EACCES, BUS_WRITE, "multitemp/config", "1");
	reads("type", "HB_MULTITEMP");
}

static void test_a_display_shows_lines_and_screens(void)
{
	begin("LCD");
	start();
	const char *shown = (const char *)memory() + 112;

	writes("LCDon", "1");
	writes("backlight", "1");
	TEST_ASSERT_EQUAL_HEX8(1, memory()[112 + 128]);
	TEST_ASSERT_EQUAL_HEX8(1, memory()[112 + 129]);
	writes("line20.0", "the first line of 20");
	writes("line20.3", "the last");
	TEST_ASSERT_EQUAL_MEMORY("the first line of 20", shown, 20);
	TEST_ASSERT_EQUAL_MEMORY("the last            ", shown + 0x40 + 20, 20);
	writes("screen16", "one\ntwo and more of it\nfour");
	TEST_ASSERT_EQUAL_MEMORY("one             it", shown, 18);
	TEST_ASSERT_EQUAL_MEMORY("two and more of four", shown + 0x40, 20);
	writes("screen40", "a line of the width of forty letters, it");
	TEST_ASSERT_EQUAL_MEMORY("a line of the width of forty letters, it", shown, 40);
	writes("backlight", "0");
	TEST_ASSERT_EQUAL_HEX8(0, memory()[112 + 129]);
	refuses(-EOPNOTSUPP, BUS_READ, "register", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "data", "65");
}

static void test_a_display_has_pins_counters_and_memory(void)
{
	begin("LCD");
	start();
	reads("version", "LCD 1.00 L.Swart");
	reads("gpio.BYTE", "           0");
	reads("counters.ALL", "           0,           0,           0,           0");
	wire_set(slave, "gpio.2", 0);
	reads("gpio.BYTE", "           4");
	wire_set(slave, "gpio.2", 1);
	reads("gpio.BYTE", "           0");
	reads("counters.2", "           2");
	reads("counters.2", "           0");
	wire_set(slave, "gpio.2", 0);
	reads("gpio.2", "1");
	reads("cumulative.ALL", "           0,           0,           3,           0");
	writes("cumulative.2", "100");
	reads("cumulative.2", "         100");
	wire_set(slave, "gpio.2", 1);
	writes("gpio.0", "1");
	reads("gpio.BYTE", "           1");
	writes("gpio.1", "1");
	reads("gpio.BYTE", "           3");
	writes("gpio.BYTE", "0");
	reads("gpio.BYTE", "           0");
	writes("memory", "some bytes that are more than sixteen");
	TEST_ASSERT_EQUAL_MEMORY("some bytes that are more than sixteen", memory(), 37);
	TEST_ASSERT_EQUAL_UINT(112, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY(memory(), slave_data, 112);
}

static void test_registers_of_a_bae0910_are_read_and_written(void)
{
	begin("BAE0910");
	wire_set(slave, "adc", 2.5);
	start();
	reads("910/adc10", "         512");
	reads("910/adc", "         128");
	reads("device_type", "           2");
	reads("chip_type", "          36");
	reads("localtype", "24.02");
	reads("version", "0C.02");
	reads("device_version", "           2");
	reads("bootstrap_version", "          12");
	writes("910/period1", "4660");
	TEST_ASSERT_EQUAL_HEX8(0x12, memory()[10]);
	TEST_ASSERT_EQUAL_HEX8(0x34, memory()[11]);
	reads("910/period1", "        4660");
	writes("910/userm", "4294967295");
	reads("910/userm", "  4294967295");
	writes("910/udate", "1000000");
	TEST_ASSERT_DOUBLE_WITHIN(2, 1000000, go(BUS_READ, "910/udate", NULL)->number);
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "910/date", NULL)->err);
	refuses(-EINVAL, BUS_WRITE, "910/period1", "65536");
	refuses(-EACCES, BUS_WRITE, "910/adc", "1");
	refuses(-ENOENT, BUS_READ, "911/analog/adc.0", NULL);
	refuses(-ENOENT, BUS_READ, "generic/memory", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "firmware/function", "anything");
	refuses(-EOPNOTSUPP, BUS_WRITE, "eeprom/page.1", "some bytes");
	memcpy(memory() + 2048 + 512, "some bytes", 10);
	TEST_ASSERT_EQUAL_UINT(512, go(BUS_READ, "eeprom/page.1", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("some bytes", slave_data, 10);
	refuses(-ENOENT, BUS_READ, "eeprom/page.2", NULL);
}

/* A write acts when its confirmation is heard, and the device says nothing of that. */
static void test_an_output_or_a_clock_of_a_bae_is_written_though_a_confirmation_is_lost(void)
{
	static const struct {
		const char *chip, *property, *value;
		unsigned bytes;
	} rows[] = {{"BAE0910", "910/pio", "1", 1},
	            {"BAE0910", "910/udate", "1000000", 4},
	            {"BAE0911", "911/pio/pio.3", "1", 1},
	            {"BAE0911", "911/timers/clock", "1000000", 4}};
	struct trouble trouble = {.kind = TROUBLE_NONE};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		begin(rows[i].chip);
		start();
		reads("version", "0C.02");
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, rows[i].property, NULL)->err);
		wire_net.trouble = &trouble;
		trouble_none(&trouble);
		trouble.kind = TROUBLE_DEAF;
		/* behind the selection, the command, its checksum */
		trouble.at = 8 * (9 + 4 + rows[i].bytes + 2);
		writes(rows[i].property, rows[i].value);
		trouble.kind = TROUBLE_NONE;
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(
			rows[i].bytes == 4 ? 2 : 0, strtod(rows[i].value, NULL),
			go(BUS_READ, rows[i].property, NULL)->number, rows[i].property);
		wire_net.trouble = NULL;
		tearDown();
		setUp();
	}
	begin("BAE0910");
	start();
}

static unsigned late;

/* What follows the confirmation comes five seconds late, as if other requests came between. */
static void be_late(const uint8_t *bytes, size_t n)
{
	if (n != 1 || bytes[0] != 0xbc)
		return;
	late++;
	host.now += 5 * HOST_S;
}

static void test_a_clock_of_a_bae_is_written_though_it_is_looked_at_late(void)
{
	begin("BAE0910");
	start();
	reads("version", "0C.02");
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "910/udate", NULL)->err);
	late = 0;
	wire_net.sent = be_late;
	writes("910/udate", "1000000");
	wire_net.sent = NULL;
	TEST_ASSERT_EQUAL_UINT(1, late);
	TEST_ASSERT_DOUBLE_WITHIN(2, 1000005, go(BUS_READ, "910/udate", NULL)->number);
}

static void test_functions_of_a_bae0911_are_registers(void)
{
	begin("BAE0911");
	wire_set(slave, "adc", 5);
	start();
	reads("device_type", "           3");
	reads("911/analog/adc.0", "        1023");
	writes("911/pio/direction.21", "1");
	reads("911/pio/direction.21", "1");
	reads("911/pio/direction.20", "0");
	TEST_ASSERT_EQUAL_HEX8(1, memory()[0x100 + 0x16 + 21]);
	writes("911/user_registers/word.15", "258");
	reads("911/user_registers/word.15", "         258");
	writes("911/automation_engine/global_mem.63", "77");
	reads("911/automation_engine/global_mem.63", "          77");
	refuses(-EOPNOTSUPP, BUS_READ, "911/automation_engine/global_memory.63", NULL);
	TEST_ASSERT_EQUAL_UINT(512, go(BUS_READ, "eeprom/page.7", NULL)->len);
}

static void test_what_no_register_of_a_bae_shows_is_refused(void)
{
	begin("BAE0911");
	start();
	refuses(-EOPNOTSUPP, BUS_READ, "911/iic/cat9554/pio", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "911/iic/cat9554/pio", "5");
	refuses(-EOPNOTSUPP, BUS_READ, "911/sdcard/sector_data", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "911/lcd/text", "a text");
	refuses(-EOPNOTSUPP, BUS_WRITE, "eeprom/erase.7", "1");
	refuses(-EOPNOTSUPP, BUS_WRITE, "command", "abc");
}

static void test_lights_fade_to_what_is_written(void)
{
	begin("IE_RGBW");
	start();
	reads("device", "Inferno Embedded RGBW Controller");
	reads("version", "           7");
	reads("status", "           1");
	reads("rgbw_channels", "           4");
	writes("rgbw_channel2", "255,10,0,7,0");
	reads("rgbw_channel2", "255, 10,  0,  7,       0");
	reads("rgbw_channel1", "  0,  0,  0,  0,       0");
	writes("rgbw_channel2", "0,0,0,0,1000");
	host_run(&host, bus, host.now + 2 * HOST_S);
	reads("rgbw_channel2", "  0,  0,  0,  0,       0");
	refuses(-EINVAL, BUS_WRITE, "rgbw_channel2", "256,0,0,0,0");
	refuses(-EINVAL, BUS_WRITE, "rgbw_channel2", "1,2,3,4");
	refuses(-EINVAL, BUS_WRITE, "rgbw_channel2", "1,2,3,4,5,6");
	writes("rgbw_channel0", "1,2,3,4,0");
	writes("rgbw_all_off", "1");
	reads("rgbw_channel0", "  0,  0,  0,  0,       0");
	refuses(-ENOENT, BUS_READ, "relay_ports", NULL);
}

static void test_switches_leds_and_relays_have_ports(void)
{
	begin("IE_SWITCH_MASTER");
	start();
	reads("device", "Inferno Embedded Switch Master");
	reads("switch_ports", "           2");
	reads("switch_channels", "           4");
	reads("relay_ports", "           1");
	refuses(-EIO, BUS_READ, "switch_port0", NULL);
	wire_set(slave, "switch.1.2", 1);
	writes("switch_refresh_activations", "1");
	reads("switch_port0", "0,0,0,0");
	reads("switch_port1", "0,0,1,0");
	writes("set_switch_type", "0,3,1");
	writes("switch_refresh_activations", "1");
	reads("switch_port0", "0,0,0,1");
	writes("led_port1", "1,0,0,1");
	reads("led_port1", "1,0,0,1");
	reads("led_port0", "0,0,0,0");
	writes("relay_port0", "0,255,1");
	reads("relay_port0", "0,255,1,0");
	writes("relay_timeout0", "1,2,3,4");
	writes("relay_mode0", "1");
	reads("relay_timeout0", "1,2,3,4");
	reads("relay_mode0", "1,0,0,0");
	refuses(-ENOENT, BUS_READ, "relay_port1", NULL);
	refuses(-EINVAL, BUS_WRITE, "led_port1", "1,2");
	refuses(-EINVAL, BUS_WRITE, "relay_port0", "1,2,3,4,5");
	refuses(-EINVAL, BUS_WRITE, "set_switch_type", "0,4,1");
}

/* The device gives them once; what is read of them later is as old as that. */
static void test_activations_of_switches_are_as_old_as_their_refresh(void)
{
	begin("IE_SWITCH_MASTER");
	start();
	int64_t before = host.now;

	writes("switch_refresh_activations", "1");
	int64_t after = host.now;

	host_run(&host, bus, host.now + 60 * HOST_S);
	const struct bus_answer *answer = go(BUS_READ, "switch_port1", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(before, answer->measured_ns);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(after, answer->measured_ns);
	/* what is asked of the device itself is new */
	answer = go(BUS_READ, "led_port1", NULL);
	TEST_ASSERT_GREATER_THAN_INT64(after, answer->measured_ns);
}

static void test_the_updater_of_a_firmware_is_known_and_refused(void)
{
	begin("IE_SWITCH_MASTER");
	start();
	refuses(-ENOENT, BUS_READ, "firmware_range", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "enter_firmware_update", "1");
	reads("device", "Inferno Embedded Switch Master");
	reads("switch_ports", "           2");
	tearDown();
	setUp();
	begin("IE_UPDATER");
	start();
	reads("device", "Inferno Embedded Firmware Updater");
	refuses(-EOPNOTSUPP, BUS_READ, "firmware_range", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "erase_firmware", "1");
	refuses(-EOPNOTSUPP, BUS_WRITE, "exit_firmware_update", "1");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_sensors_with_one_word_are_read);
	RUN_TEST(test_contacts_are_open_closed_shorted_or_interrupted);
	RUN_TEST(test_a_room_is_measured);
	RUN_TEST(test_a_room_whose_checksum_covers_the_command_is_measured);
	RUN_TEST(test_a_room_with_another_checksum_has_no_value);
	RUN_TEST(test_a_uvi_meter_keeps_its_offsets_below_zero_too);
	RUN_TEST(test_a_value_of_a_uvi_meter_is_refused_when_its_offset_may_be_a_disturbed_read);
	RUN_TEST(test_a_moisture_meter_of_either_version_is_read_and_written);
	RUN_TEST(test_a_hub_switches_its_branches);
	RUN_TEST(test_a_directory_has_what_the_board_has);
	RUN_TEST(test_a_barometer_is_read_and_written);
	RUN_TEST(test_a_hygrometer_and_six_thermometers_are_read);
	RUN_TEST(test_a_display_shows_lines_and_screens);
	RUN_TEST(test_a_display_has_pins_counters_and_memory);
	RUN_TEST(test_registers_of_a_bae0910_are_read_and_written);
	RUN_TEST(test_an_output_or_a_clock_of_a_bae_is_written_though_a_confirmation_is_lost);
	RUN_TEST(test_a_clock_of_a_bae_is_written_though_it_is_looked_at_late);
	RUN_TEST(test_functions_of_a_bae0911_are_registers);
	RUN_TEST(test_what_no_register_of_a_bae_shows_is_refused);
	RUN_TEST(test_lights_fade_to_what_is_written);
	RUN_TEST(test_switches_leds_and_relays_have_ports);
	RUN_TEST(test_activations_of_switches_are_as_old_as_their_refresh);
	RUN_TEST(test_the_updater_of_a_firmware_is_known_and_refused);
	return UNITY_END();
}
