/* SPDX-License-Identifier: MIT */
/*
 * Programs on a microcontroller that play a chip, as OneWireHub's classes do: known by what a chip
 * never does, and read by a weaker proof. The simulated ones were compared with OneWireHub's own
 * (68e93925), compiled with a hub whose slots are those of the simulator's wire: in 11 million
 * slots of random commands, right and wrong ones, both gave the same levels.
 */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/families.h"
#include "tests/unit/aid/one_slave.h"

void setUp(void)
{
	one_slave_begin();
}

void tearDown(void)
{
	one_slave_end();
}

static void plug(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static const char *identity_after(const char *property)
{
	return go(BUS_READ, property, NULL)->identity;
}

static void test_a_switch_that_sends_its_status_once_is_read_and_named(void)
{
	plug("DS2413-EMULATED");
	wire_set(slave, "pin.A", 1);
	wire_set(slave, "pin.B", 0);
	reads("sensed.BYTE", "           1");
	TEST_ASSERT_EQUAL_STRING("emulated: sends its status once", identity_after("sensed.BYTE"));
	wire_set(slave, "pin.B", 1);
	reads("sensed.BYTE", "           3");
	for (unsigned i = 4; i-- > 0;) {
		char text[2] = {(char)('0' + i), 0}, shown[] = "           0";

		writes("PIO.BYTE", text);
		shown[11] = text[0];
		reads("PIO.BYTE", shown);
	}
	writes("PIO.A", "1");
	reads("PIO.BYTE", "           1");
}

static void test_its_first_write_is_sent_and_read_back(void)
{
	plug("DS2413-EMULATED");
	writes("PIO.BYTE", "2");
	reads("PIO.BYTE", "           2");
}

/* So many commands to read the status are answered as by the program, then by the chip. */
static unsigned interrupted;

static void interrupt(const uint8_t *data, size_t n)
{
	if (!n || data[n - 1] != 0xf5)
		return;
	slave->family = sim_family_find(interrupted ? "DS2413-EMULATED" : "DS2413", 0);
	interrupted -= interrupted > 0;
}

/* One that falls silent after a byte, again and again, is interrupted: it is the chip. */
static void test_an_interrupted_chip_is_not_taken_for_a_program(void)
{
	plug("DS2413");
	wire_net.sends = interrupt;
	for (unsigned times = 0; times < 9; times++) {
		interrupted = times;
		TEST_ASSERT_EQUAL_STRING("DS2413", identity_after("sensed.BYTE"));
		TEST_ASSERT_EQUAL_UINT(0, interrupted);
		reads("sensed.BYTE", "           3");
	}
}

static void test_what_shows_the_chips_own_behaviour_is_a_chip_again(void)
{
	plug("DS2413-EMULATED");
	reads("sensed.BYTE", "           3");
	slave->family = sim_family_find("DS2413", 0);
	reads("sensed.BYTE", "           3");
	TEST_ASSERT_EQUAL_STRING("DS2413", identity_after("sensed.BYTE"));
}

static double number(const char *property)
{
	const struct bus_answer *answer = go(BUS_READ, property, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	return answer->number;
}

static void check_monitor(double celsius, double vdd, double vad)
{
	wire_set(slave, "temperature", celsius);
	wire_set(slave, "vdd", vdd);
	wire_set(slave, "vad", vad);
	TEST_ASSERT_DOUBLE_WITHIN(0.04, celsius, number("temperature"));
	TEST_ASSERT_DOUBLE_WITHIN(0.011, vdd, number("VDD"));
	TEST_ASSERT_DOUBLE_WITHIN(0.011, vad, number("VAD"));
	TEST_ASSERT_DOUBLE_WITHIN(0.011, vdd, number("VDD"));
}

static void test_a_monitor_that_shows_no_conversion_is_measured_and_named(void)
{
	static const char *const first[] = {"temperature", "VDD", "VAD", "vis", "pages/page.3"};

	for (unsigned i = 0; i < sizeof(first) / sizeof(first[0]); i++) {
		tearDown();
		setUp();
		plug("DS2438-EMULATED");
		for (unsigned tries = 0; go(BUS_READ, first[i], NULL)->err; tries++)
			TEST_ASSERT_LESS_THAN_UINT_MESSAGE(2, tries, first[i]);
		check_monitor(24.5, 5, 1.5);
		check_monitor(-3, 4.2, 0);
		check_monitor(0, 3, 2);
		TEST_ASSERT_EQUAL_STRING("emulated: shows no conversion",
		                         identity_after("temperature"));
	}
}

static void test_what_is_written_to_it_is_read_back(void)
{
	plug("DS2438-EMULATED");
	check_monitor(20, 5, 1);
	writes("pages/page.3", "ABCDEFGH");
	TEST_ASSERT_EQUAL_UINT(8, go(BUS_READ, "pages/page.3", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY("ABCDEFGH", slave_data, 8);
	check_monitor(21, 5, 1);
}

static void test_to_find_out_changes_no_byte_of_it(void)
{
	size_t size;

	plug("DS2438-EMULATED");
	uint8_t *page = sim_slave_memory(slave, &size) + 64 + 3 * 8, before[8];

	memcpy(page, "12345678", 8);
	memcpy(before, page, 8);
	for (unsigned i = 0; i < 3; i++)
		go(BUS_READ, "pages/page.3", NULL);
	TEST_ASSERT_EQUAL_MEMORY(before, page, 8);
	TEST_ASSERT_EQUAL_UINT(8, go(BUS_READ, "pages/page.3", NULL)->len);
	TEST_ASSERT_EQUAL_MEMORY(before, slave_data, 8);
}

/* Once it has shown a conversion or a recall it is a chip, whatever is lost then. */
static void test_a_monitor_that_has_shown_a_conversion_is_a_chip(void)
{
	plug("DS2438");
	check_monitor(20, 5, 1);
	slave->family = sim_family_find("DS2438-EMULATED", 0);
	for (unsigned i = 0; i < 8; i++)
		TEST_ASSERT_NOT_EQUAL_INT(0, go(BUS_READ, "temperature", NULL)->err);
	slave->family = sim_family_find("DS2438", 0);
	check_monitor(22, 5, 1);
	TEST_ASSERT_EQUAL_STRING("DS2438", identity_after("temperature"));
}

static void test_a_program_that_shows_a_conversion_is_a_chip_again(void)
{
	plug("DS2438-EMULATED");
	check_monitor(20, 5, 1);
	slave->family = sim_family_find("DS2438", 0);
	go(BUS_READ, "temperature", NULL);
	check_monitor(22, 5, 1);
	TEST_ASSERT_EQUAL_STRING("DS2438", identity_after("temperature"));
}

/* So many commands to convert are heard, then so many are lost. */
static unsigned heard, lost;
static struct trouble trouble;

static void lose(const uint8_t *data, size_t n)
{
	if (n == 0 || data[n - 1] != 0xb4)
		return;
	trouble_none(&trouble);
	if (heard > 0) {
		heard--;
	} else if (lost > 0) {
		lost--;
		trouble.kind = TROUBLE_DEAF;
	}
}

static void test_a_monitor_that_missed_a_conversion_shows_no_other_voltage(void)
{
	plug("DS2438-EMULATED");
	check_monitor(20, 5, 1);
	wire_net.trouble = &trouble;
	wire_net.sends = lose;
	for (unsigned place = 0; place < 6; place++) {
		heard = place % 3;
		lost = 1 + place / 3;
		TEST_ASSERT_DOUBLE_WITHIN(0.011, 1, number("VAD"));
		heard = place % 3;
		lost = 1 + place / 3;
		TEST_ASSERT_DOUBLE_WITHIN(0.011, 5, number("VDD"));
	}
}

/* A chip's busy flags are read-only; a program keeps them as they were written, or disturbed. */
static void test_a_monitor_with_a_busy_flag_in_its_memory_is_measured(void)
{
	size_t size;

	plug("DS2438-EMULATED");
	check_monitor(20, 5, 1);
	sim_slave_memory(slave, &size)[64] |= 0x10;
	TEST_ASSERT_DOUBLE_WITHIN(0.04, 20, number("temperature"));
	check_monitor(21, 4, 2);
}

/* One that has failed often has one try in a request. */
static void test_a_monitor_is_read_again_after_a_time_of_noise(void)
{
	plug("DS2438-EMULATED");
	check_monitor(20, 5, 1);
	trouble_none(&trouble);
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.001;
	trouble.random = 1;
	wire_net.trouble = &trouble;
	for (unsigned i = 0; i < 1000; i++)
		go(BUS_READ, "VAD", NULL);
	wire_net.trouble = NULL;
	for (unsigned i = 0; go(BUS_READ, "temperature", NULL)->err; i++)
		TEST_ASSERT_LESS_THAN_UINT(4, i);
	check_monitor(21, 4, 2);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_switch_that_sends_its_status_once_is_read_and_named);
	RUN_TEST(test_its_first_write_is_sent_and_read_back);
	RUN_TEST(test_an_interrupted_chip_is_not_taken_for_a_program);
	RUN_TEST(test_what_shows_the_chips_own_behaviour_is_a_chip_again);
	RUN_TEST(test_a_monitor_that_shows_no_conversion_is_measured_and_named);
	RUN_TEST(test_what_is_written_to_it_is_read_back);
	RUN_TEST(test_to_find_out_changes_no_byte_of_it);
	RUN_TEST(test_a_monitor_that_has_shown_a_conversion_is_a_chip);
	RUN_TEST(test_a_program_that_shows_a_conversion_is_a_chip_again);
	RUN_TEST(test_a_monitor_that_missed_a_conversion_shows_no_other_voltage);
	RUN_TEST(test_a_monitor_with_a_busy_flag_in_its_memory_is_measured);
	RUN_TEST(test_a_monitor_is_read_again_after_a_time_of_noise);
	return UNITY_END();
}
