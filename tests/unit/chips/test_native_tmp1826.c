/* SPDX-License-Identifier: MIT */
/* What a user writes to a TMP1826 is in the chip, or the write has failed; alerts are not lost. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/chips/tmp1826.h"
#include "tests/unit/aid/native_scene.h"

static struct sim_slave *chip;
static struct sim_tmp1826 *state;
static struct trouble trouble;

static void plug(bool parasite)
{
	native_begin();
	wire_init(&host, 1, 1);
	trouble_none(&trouble);
	wire_net.trouble = &trouble;
	chip = wire_add(0, "TMP1826", 1);
	chip->parasite = parasite;
	state = chip->state;
	wire_set(chip, "temperature", 21.5);
	start();
	expect(true, of(chip, "temperature"), "        21.5");
	forget();
}

void setUp(void)
{
	plug(false);
}

void tearDown(void)
{
	wire_net.sent = NULL;
	wire_net.trouble = NULL;
	native_end();
}

static int set(const char *property, const char *text)
{
	return result(BUS_WRITE, of(chip, property), text);
}

static void power_cycle(void)
{
	sim_slave_brownout(chip, host.now);
	host_run(&host, bus, host.now + HOST_MS);
}

static void test_a_limit_is_in_the_chip_and_outlives_a_loss_of_power(void)
{
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "30.0625"));
	TEST_ASSERT_EQUAL_INT(0, set("templow", "-12.5"));
	TEST_ASSERT_EQUAL_INT(0, set("tempoffset", "0.25"));
	TEST_ASSERT_EQUAL_INT16(481, state->settings[5] | state->settings[6] << 8);
	TEST_ASSERT_EQUAL_INT16(-200, (int16_t)(state->settings[3] | state->settings[4] << 8));
	power_cycle();
	expect(true, of(chip, "temphigh"), "     30.0625");
	expect(true, of(chip, "templow"), "       -12.5");
	expect(true, of(chip, "tempoffset"), "        0.25");
	expect(true, of(chip, "temperature"), "       21.75");
}

static void test_an_offset_makes_no_temperature_that_the_chip_does_not_measure(void)
{
	static const char *const offsets[] = {"1000", "-256", "2047.9", "2030", "129", "-80"};

	for (unsigned i = 0; i < sizeof(offsets) / sizeof(offsets[0]); i++) {
		TEST_ASSERT_EQUAL_INT(0, set("tempoffset", offsets[i]));
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EDOM, result(BUS_READ, of(chip, "temperature"), NULL), offsets[i]);
	}
	TEST_ASSERT_EQUAL_INT(0, set("tempoffset", "0.25"));
	expect(true, of(chip, "temperature"), "       21.75");
}

static void test_the_end_of_12_bits_is_no_temperature(void)
{
	wire_set(chip, "temperature", 127.9375);
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(chip, "temperature"), NULL));
	wire_set(chip, "temperature", 127.875);
	expect(true, of(chip, "temperature"), "     127.875");
	state->settings[0] |= 0x80;
	wire_set(chip, "temperature", 140);
	expect(true, of(chip, "temperature"), "         140");
}

static void test_limits_of_the_precise_format_have_128_steps_a_degree(void)
{
	state->settings[0] |= 0x80;
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "150"));
	TEST_ASSERT_EQUAL_INT16(19200, state->settings[5] | state->settings[6] << 8);
	expect(true, of(chip, "temphigh"), "         150");
	TEST_ASSERT_EQUAL_INT(-EINVAL, set("temphigh", "256"));
	TEST_ASSERT_EQUAL_INT16(19200, state->settings[5] | state->settings[6] << 8);
}

static unsigned copies;

static void count_copies(const uint8_t *bytes, size_t n)
{
	copies += n >= 10 && bytes[0] == 0x55 && (bytes[9] == 0x48 || bytes[9] == 0x55);
}

static void test_the_eeprom_is_written_only_when_the_user_writes_something_new(void)
{
	copies = 0;
	wire_net.sent = count_copies;
	expect(true, of(chip, "temphigh"), "         127");
	expect(true, of(chip, "alert_high"), "0");
	expect(true, of(chip, "temperature"), "        21.5");
	TEST_ASSERT_EQUAL_UINT(0, copies);
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "30"));
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "30"));
	TEST_ASSERT_EQUAL_UINT(1, copies);
	TEST_ASSERT_EQUAL_INT(0, set("memory", "ABCDEFGHIJ"));
	TEST_ASSERT_EQUAL_UINT(3, copies);
	TEST_ASSERT_EQUAL_INT(0, set("memory", "ABCDEFGHIJ"));
	TEST_ASSERT_EQUAL_UINT(3, copies);
}

static void test_a_chip_whose_settings_are_locked_refuses(void)
{
	state->settings[1] |= 0x01;
	TEST_ASSERT_EQUAL_INT(-EIO, set("temphigh", "30"));
	expect(true, of(chip, "temphigh"), "         127");
}

/* No setting but the one that is written has another value after writes on a noisy wire. */
static void test_a_disturbed_write_changes_nothing_else(void)
{
	uint8_t before[SIM_TMP1826_SETTINGS];
	unsigned written = 0;

	memcpy(before, state->settings, sizeof(before));
	for (unsigned round = 0; round < 60; round++) {
		char text[8];
		int16_t want = (int16_t)(20 + round % 50);

		snprintf(text, sizeof(text), "%d", want);
		chip->corrupt_probability = 0.2;
		chip->corrupt_random = round + 1;
		int err = set("temphigh", text);
		chip->corrupt_probability = 0;
		forget();
		if (err)
			TEST_ASSERT_EQUAL_INT(0, set("temphigh", text));
		forget();
		written += !err;
		TEST_ASSERT_EQUAL_INT16(want * 16, state->settings[5] | state->settings[6] << 8);
		TEST_ASSERT_EQUAL_HEX8_ARRAY(before, state->settings, 5);
		TEST_ASSERT_EQUAL_HEX8_ARRAY(before + 7, state->settings + 7, 2);
		TEST_ASSERT_EQUAL_HEX8_ARRAY(state->settings, state->stored, sizeof(before));
	}
	/* 51: most are made again by the bus, and some are too much disturbed for that */
	TEST_ASSERT_UINT_WITHIN(8, 51, written);
}

static void test_alerts_are_kept_until_they_are_cleared(void)
{
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "30"));
	expect(true, of(chip, "alert_high"), "0");
	wire_set(chip, "temperature", 31);
	expect(true, of(chip, "temperature"), "          31");
	wire_set(chip, "temperature", 21.5);
	expect(true, of(chip, "temperature"), "        21.5");
	expect(true, of(chip, "alert_high"), "1");
	expect(true, of(chip, "alert_low"), "0");
	TEST_ASSERT_EQUAL_INT(0, set("alert_high", "0"));
	expect(true, of(chip, "alert_high"), "0");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, set("alert_high", "1"));
	wire_set(chip, "temperature", 30);
	expect(true, of(chip, "alert_high"), "1");
	TEST_ASSERT_EQUAL_INT(0, set("alert_high", "0"));
	expect(true, of(chip, "alert_high"), "1");
}

static void set_off_an_alert(void)
{
	TEST_ASSERT_EQUAL_INT(0, set("temphigh", "30"));
	wire_set(chip, "temperature", 31);
	expect(true, of(chip, "temperature"), "          31");
	wire_set(chip, "temperature", 21.5);
	forget();
}

/* After three wrong checksums it is told anew which chip it is. */
static void lose_what_is_known(void)
{
	chip->corrupt_probability = 1;
	chip->corrupt_random = 1;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, result(BUS_READ, of(chip, "temperature"), NULL));
	chip->corrupt_probability = 0;
	forget();
}

static void test_an_alert_outlives_wrong_checksums_and_a_loss_of_power(void)
{
	set_off_an_alert();
	lose_what_is_known();
	expect(true, of(chip, "alert_high"), "1");
	power_cycle();
	expect(true, of(chip, "alert_high"), "1");
	expect(true, of(chip, "alert_low"), "0");
	TEST_ASSERT_EQUAL_INT(0, set("alert_high", "0"));
	lose_what_is_known();
	expect(true, of(chip, "alert_high"), "0");
}

/* The looks that tell which chip it is clear its alerts. */
static void test_an_alert_is_not_lost_when_it_is_told_which_chip_it_is(void)
{
	lose_what_is_known();
	state->status |= 0x40;
	expect(true, of(chip, "alert_low"), "1");
	expect(true, of(chip, "alert_high"), "0");
}

static void fill(void)
{
	for (unsigned i = 0; i < SIM_TMP1826_MEMORY; i++)
		state->memory[i] = (uint8_t)(i * 7 + 3);
}

static void test_the_memory_is_read_whether_checksums_stand_in_it_or_not(void)
{
	for (unsigned checked = 0; checked < 2; checked++) {
		fill();
		state->checked_blocks = checked;
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);
		const struct bus_answer *answer = answer_to(id);

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_EQUAL_UINT(SIM_TMP1826_MEMORY, answer->len);
		TEST_ASSERT_EQUAL_HEX8_ARRAY(state->memory, data[id], SIM_TMP1826_MEMORY);
		forget();
	}
}

static void test_a_part_of_the_memory_is_written_and_the_rest_of_its_blocks_stays(void)
{
	uint8_t want[SIM_TMP1826_MEMORY];

	for (unsigned parasite = 0; parasite < 2; parasite++) {
		tearDown();
		plug(parasite);
		fill();
		memcpy(want, state->memory, sizeof(want));
		memcpy(want + 13, "twelve bytes", 12);
		write_offset = 13;
		TEST_ASSERT_EQUAL_INT(0, set("memory", "twelve bytes"));
		write_offset = 0;
		TEST_ASSERT_EQUAL_HEX8_ARRAY(want, state->memory, sizeof(want));
	}
}

static void test_a_locked_page_refuses(void)
{
	fill();
	state->locked_pages = 1;
	TEST_ASSERT_EQUAL_INT(-EIO, set("memory", "ABC"));
	TEST_ASSERT_EQUAL_HEX8(3, state->memory[0]);
}

/* What is read on a noisy wire is what is there, or an error. */
static void test_a_noisy_wire_makes_no_false_memory(void)
{
	unsigned good = 0;

	fill();
	chip->corrupt_probability = 0.25;
	chip->corrupt_random = 7;
	for (unsigned round = 0; round < 20; round++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(chip, "memory"), NULL);

		if (answer_to(id)->err == 0) {
			TEST_ASSERT_EQUAL_HEX8_ARRAY(state->memory, data[id], SIM_TMP1826_MEMORY);
			good++;
		}
		forget();
	}
	TEST_ASSERT_UINT_WITHIN(5, 10, good);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_limit_is_in_the_chip_and_outlives_a_loss_of_power);
	RUN_TEST(test_an_offset_makes_no_temperature_that_the_chip_does_not_measure);
	RUN_TEST(test_the_end_of_12_bits_is_no_temperature);
	RUN_TEST(test_limits_of_the_precise_format_have_128_steps_a_degree);
	RUN_TEST(test_the_eeprom_is_written_only_when_the_user_writes_something_new);
	RUN_TEST(test_a_chip_whose_settings_are_locked_refuses);
	RUN_TEST(test_a_disturbed_write_changes_nothing_else);
	RUN_TEST(test_alerts_are_kept_until_they_are_cleared);
	RUN_TEST(test_an_alert_outlives_wrong_checksums_and_a_loss_of_power);
	RUN_TEST(test_an_alert_is_not_lost_when_it_is_told_which_chip_it_is);
	RUN_TEST(test_the_memory_is_read_whether_checksums_stand_in_it_or_not);
	RUN_TEST(test_a_part_of_the_memory_is_written_and_the_rest_of_its_blocks_stays);
	RUN_TEST(test_a_locked_page_refuses);
	RUN_TEST(test_a_noisy_wire_makes_no_false_memory);
	return UNITY_END();
}
