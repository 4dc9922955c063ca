/* SPDX-License-Identifier: MIT */
/*
 * What a thermometer's setting takes to the EEPROM: itself, and nothing else that happens to be in
 * the scratchpad. Limits that a program which was killed has left there, or the resolution of a
 * conversion, are not made lasting.
 */
#include <errno.h>
#include <string.h>

#include "hal/sim/chips/thermometer.h"
#include "unity.h"

#include "tests/unit/aid/native_scene.h"

static struct sim_slave *slave;
static unsigned recalls, lost;

void setUp(void)
{
	native_begin();
	recalls = lost = 0;
}

void tearDown(void)
{
	native_end();
}

static struct sim_thermometer *sim(void)
{
	return slave->state;
}

static void begin(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	wire_set(slave, "temperature", 20.3125);
}

/* As it is found after the end of a program that set them. */
static void leave(int high, int low, unsigned bits)
{
	sim()->scratchpad[2] = (uint8_t)high;
	sim()->scratchpad[3] = (uint8_t)low;
	if (slave->family->code == 0x28)
		sim()->scratchpad[4] = (uint8_t)((bits - 9) << 5 | 0x1f);
}

static void expect_eeprom(int high, int low, unsigned bits)
{
	TEST_ASSERT_EQUAL_INT(high, (int8_t)sim()->eeprom[0]);
	TEST_ASSERT_EQUAL_INT(low, (int8_t)sim()->eeprom[1]);
	if (slave->family->code == 0x28)
		TEST_ASSERT_EQUAL_HEX8((bits - 9) << 5 | 0x1f, sim()->eeprom[2]);
	TEST_ASSERT_EQUAL_MEMORY(sim()->eeprom, sim()->scratchpad + 2, 2);
}

static void look_at_each(const char *chip)
{
	static const struct {
		const char *property, *text;
		int high, low;
		unsigned bits;
	} writes[] = {{"temphigh", "30", 30, 70, 12},
	              {"templow", "10", 75, 10, 12},
	              {"tempres", "10", 75, 70, 10}};

	for (unsigned i = 0; i < (strcmp(chip, "DS18B20") == 0 ? 3 : 2); i++) {
		tearDown();
		setUp();
		begin(chip);
		leave(21, 19, 9);
		start();
		TEST_ASSERT_EQUAL_INT(
			0, result(BUS_WRITE, of(slave, writes[i].property), writes[i].text));
		expect_eeprom(writes[i].high, writes[i].low, writes[i].bits);
	}
}

static void test_what_was_left_in_the_scratchpad_does_not_become_lasting(void)
{
	look_at_each("DS18B20");
	look_at_each("DS18S20");
}

/* It is in force already, but would be gone with the chip's supply. */
static void test_a_limit_that_only_the_scratchpad_has_is_stored(void)
{
	begin("DS18B20");
	leave(30, 19, 9);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	expect_eeprom(30, 70, 12);
}

/* What the EEPROM has is not written again. */
static void count_copies(const uint8_t *bytes, size_t n)
{
	recalls += n >= 10 && bytes[9] == 0xb8;
	lost += n >= 10 && bytes[9] == 0x48;
}

static void test_what_the_eeprom_has_is_not_copied_again(void)
{
	begin("DS18B20");
	leave(21, 19, 9);
	start();
	wire_net.sent = count_copies;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "75"));
	TEST_ASSERT_EQUAL_UINT(0, lost);
	TEST_ASSERT_GREATER_THAN_UINT(0, recalls);
	expect_eeprom(75, 70, 12);
}

/* The mark of a lost Convert T is 9 bits in the scratchpad for a while. */
static void test_the_mark_of_a_thermometer_fed_by_the_wire_does_not_become_lasting(void)
{
	unsigned marked = 0;

	for (unsigned ms = 0; ms < 2000; ms += 37) {
		tearDown();
		setUp();
		begin("DS18B20");
		slave->parasite = true;
		start();
		expect(true, of(slave, "temperature"), "     20.3125");
		uint32_t reading = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
		host_run(&host, bus, host.now + ms * HOST_MS);
		marked += sim()->scratchpad[4] == 0x1f;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
		expect_eeprom(30, 70, 12);
		answer_to(reading);
	}
	TEST_ASSERT_GREATER_THAN_UINT(0, marked);
}

/* Nothing shows what its EEPROM has: no setting of it is written on a guess. */
static void test_a_chip_that_knows_no_recall_keeps_what_it_had(void)
{
	begin("DS18B20");
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, "recall", 0));
	leave(21, 19, 12);
	start();
	wire_net.sent = count_copies;
	for (unsigned i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL_INT(-EIO, result(BUS_WRITE, of(slave, "temphigh"), "30"));
		TEST_ASSERT_EQUAL_INT8(21, sim()->scratchpad[2]);
		TEST_ASSERT_EQUAL_INT8(19, sim()->scratchpad[3]);
	}
	TEST_ASSERT_EQUAL_UINT(0, lost);
	TEST_ASSERT_EQUAL_INT8(75, sim()->eeprom[0]);
	TEST_ASSERT_EQUAL_INT8(70, sim()->eeprom[1]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_was_left_in_the_scratchpad_does_not_become_lasting);
	RUN_TEST(test_a_limit_that_only_the_scratchpad_has_is_stored);
	RUN_TEST(test_what_the_eeprom_has_is_not_copied_again);
	RUN_TEST(test_the_mark_of_a_thermometer_fed_by_the_wire_does_not_become_lasting);
	RUN_TEST(test_a_chip_that_knows_no_recall_keeps_what_it_had);
	return UNITY_END();
}
