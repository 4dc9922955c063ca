/* SPDX-License-Identifier: MIT */
/* The battery monitors: what they measure, what they keep, and that they lock for good. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/thermometers/thermocouple.h"
#include "hal/sim/chips/gauge.h"
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
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static double value(const char *property)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, go(BUS_READ, property, NULL)->err, property);
	slave_data[host.answer[0].len] = '\0';
	return strtod((const char *)slave_data, NULL);
}

static void measures(const char *chip, double volt, double vis)
{
	start(chip);
	wire_set(slave, "temperature", -20.25);
	wire_set(slave, "vis", -12.5);
	wire_set(slave, "volt", 3.9);
	reads("temperature", "      -20.25");
	TEST_ASSERT_DOUBLE_WITHIN(volt, 3.9, value("volt"));
	TEST_ASSERT_DOUBLE_WITHIN(vis, -12.5e-3, value("vis"));
	one_slave_end();
	one_slave_begin();
}

static void test_gauges_read_what_the_chip_measures(void)
{
	measures("DS2751", .00488, 15.7e-6);
	measures("DS2755", .00488, 15.7e-6);
	measures("DS2760", .00488, 15.7e-6);
	measures("DS2770", .00488, 1.6e-6);
	measures("DS2780", .00488, 1.6e-6);
	measures("DS2781", .00976, 1.6e-6);
}

static void test_currents_are_those_of_a_resistor_of_25_milliohms(void)
{
	start("DS2760");
	wire_set(slave, "vis", -12.5);
	TEST_ASSERT_DOUBLE_WITHIN(1e-3, -.5, value("current"));
	writes("amphours", "1.5");
	TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.5, value("amphours"));
	TEST_ASSERT_DOUBLE_WITHIN(1e-4, .0375, value("volthours"));
}

static void test_a_ds2740_measures_its_resistor(void)
{
	start("DS2740");
	wire_set(slave, "vis", 10);
	TEST_ASSERT_DOUBLE_WITHIN(1.6e-6, 10e-3, value("vis_B"));
	TEST_ASSERT_DOUBLE_WITHIN(1.6e-6, 10e-3, value("vis"));
	writes("smod", "1");
	reads("smod", "1");
	writes("PIO", "1");
	reads("PIO", "1");
	writes("PIO", "0");
	reads("PIO", "0");
}

static void accumulates(const char *chip)
{
	start(chip);
	writes("volthours", "-0.05");
	TEST_ASSERT_DOUBLE_WITHIN(2e-5, -.05, value("volthours"));
	refuses(-EINVAL, BUS_WRITE, "volthours", "0.3");
	one_slave_end();
	one_slave_begin();
}

static void test_the_accumulated_current_can_be_set(void)
{
	accumulates("DS2740");
	accumulates("DS2751");
	accumulates("DS2755");
	accumulates("DS2760");
	accumulates("DS2770");
	accumulates("DS2780");
	accumulates("DS2781");
}

/* What is written is there after a power loss too. */
static void keeps(const char *chip, const char *property, const char *text, double expected)
{
	start(chip);
	writes(property, text);
	sim_slave_brownout(slave, wire_time());
	TEST_ASSERT_DOUBLE_WITHIN(2e-6, expected, value(property));
	one_slave_end();
	one_slave_begin();
}

static void test_biases_and_settings_are_kept_without_power(void)
{
	keeps("DS2751", "vbias", "-0.001", -.001);
	keeps("DS2751", "uven", "1", 1);
	keeps("DS2755", "vbias", "0.0001", .0001);
	keeps("DS2755", "ios", "1", 1);
	keeps("DS2760", "vbias", "0.0015", .0015);
	keeps("DS2760", "defaultswen", "1", 1);
	keeps("DS2770", "vbias", "0.0123", .0123);
	keeps("DS2780", "vbias", "0.0001", .0001);
	keeps("DS2780", "uven", "1", 1);
	keeps("DS2781", "vbias", "-0.0001", -.0001);
	keeps("DS2781", "vis_offset", "0.00019", .00019);
}

static void test_a_lock_is_read_and_never_set(void)
{
	static const char *const chips[] = {"DS2751", "DS2755", "DS2760",
	                                    "DS2770", "DS2780", "DS2781"};

	for (unsigned i = 0; i < sizeof(chips) / sizeof(chips[0]); i++) {
		start(chips[i]);
		reads("lock.0", "0");
		refuses(-EOPNOTSUPP, BUS_WRITE, "lock.0", "1");
		one_slave_end();
		one_slave_begin();
	}
}

static void test_what_is_read_of_a_ds2760_leaves_its_protection_as_it_was(void)
{
	start("DS2760");
	reads("ce", "1");
	writes("ce", "0");
	(void)value("vbias");
	(void)value("defaultpmod");
	go(BUS_READ, "pages/page.1", NULL);
	reads("ce", "0");
	wire_set(slave, "overvoltage", 1);
	reads("ov", "1");
	wire_set(slave, "overvoltage", 0);
	writes("ov", "0");
	reads("ov", "0");
	refuses(-EIO, BUS_WRITE, "ov", "1");
}

static void test_a_ds2770_charges_only_where_there_is_a_charger(void)
{
	start("DS2770");
	refuses(-EIO, BUS_WRITE, "charge", "1");
	wire_set(slave, "charger", 1);
	writes("charge", "1");
	reads("cstat0", "1");
	reads("cstat1", "0");
	writes("charge", "0");
	reads("cstat0", "0");
	refuses(-EOPNOTSUPP, BUS_WRITE, "refresh", "1");
	refuses(-EOPNOTSUPP, BUS_WRITE, "cini", "1");
	writes("timer", "600");
	TEST_ASSERT_DOUBLE_WITHIN(.02, 600, value("timer"));
}

static void test_a_ds2780_tells_its_flags_and_takes_back_what_can_be_cleared(void)
{
	start("DS2780");
	reads("porf", "1");
	writes("porf", "0");
	reads("porf", "0");
	wire_set(slave, "active_empty", 1);
	reads("aef", "1");
	reads("sef", "0");
	refuses(-EIO, BUS_WRITE, "aef", "0");
}

static void test_a_ds2781_has_the_flag_active_empty_where_its_data_sheet_has_it(void)
{
	start("DS2781");
	wire_set(slave, "learning", 1);
	reads("aef", "0");
	wire_set(slave, "active_empty", 1);
	reads("aef", "1");
}

static void test_a_pin_conducts_and_is_free(void)
{
	start("DS2760");
	reads("sensed", "1");
	writes("PIO", "1");
	reads("sensed", "0");
	writes("PIO", "0");
	reads("sensed", "1");
	wire_set(slave, "pin", 0);
	refuses(-EIO, BUS_WRITE, "PIO", "0"); /* nobody can see that it is free */
}

static void test_the_alarm_of_a_ds2755_is_a_temperature(void)
{
	start("DS2755");
	writes("alarm_set", "-7");
	TEST_ASSERT_EQUAL_DOUBLE(-7, value("alarm_set"));
	refuses(-EINVAL, BUS_WRITE, "alarm_set", "130");
}

/* Values of the tables of NIST Monograph 175. */
static void test_thermocouples_follow_the_tables_of_nist(void)
{
	static const struct {
		enum thermocouple type;
		double celsius, mv;
	} table[] = {
		{TYPE_B, 1000, 4.834},  {TYPE_B, 1800, 13.591}, {TYPE_E, -200, -8.825},
		{TYPE_E, 500, 37.005},  {TYPE_J, -100, -4.633}, {TYPE_J, 1000, 57.953},
		{TYPE_K, -200, -5.891}, {TYPE_K, 100, 4.096},   {TYPE_K, 1000, 41.276},
		{TYPE_N, -100, -2.407}, {TYPE_N, 1000, 36.256}, {TYPE_R, 500, 4.471},
		{TYPE_R, 1500, 17.451}, {TYPE_S, 500, 4.233},   {TYPE_S, 1700, 17.947},
		{TYPE_T, -200, -5.603}, {TYPE_T, 300, 14.862},
	};
	double celsius;

	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		TEST_ASSERT_DOUBLE_WITHIN(.00051, table[i].mv,
		                          thermocouple_mv(table[i].type, table[i].celsius));
		TEST_ASSERT_TRUE(
			thermocouple_celsius(table[i].type,
		                             thermocouple_mv(table[i].type, table[i].celsius) -
		                                     thermocouple_mv(table[i].type, 25),
		                             25, &celsius));
		TEST_ASSERT_DOUBLE_WITHIN(1e-6, table[i].celsius, celsius);
	}
}

static void test_the_hot_end_is_found_by_voltage_and_cold_end(void)
{
	start("DS2780");
	wire_set(slave, "temperature", 25);
	wire_set(slave, "vis", 4.096 - 1.000);
	TEST_ASSERT_DOUBLE_WITHIN(.1, 100, value("typeK/temperature"));
	reads("typeK/range_high", "        1370");
	reads("typeR/range_low", "         -50");
	wire_set(slave, "vis", 51.1);
	refuses(-ERANGE, BUS_READ, "typeS/temperature", NULL);
}

static void test_a_ds2760_without_a_weather_station_says_so(void)
{
	start("DS2760");
	refuses(-EIO, BUS_READ, "WS603/direction", NULL);
	refuses(-EOPNOTSUPP, BUS_WRITE, "WS603/calibration/direction", "7");
	refuses(-EOPNOTSUPP, BUS_WRITE, "WS603/LED/control.ALL", "1,2,3,4");
	reads("WS603/temperature", "          20");
}

static unsigned wind;

/* A weather station: it answers what stands at 80h, where nothing else is to be read. */
static void station(int64_t now)
{
	uint8_t *memory = sim_state(slave, gauge)->memory, *answer = memory + 0x88;
	bool asks = (memory[0x80] == 0xa0 || memory[0x80] == 0xa1) && memory[0x81] == memory[0x80];

	(void)now;
	if (!asks || memory[0x82] != (uint8_t)(memory[0x80] << 4 | 0x0e) || answer[0])
		return;
	answer[0] = memory[0x80];
	answer[1] = answer[0] == 0xa1 ? (uint8_t)wind : 4;
	answer[2] = answer[0] == 0xa1 ? 7 : 150;
	answer[3] = 2;
	answer[4] = answer[5] = answer[6] = 0;
	for (unsigned i = 0; i < 6; i++)
		answer[6] = (uint8_t)(answer[6] + answer[i]);
}

static void test_a_weather_station_answers_each_time_anew(void)
{
	start("DS2760");
	wire_net.used = station;
	wind = 100;
	TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100 * 2.453 * 1.069 * 1.5 / 3.6, value("WS603/wind_speed"));
	TEST_ASSERT_EQUAL_DOUBLE(7, value("WS603/direction"));
	TEST_ASSERT_EQUAL_DOUBLE(150, value("WS603/calibration/wind_speed"));
	TEST_ASSERT_EQUAL_DOUBLE(4, value("WS603/LED/model"));
	wind = 50;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_DOUBLE_WITHIN(1e-3, 50 * 2.453 * 1.069 * 1.5 / 3.6, value("WS603/wind_speed"));
	wire_net.used = NULL;
}

static void test_a_ds2437_measures_as_a_ds2438(void)
{
	start("DS2437");
	wire_set(slave, "temperature", 31.5);
	wire_set(slave, "vdd", 4.75);
	wire_set(slave, "vad", 1.5);
	reads("temperature", "        31.5");
	reads("VDD", "        4.75");
	reads("VAD", "         1.5");
	writes("pages/page.3", "abcdefgh");
	go(BUS_READ, "pages/page.3", NULL);
	TEST_ASSERT_EQUAL_MEMORY("abcdefgh", slave_data, 8);
	writes("udate", "100000");
	TEST_ASSERT_DOUBLE_WITHIN(2, 100000, value("udate"));
}

static void test_a_ds2436_measures_and_proves_a_zero(void)
{
	start("DS2436");
	wire_set(slave, "temperature", -10.25);
	wire_set(slave, "volt", 7.43);
	reads("temperature", "      -10.25");
	reads("volts", "        7.43");
	wire_set(slave, "temperature", 0);
	host_run(&host, bus, host.now + HOST_S);
	reads("temperature", "           0");
}

static void test_a_ds2436_counts_cycles(void)
{
	start("DS2436");
	reads("counter/cycles", "           0");
	writes("counter/increment", "1");
	writes("counter/increment", "0");
	writes("counter/increment", "1");
	reads("counter/cycles", "           2");
	writes("counter/reset", "1");
	reads("counter/cycles", "           0");
}

static void test_pages_of_a_ds2436_are_kept_and_the_first_is_locked_again(void)
{
	static const char *const names[] = {"pages/page.0", "pages/page.1", "pages/page.2"};

	start("DS2436");
	for (unsigned i = 0; i < 3; i++) {
		writes(names[i], "abcdefgh");
		TEST_ASSERT_EQUAL_INT(0, put_at(2, names[i], "XY")->err);
		go(BUS_READ, names[i], NULL);
		TEST_ASSERT_EQUAL_UINT(32, host.answer[0].len);
		TEST_ASSERT_EQUAL_MEMORY("abXYefgh", slave_data, 8);
	}
	refuses(-EINVAL, BUS_WRITE, "pages/page.1", "abcdefghi");
	sim_slave_brownout(slave, wire_time());
	go(BUS_READ, "pages/page.0", NULL);
	TEST_ASSERT_EQUAL_MEMORY("abXYefgh", slave_data, 8);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_gauges_read_what_the_chip_measures);
	RUN_TEST(test_currents_are_those_of_a_resistor_of_25_milliohms);
	RUN_TEST(test_a_ds2740_measures_its_resistor);
	RUN_TEST(test_the_accumulated_current_can_be_set);
	RUN_TEST(test_biases_and_settings_are_kept_without_power);
	RUN_TEST(test_a_lock_is_read_and_never_set);
	RUN_TEST(test_what_is_read_of_a_ds2760_leaves_its_protection_as_it_was);
	RUN_TEST(test_a_ds2770_charges_only_where_there_is_a_charger);
	RUN_TEST(test_a_ds2780_tells_its_flags_and_takes_back_what_can_be_cleared);
	RUN_TEST(test_a_ds2781_has_the_flag_active_empty_where_its_data_sheet_has_it);
	RUN_TEST(test_a_pin_conducts_and_is_free);
	RUN_TEST(test_the_alarm_of_a_ds2755_is_a_temperature);
	RUN_TEST(test_thermocouples_follow_the_tables_of_nist);
	RUN_TEST(test_the_hot_end_is_found_by_voltage_and_cold_end);
	RUN_TEST(test_a_ds2760_without_a_weather_station_says_so);
	RUN_TEST(test_a_weather_station_answers_each_time_anew);
	RUN_TEST(test_a_ds2437_measures_as_a_ds2438);
	RUN_TEST(test_a_ds2436_measures_and_proves_a_zero);
	RUN_TEST(test_a_ds2436_counts_cycles);
	RUN_TEST(test_pages_of_a_ds2436_are_kept_and_the_first_is_locked_again);
	return UNITY_END();
}
