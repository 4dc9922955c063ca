/* SPDX-License-Identifier: MIT */
/* Tests of the chip families over the native bus and simulated slaves. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
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

static void start(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	wire_add(0, "DS18B20", 2);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static void test_what_does_not_fit_a_ds2408_is_not_written(void)
{
	static const struct {
		const char *property, *text;
	} wrong[] = {
		{"PIO.BYTE", "-1"},
		{"PIO.BYTE", "256"},
		{"PIO.BYTE", "300"},
		{"PIO.BYTE", "3.7"},
		{"PIO.BYTE", "12abc"},
		{"PIO.BYTE", "1,1"},
		{"PIO.BYTE", "0x10"},
		{"PIO.0", "2"},
		{"PIO.0", "-1"},
		{"PIO.0", "1 0"},
		{"PIO.ALL", "1,0,1"},
		{"PIO.ALL", "1,0,1,0,1,0,1,0,1"},
		{"PIO.ALL", "1,0,1,0,1,0,1,2"},
		{"set_alarm", "-1"},
		{"set_alarm", "433333333"},
		{"set_alarm", "133333334"},
		{"set_alarm", "1133333333"},
		{"por", "7"},
	};

	start("DS2408");
	writes("PIO.BYTE", "85");
	writes("set_alarm", "133333333");
	writes("por", "0");
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		refuses(-EINVAL, BUS_WRITE, wrong[i].property, wrong[i].text);
		reads("PIO.BYTE", "          85");
		reads("set_alarm", "   133333333");
		reads("por", "0");
	}
	writes("PIO.BYTE", " 170\n");
	reads("PIO.BYTE", "         170");
}

static void test_a_ds2408_switches_and_keeps_its_neighbours(void)
{
	start("DS2408");
	reads("por", "1");
	writes("por", "0");
	reads("por", "0");
	writes("PIO.BYTE", "170");
	reads("PIO.BYTE", "         170");
	reads("PIO.ALL", "0,1,0,1,0,1,0,1");
	writes("PIO.0", "1");
	writes("PIO.7", "off");
	reads("PIO.BYTE", "          43");
	reads("sensed.BYTE", "         212");
	writes("PIO.ALL", "0,0,0,0,0,0,0,0");
	reads("PIO.BYTE", "           0");
	writes("latch.BYTE", "0");
	reads("latch.BYTE", "           0");
	writes("set_alarm", "133333333");
	reads("set_alarm", "   133333333");
	writes("set_alarm", "322000001");
	reads("set_alarm", "   322000001");
	reads("por", "0");
	writes("strobe", "1");
	reads("strobe", "1");
	writes("out_of_testmode", "1");
	refuses(-EINVAL, BUS_WRITE, "PIO.0", "maybe");
	refuses(-ENOENT, BUS_READ, "PIO", NULL);
	refuses(-ENOENT, BUS_READ, "PIO.8", NULL);
	refuses(-ENOENT, BUS_READ, "PIO.A", NULL);
}

static void test_a_ds2408_that_restarts_is_told(void)
{
	start("DS2408");
	writes("por", "0");
	writes("PIO.BYTE", "15");
	sim_slave_power_on(slave, host.now);
	reads("sensed.BYTE", "         255");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
	reads("por", "1");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
}

static void test_a_ds2413_switches(void)
{
	start("DS2413");
	reads("PIO.BYTE", "           0");
	writes("PIO.B", "1");
	reads("PIO.BYTE", "           2");
	reads("PIO.ALL", "0,1");
	reads("sensed.BYTE", "           1");
	writes("PIO.BYTE", "3");
	reads("sensed.ALL", "0,0");
	refuses(-EACCES, BUS_WRITE, "sensed.A", "1");
}

static void test_a_ds28ea00_measures_and_switches(void)
{
	start("DS28EA00");
	wire_set(slave, "temperature", 33.5);
	reads("temperature", "        33.5");
	writes("PIO.A", "1");
	reads("PIO.BYTE", "           1");
	reads("latch.BYTE", "           1");
	reads("sensed.BYTE", "           2");
	wire_set(slave, "pin.B", 0);
	reads("PIO.BYTE", "           3");
	reads("latch.BYTE", "           1");
	writes("PIO.A", "0");
	reads("PIO.BYTE", "           2");
	reads("latch.BYTE", "           0");
	reads("temperature9", "        33.5");
}

static void test_a_ds1825_has_its_place(void)
{
	start("DS1825");
	wire_set(slave, "temperature", -7.25);
	reads("temperature", "       -7.25");
	reads("type", "DS1825");
	reads("prog_addr", "           0");
	refuses(-ENOENT, BUS_READ, "thermocouple", NULL);
	writes("templow", "-20");
	reads("templow", "         -20");
}

static void test_a_ds18s20_resolves_sixteenths(void)
{
	start("DS18S20");
	for (int i = -8; i <= 8; i++) {
		char text[16];

		wire_set(slave, "temperature", i / 16.0 + 1);
		snprintf(text, sizeof(text), "%12G", i / 16.0 + 1);
		reads("temperature", text);
	}
}

static void test_the_trim_of_the_factory_is_refused(void)
{
	start("DS18S20");
	reads("errata/die", "C2");
	refuses(-EOPNOTSUPP, BUS_READ, "errata/trim", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "errata/trim", "100");
	refuses(-EOPNOTSUPP, BUS_READ, "errata/trimvalid", NULL);
}

static void test_a_ds2438_measures_and_keeps_time(void)
{
	start("DS2438");
	reads("VDD", "           5");
	reads("VAD", "           0");
	reads("temperature", "          20");
	TEST_ASSERT_EQUAL_UINT(8, go(BUS_READ, "pages/page.0", NULL)->len);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x0f, slave_data[0],
	                               "the stored configuration is as it was");
	reads("MultiSensor/type", "MS-T");
	reads("B1-R1-A/gain", "     21.7391");
	reads("S3-R1-A/gain", "     105.263");
	writes("udate", "1000000000");
	const struct bus_answer *answer = go(BUS_READ, "udate", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_DOUBLE_WITHIN(5, 1000000000, answer->number);
	writes("offset", "-5");
	reads("offset", "  4294967291");
	reads("IAD", "1");
	writes("IAD", "0");
	reads("IAD", "0");
	reads("vis", "           0");
	reads("IAD", "0");
	refuses(-EINVAL, BUS_WRITE, "offset", "1000");
	refuses(-EINVAL, BUS_WRITE, "offset", "-257");
	writes("offset", "4294967291");
	reads("offset", "  4294967291");
	writes("pages/page.4", "abcdefgh");
	reads("pages/page.4", "abcdefgh");
}

/* The texts are owserver's own for the same network. */
static void test_sensors_on_a_ds2438_say_what_owserver_says(void)
{
	start("DS2438");
	wire_set(slave, "temperature", 60);
	wire_set(slave, "vdd", 5.2);
	wire_set(slave, "vad", 3.9);
	wire_set(slave, "vsens", 10);
	reads("humidity", "      103.95");
	reads("HIH3600/humidity", "      103.95");
	reads("HIH4000/humidity", "     102.877");
	reads("HIH5030/humidity", "     101.734");
	reads("HTM1735/humidity", "     109.808");
	reads("B1-R1-A/gain", "     21.7391");
	reads("B1-R1-A/offset", "       904.7");
	reads("S3-R1-A/gain", "     105.263");
	reads("S3-R1-A/current", "     25.6618");
	reads("S3-R1-A/illuminance", "     2701.24");
	reads("MultiSensor/type", "MS-T");
	writes("pages/page.3", "\x1b\x01\x64\x01\x58\x02\x7b\x01");
	reads("MultiSensor/type", "MS-TL");
	reads("B1-R1-A/gain", "         0.6");
	writes("B1-R1-A/gain", "12.34");
	writes("B1-R1-A/offset", "-56.7");
	writes("S3-R1-A/gain", "8.9");
	reads("B1-R1-A/gain", "       12.34");
	reads("B1-R1-A/offset", "       -56.7");
	refuses(-EDOM, BUS_READ, "B1-R1-A/pressure", NULL); /* -8.574 mbar is none */
	writes("B1-R1-A/offset", "56.7");
	reads("B1-R1-A/pressure", "     104.826");
	reads("S3-R1-A/illuminance", "      228.39");
	wire_set(slave, "vsens", -3);
	reads("S3-R1-A/illuminance", "           1");
	reads("S3-R1-A/current", "    -7.51077");
	writes("pages/page.3", "\x01\x01\xff\xff\xff\xff\xff\xff");
	reads("S3-R1-A/gain", "      6553.5");
	reads("B1-R1-A/gain", "      65.535");
	reads("B1-R1-A/offset", "       -0.05");
	refuses(-EINVAL, BUS_WRITE, "S3-R1-A/gain", "3277");
	refuses(-EINVAL, BUS_WRITE, "B1-R1-A/gain", "-1");
	writes("pages/page.3", "\x1f");
	reads("MultiSensor/type", "unknown");
}

static void test_a_ds2405_is_not_turned_over_by_looking(void)
{
	start("DS2405");
	reads("PIO", "0");
	reads("sensed", "1");
	writes("PIO", "1");
	reads("PIO", "1");
	reads("sensed", "0");
	writes("PIO", "1");
	reads("PIO", "1");
	writes("PIO", "0");
	reads("PIO", "0");
	writes("PIO", "0");
	reads("PIO", "0");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	refuses(-ENODEV, BUS_READ, "PIO", NULL);
	sim_wire_plug(&wire_net.wire[0], slave, true, wire_time());
}

static void test_a_ds2406_switches_and_alarms(void)
{
	start("DS2406");
	reads("channels", "           2");
	reads("PIO.BYTE", "           0");
	writes("PIO.A", "1");
	reads("PIO.BYTE", "           1");
	reads("flipflop.BYTE", "           2");
	reads("sensed.BYTE", "           2");
	writes("PIO.BYTE", "0");
	reads("PIO.ALL", "0,0");
	writes("latch.BYTE", "0");
	reads("latch.BYTE", "           0");
	writes("set_alarm", "311");
	reads("set_alarm", "         311");
	reads("PIO.BYTE", "           0");
	refuses(-EOPNOTSUPP, BUS_WRITE, "memory", "x");
	refuses(-ENOENT, BUS_READ, "TAI8570/pressure", NULL);
	refuses(-ENOENT, BUS_READ, "T8A/volt.0", NULL);
	TEST_ASSERT_EQUAL_UINT(128, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_UINT(32, go(BUS_READ, "pages/page.3", NULL)->len);
}

static void memory_of(const char *chip, unsigned size, unsigned page)
{
	char text[2700];

	start(chip);
	for (unsigned i = 0; i < sizeof(text) - 1; i++)
		text[i] = (char)('a' + i * 7 % 26);
	text[sizeof(text) - 1] = '\0';
	TEST_ASSERT_EQUAL_INT(0, go(BUS_WRITE, "memory", text)->err);
	TEST_ASSERT_EQUAL_UINT(size, host.answer[0].len);
	TEST_ASSERT_EQUAL_UINT(size, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_INT(0, host.answer[0].err);
	TEST_ASSERT_EQUAL_MEMORY(text, slave_data, size);
	writes("memory", "hello");
	TEST_ASSERT_EQUAL_UINT(size, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("hello", slave_data, 5);
	TEST_ASSERT_EQUAL_MEMORY(text + 5, slave_data + 5, size - 5);
	if (!page)
		return;
	writes("pages/page.1", "0123456789");
	TEST_ASSERT_EQUAL_UINT(page, go(BUS_READ, "pages/page.1", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("0123456789", slave_data, 10);
	TEST_ASSERT_EQUAL_MEMORY(text + page + 10, slave_data + 10, page - 10);
}

static void test_memories_are_written_and_read(void)
{
	memory_of("DS2431", 128, 32);
	tearDown();
	memory_of("DS2433", 512, 32);
	tearDown();
	memory_of("DS2430A", 32, 0);
	reads("status", "         255");
	tearDown();
	memory_of("DS2423", 512, 32);
	tearDown();
	memory_of("DS28EC20", 2560, 32);
	TEST_ASSERT_EQUAL_UINT(32, go(BUS_READ, "pages/page.79", NULL)->len);
	refuses(-ENOENT, BUS_READ, "pages/page.80", NULL);
}

static void test_a_ds2502_is_read_and_needs_more_than_this_master_has_to_be_written(void)
{
	size_t size;

	start("DS2502");
	uint8_t *memory = sim_slave_memory(slave, &size);
	for (unsigned i = 0; i < 128; i++)
		memory[i] = (uint8_t)(i * 3);
	TEST_ASSERT_EQUAL_UINT(128, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY(memory, slave_data, 128);
	TEST_ASSERT_EQUAL_UINT(32, go(BUS_READ, "pages/page.2", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY(memory + 64, slave_data, 32);
	refuses(-ENOENT, BUS_READ, "pages/page.4", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "memory", "x");
	refuses(-EOPNOTSUPP, BUS_WRITE, "pages/page.0", "x");
	TEST_ASSERT_EQUAL_HEX8(0, memory[0]);
}

static void test_a_ds2720_shows_its_flags_and_takes_back_what_is_over(void)
{
	start("DS2720");
	reads("ce", "1");
	reads("de", "1");
	reads("cc", "1");
	reads("dc", "1");
	reads("psf", "1");
	writes("ce", "0");
	reads("cc", "0");
	reads("ce", "0");
	reads("dc", "1");
	writes("ce", "1");
	refuses(-EOPNOTSUPP, BUS_WRITE, "cc", "0"); /* it shows a pin */
	refuses(-EOPNOTSUPP, BUS_WRITE, "dc", "0");
	wire_set(slave, "overvoltage", 1);
	reads("ov", "1");
	reads("cc", "0");
	refuses(-EIO, BUS_WRITE, "ov", "0"); /* it lasts */
	wire_set(slave, "overvoltage", 0);
	writes("ov", "0");
	reads("cc", "1");
	refuses(-EIO, BUS_WRITE, "uv", "1"); /* the chip alone sets it */
	wire_set(slave, "undervoltage", 1);
	wire_set(slave, "overtemperature", 1);
	reads("uv", "1");
	reads("doc", "0");
	reads("ot", "1");
	reads("dc", "0");
}

static void test_what_is_written_to_a_page_of_a_ds2720_is_there_after_a_restart(void)
{
	start("DS2720");
	writes("pages/page.1", "abcd");
	writes("pages/page.0", "xy");
	sim_slave_brownout(slave, wire_time());
	reads("pages/page.1", "abcd");
	TEST_ASSERT_EQUAL_UINT(4, go(BUS_READ, "pages/page.0", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("xy\0\0", slave_data, 4);
	TEST_ASSERT_EQUAL_UINT(256, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("xy", slave_data + 0x20, 2);
	TEST_ASSERT_EQUAL_MEMORY("abcd", slave_data + 0x30, 4);
	refuses(-EOPNOTSUPP, BUS_WRITE, "memory", "x");
}

static void test_a_block_of_a_ds2720_is_locked_by_nobody(void)
{
	start("DS2720");
	reads("lock.0", "0");
	reads("lock.1", "0");
	refuses(-EOPNOTSUPP, BUS_WRITE, "lock.1", "1");
	reads("lock.1", "0");
}

/*
 * Read Application Register has the register's own scratchpad, Read Scratchpad that of the memory.
 */
static void test_the_application_register_of_a_ds2430a_is_written_once(void)
{
	start("DS2430A");
	writes("application", "register");
	TEST_ASSERT_EQUAL_UINT(8, go(BUS_READ, "application", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("register", slave_data, 8);
	reads("status", "         252");
	go(BUS_WRITE, "application", "anything");
	TEST_ASSERT_EQUAL_INT(-EBADE, host.answer[0].err);
}

static void test_a_ds2423_counts(void)
{
	start("DS2423");
	reads("counter.ALL", "           0,           0");
	reads("counters.A", "           0");
	reads("mincount", "           0");
	reads("pages/count.14", "           0");
	refuses(-ENOENT, BUS_READ, "pages/count.11", NULL);
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "count.A", UINT32_MAX));
	reads("counter.A", "  4294967295");
	TEST_ASSERT_NOT_EQUAL_INT(0, sim_slave_option(slave, "count.A", 4294967296.0));
}

static void test_a_ds2450_converts_and_switches(void)
{
	start("DS2450");
	wire_set(slave, "volt.A", 2.5);
	writes("pages/page.3", "....1");
	reads("power", "0");
	writes("power", "1");
	reads("power", "1");
	go(BUS_READ, "volt.ALL", NULL);
	TEST_ASSERT_EQUAL_INT(0, host.answer[0].err);
	TEST_ASSERT_EQUAL_UINT(51, host.answer[0].len);
	TEST_ASSERT_DOUBLE_WITHIN(0.01, 2.5, go(BUS_READ, "volt.A", NULL)->number);
	reads("PIO.ALL", "1,1,1,1");
	writes("PIO.B", "0");
	reads("PIO.ALL", "1,0,1,1");
	refuses(-EINVAL, BUS_WRITE, "PIO.ALL", "0,1,0,2");
	refuses(-EINVAL, BUS_WRITE, "PIO.ALL", "0,1,0");
	refuses(-EINVAL, BUS_WRITE, "PIO.ALL", "0,1,0,1,0");
	reads("PIO.ALL", "1,0,1,1");
	writes("PIO.B", "1");
	reads("PIO.B", "1");
	reads("set_alarm/volthigh.C", "         5.1");
	writes("set_alarm/volthigh.C", "2.56");
	reads("set_alarm/volthigh.C", "        2.56");
	writes("set_alarm/high.ALL", "0,0,0,0");
	writes("set_alarm/high.C", "1");
	reads("set_alarm/high.ALL", "0,0,1,0");
	writes("set_alarm/unset", "0");
	TEST_ASSERT_EQUAL_UINT(32, go(BUS_READ, "memory", NULL)->len);
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "8bit/volt2.A", NULL)->err);
	wire_set(slave, "volt.B", 3.2);
	wire_set(slave, "volt.D", 3);
	TEST_ASSERT_DOUBLE_WITHIN(20, 2500, go(BUS_READ, "CO2/ppm", NULL)->number);
	reads("CO2/status", "           1");
	reads("CO2/Vdd", "0");
	writes("power", "0");
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
}

static bool listed_in_alarm(void)
{
	char name[ROM_TEXT_MAX];

	rom_print(slave->rom, ROM_F_I, name);
	TEST_ASSERT_EQUAL_INT(0, exchange(BUS_DIR, BUS_ALARM, "/alarm", NULL)->err);
	slave_data[host.answer[0].len] = '\0';
	return strstr((char *)slave_data, name);
}

static void arm_a_ds2450(void)
{
	writes("power", "1");
	writes("set_alarm/volthigh.A", "2");
	writes("set_alarm/high.A", "1");
	TEST_ASSERT_FALSE(listed_in_alarm());
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
	TEST_ASSERT_TRUE_MESSAGE(listed_in_alarm(), "the voltage is above its limit");
}

static void test_a_ds2450_that_restarts_is_told_once_and_alarms_again(void)
{
	start("DS2450");
	wire_set(slave, "volt.A", 3);
	arm_a_ds2450();
	for (unsigned i = 1; i <= 3; i++) {
		sim_slave_brownout(slave, wire_time());
		TEST_ASSERT_TRUE_MESSAGE(listed_in_alarm(), "the power-on flags are set");
		reads("alarm/high.A", "0");
		TEST_ASSERT_EQUAL_UINT(i, host_events(&host, BUS_POR));
		reads("PIO.ALL", "1,1,1,1");
		reads("alarm/high.A", "0");
		TEST_ASSERT_EQUAL_UINT(i, host_events(&host, BUS_POR));
		arm_a_ds2450();
		TEST_ASSERT_EQUAL_UINT(i, host_events(&host, BUS_POR));
	}
}

static void test_the_results_of_a_ds2450_that_restarted_are_measured_anew(void)
{
	static const enum bus_prio prio[] = {BUS_INPUT, BUS_ALARM};

	for (unsigned i = 0; i < 2; i++) {
		start("DS2450");
		wire_set(slave, "volt.A", 3);
		arm_a_ds2450();
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "latestvolt.A", NULL)->err);
		sim_slave_brownout(slave, wire_time());
		const struct bus_answer *answer = exchange(BUS_READ, prio[i],
		                                           slave_path("latestvolt.A"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_DOUBLE_WITHIN(0.02, 3, answer->number);
		TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
		sim_slave_brownout(slave, wire_time());
		writes("set_alarm/high.A", "1");
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "latestvolt.A", NULL)->err);
		TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.02, 3,
		                                  go(BUS_READ, "latestvolt.A", NULL)->number,
		                                  "the flags are cleared, the results still void");
		wire_set(slave, "volt.A", 0);
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
		TEST_ASSERT_DOUBLE_WITHIN(0.02, 0, go(BUS_READ, "latestvolt.A", NULL)->number);
		tearDown();
		setUp();
	}
}

static void test_a_measurement_leaves_the_outputs_of_a_ds2450_as_they_are(void)
{
	static const char *const measured[] = {"volt.A",      "volt.ALL",     "volt2.B",
	                                       "8bit/volt.C", "8bit/volt2.D", "latestvolt.A",
	                                       "CO2/ppm"};

	start("DS2450");
	writes("PIO.A", "0");
	writes("PIO.C", "0");
	for (size_t i = 0; i < sizeof(measured) / sizeof(measured[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, go(BUS_READ, measured[i], NULL)->err, measured[i]);
		reads("PIO.ALL", "0,1,0,1");
	}
}

static void test_a_conversion_tells_that_a_ds2450_has_restarted(void)
{
	start("DS2450");
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
	for (unsigned i = 1; i <= 2; i++) {
		sim_slave_brownout(slave, wire_time());
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
		TEST_ASSERT_EQUAL_UINT(i, host_events(&host, BUS_POR));
	}
	writes("set_alarm/unset", "1");
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "volt.A", NULL)->err);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(2, host_events(&host, BUS_POR), "we set the flags");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_does_not_fit_a_ds2408_is_not_written);
	RUN_TEST(test_a_ds2408_switches_and_keeps_its_neighbours);
	RUN_TEST(test_a_ds2408_that_restarts_is_told);
	RUN_TEST(test_a_ds2413_switches);
	RUN_TEST(test_a_ds28ea00_measures_and_switches);
	RUN_TEST(test_a_ds1825_has_its_place);
	RUN_TEST(test_a_ds18s20_resolves_sixteenths);
	RUN_TEST(test_the_trim_of_the_factory_is_refused);
	RUN_TEST(test_a_ds2438_measures_and_keeps_time);
	RUN_TEST(test_sensors_on_a_ds2438_say_what_owserver_says);
	RUN_TEST(test_a_ds2405_is_not_turned_over_by_looking);
	RUN_TEST(test_a_ds2406_switches_and_alarms);
	RUN_TEST(test_memories_are_written_and_read);
	RUN_TEST(test_a_ds2502_is_read_and_needs_more_than_this_master_has_to_be_written);
	RUN_TEST(test_a_ds2720_shows_its_flags_and_takes_back_what_is_over);
	RUN_TEST(test_what_is_written_to_a_page_of_a_ds2720_is_there_after_a_restart);
	RUN_TEST(test_a_block_of_a_ds2720_is_locked_by_nobody);
	RUN_TEST(test_the_application_register_of_a_ds2430a_is_written_once);
	RUN_TEST(test_a_ds2423_counts);
	RUN_TEST(test_a_ds2450_converts_and_switches);
	RUN_TEST(test_a_ds2450_that_restarts_is_told_once_and_alarms_again);
	RUN_TEST(test_the_results_of_a_ds2450_that_restarted_are_measured_anew);
	RUN_TEST(test_a_measurement_leaves_the_outputs_of_a_ds2450_as_they_are);
	RUN_TEST(test_a_conversion_tells_that_a_ds2450_has_restarted);
	return UNITY_END();
}
