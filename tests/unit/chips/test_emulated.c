/* SPDX-License-Identifier: MIT */
/*
 * Programs on a microcontroller that play a chip, as OneWireHub's classes do: known by what a chip
 * never does, and read by a weaker proof. The simulated ones were written from what DS2413.cpp of
 * OneWireHub sends, bit for bit.
 */
#include <errno.h>

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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_switch_that_sends_its_status_once_is_read_and_named);
	RUN_TEST(test_its_first_write_is_sent_and_read_back);
	RUN_TEST(test_an_interrupted_chip_is_not_taken_for_a_program);
	RUN_TEST(test_what_shows_the_chips_own_behaviour_is_a_chip_again);
	return UNITY_END();
}
