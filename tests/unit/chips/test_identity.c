/* SPDX-License-Identifier: MIT */
/*
 * Chips that share a family code: each is told by its behaviour before its first value, gets its
 * own properties, and no trouble meanwhile takes one for another. Nothing is sent to a chip before
 * it is known but what all candidates have as a reading.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/native/state.h"
#include "hal/owfs/path.h"
#include "hal/sim/chips/tmp1826.h"
#include "tests/unit/aid/visit.h"

static struct sim_slave *battery, *warm;
static unsigned wrong, commands;
static bool known; /* more may be sent than what all have as a reading */

static void forget_kind(const struct sim_slave *slave)
{
	struct device *device = device_find(&((struct native *)bus)->table, slave->rom);

	TEST_ASSERT_NOT_NULL(device);
	family_forget(device);
}

/* To a TMP1826 Read Scratchpad and Convert T, and nothing else, ever. */
static void look_at_commands(const uint8_t *bytes, size_t n)
{
	if (n < 10 || bytes[0] != 0x55 || bytes[1] != 0x26)
		return;
	bool to_warm = warm && memcmp(bytes + 1, warm->rom, 8) == 0;

	commands++;
	wrong += bytes[9] != 0xbe && !(to_warm ? bytes[9] == 0x44 : known);
}

static void plug(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	trouble_none(&trouble);
	wire_net.trouble = &trouble;
	battery = wire_add(0, "DS2438", 1);
	warm = wire_add(0, "TMP1826", 2);
	wire_set(battery, "temperature", 20.25);
	wire_set(battery, "vdd", 5.25);
	wire_set(warm, "temperature", -10.0625);
}

void setUp(void)
{
	wrong = commands = 0;
	known = false;
	plug();
}

void tearDown(void)
{
	wire_net.sent = NULL;
	wire_net.trouble = NULL;
	native_end();
}

static int read_error(const struct sim_slave *slave, const char *property)
{
	return result(BUS_READ, of(slave, property), NULL);
}

static void test_each_of_a_ds2438_and_a_tmp1826_on_a_wire_gets_its_own_values(void)
{
	start();
	expect(true, of(warm, "temperature"), "    -10.0625");
	expect(true, of(battery, "temperature"), "       20.25");
	expect(true, of(battery, "VDD"), "        5.25");
	expect(true, of(warm, "identity"), "TMP1826");
	expect(true, of(battery, "identity"), "DS2438");
	expect(true, of(warm, "type"), "TMP1826");
	expect(true, of(battery, "type"), "DS2438");
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(warm, "VDD"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(warm, "pages/page.3"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(battery, "temphigh"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(battery, "power"));
	expect(true, of(warm, "present"), "1");
	expect(true, of(warm, "power"), "1");
	wire_set(warm, "temperature", 99.5);
	expect(true, of(warm, "temperature"), "        99.5");
}

static void test_what_is_first_asked_of_a_chip_may_be_what_only_the_other_has(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(warm, "VAD"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(battery, "templow"));
	forget_kind(warm);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(warm, "pages/page.3"), "abc"));
	forget_kind(warm);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(warm, "IAD"), "0"));
}

static void test_both_formats_of_a_tmp1826_and_its_limits_are_as_its_data_sheet_says(void)
{
	static const uint8_t limits[] = {0x80, 0xfb, 0x08, 0x05}; /* -72/16 and 1288/16 */
	struct sim_tmp1826 *state = warm->state;

	memcpy(state->settings + 3, limits, 4);
	start();
	expect(true, of(warm, "tempres"), "          12");
	expect(true, of(warm, "templow"), "         -72");
	expect(true, of(warm, "temphigh"), "        80.5");
	state->settings[0] |= 0x80;
	wire_set(warm, "temperature", 25.0078125);
	expect(true, of(warm, "tempres"), "          16");
	expect(true, of(warm, "temperature"), "     25.0078");
	expect(true, of(warm, "templow"), "          -9");
	state->settings[0] |= 0x08; /* the mean of eight */
	wire_set(warm, "temperature", 26);
	expect(true, of(warm, "temperature"), "          26");
}

static void test_before_a_chip_is_known_it_is_sent_what_is_a_reading_for_all(void)
{
	wire_net.sent = look_at_commands;
	start();
	expect(true, of(battery, "identity"), "DS2438");
	expect(true, of(warm, "temperature"), "    -10.0625");
	expect(true, of(warm, "temphigh"), "         127");
	expect(true, of(warm, "identity"), "TMP1826");
	TEST_ASSERT_GREATER_THAN_UINT(6, commands);
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	known = true;
	expect(true, of(battery, "VDD"), "        5.25");
	expect(true, of(warm, "temperature"), "    -10.0625");
	TEST_ASSERT_EQUAL_UINT(0, wrong);
}

/* Where the checksum of a DS2438's page would stand it may fit by chance. */
static void test_a_checksum_that_fits_by_chance_makes_no_ds2438_of_a_tmp1826(void)
{
	struct sim_tmp1826 *state = warm->state;
	unsigned low = 0;
	uint8_t sent[9];

	start();
	expect(true, of(warm, "temperature"), "    -10.0625");
	expect(true, of(warm, "temphigh"), "         127");
	do {
		TEST_ASSERT_LESS_THAN_UINT(256, low);
		state->settings[3] = (uint8_t)low++;
		sent[8] = state->settings[3];
		memcpy(sent, state->sent + 1, 8);
	} while (rom_crc8(sent, 9));
	forget_kind(warm);
	expect(true, of(warm, "identity"), "TMP1826");
	expect(true, of(warm, "temperature"), "    -10.0625");
}

/* With no trouble, and how many slots and resets that takes. */
static void count(const struct sim_slave *slave, const char *property, char truth[24])
{
	start();
	trouble_none(&trouble);
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, property), NULL);

	truth[0] = '\0';
	if (!answer_to(id)->err)
		snprintf(truth, 24, "%s", (char *)data[id]);
}

static void try(unsigned which, const char *property, struct trouble what, const char *truth)
{
	native_end();
	plug();
	start();
	const struct sim_slave *slave = which ? warm : battery;
	char text[200];

	trouble_none(&trouble);
	trouble.kind = what.kind;
	trouble.at = what.at;
	trouble.mask = what.mask;
	for (unsigned again = 0; again < 2; again++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, property), NULL);
		int err = answer_to(id)->err;

		trouble.kind = TROUBLE_NONE;
		if (err ? !again || !truth[0] : strcmp((char *)data[id], truth) == 0)
			continue;
		snprintf(text, sizeof(text), "%s: kind %d at %u, mask %02X: %d, '%s' for '%s'",
		         property, what.kind, (unsigned)what.at, what.mask, err, (char *)data[id],
		         truth);
		TEST_MESSAGE(text);
		wrong++;
	}
}

/* The trouble hits the first visit of all, in which the chip is told. */
static void test_no_trouble_takes_one_for_the_other(void)
{
	static const char *const properties[] = {"temperature", "identity", "VDD", "temphigh"};
	static const uint8_t masks[] = {0xff, 0x24, 0x42, 0x55};
	unsigned tried = 0;

	for (unsigned which = 0; which < 2; which++)
		for (unsigned p = 0; p < 4; p++) {
			char truth[24];

			native_end();
			plug();
			count(which ? warm : battery, properties[p], truth);
			uint32_t slots = trouble.slots, resets = trouble.resets;
			for (uint32_t at = 0; at < slots; at++, tried++)
				try(which, properties[p],
				    (struct trouble){.kind = TROUBLE_TURN, .at = at, .mask = 1},
				    truth);
			for (uint32_t at = 0; at < slots; at += 8, tried += 2) {
				try(which, properties[p],
				    (struct trouble){.kind = TROUBLE_DEAF, .at = at}, truth);
				try(which, properties[p],
				    (struct trouble){.kind = TROUBLE_TURN,
				                     .at = at,
				                     .mask = masks[at / 8 % 4]},
				    truth);
			}
			for (uint32_t at = 0; at < resets; at++, tried++)
				try(which, properties[p],
				    (struct trouble){.kind = TROUBLE_ABSENT, .at = at}, truth);
		}
	TEST_ASSERT_GREATER_THAN_UINT(4000, tried);
	TEST_ASSERT_EQUAL_UINT(0, wrong);
}

/* Four bits in a thousand are turned over, and each visit begins with a chip that is not known. */
static void test_noise_takes_none_for_another(void)
{
	unsigned good = 0;

	start();
	expect(true, of(warm, "identity"), "TMP1826");
	expect(true, of(battery, "identity"), "DS2438");
	trouble_none(&trouble);
	trouble.random = 20261;
	trouble.probability = 0.004;
	for (unsigned i = 0; i < 1500; i++, forget()) {
		struct sim_slave *slave = i % 2 ? warm : battery;

		forget_kind(slave);
		trouble.kind = TROUBLE_NOISE;
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "identity"), NULL);
		if (answer_to(id)->err)
			continue;
		good++;
		if (strcmp((char *)data[id], i % 2 ? "TMP1826" : "DS2438") == 0)
			continue;
		TEST_MESSAGE((char *)data[id]);
		wrong++;
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(100, good);
}

/* Nobody notices that it was away, and its id is the same. */
static void swap(struct sim_slave *out, struct sim_slave *in, const char *value)
{
	bool good = false;

	in->plugged = true;
	out->plugged = false;
	for (unsigned i = 0; i < 6; i++, forget()) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(in, "temperature"), NULL);

		good = !answer_to(id)->err;
		if (good)
			TEST_ASSERT_EQUAL_STRING(value, (char *)data[id]);
	}
	TEST_ASSERT_TRUE_MESSAGE(good, value);
}

static void test_a_chip_that_takes_the_place_of_another_is_told_anew(void)
{
	memcpy(warm->rom, battery->rom, sizeof(warm->rom));
	warm->plugged = false;
	start();
	expect(true, of(battery, "temperature"), "       20.25");
	swap(battery, warm, "    -10.0625");
	expect(true, of(warm, "identity"), "TMP1826");
	swap(warm, battery, "       20.25");
	expect(true, of(warm, "identity"), "DS2438");
}

static void test_a_chip_that_is_neither_is_unknown_and_has_no_value(void)
{
	struct sim_slave *other = wire_add(0, "DS18B20", 3);

	other->rom[0] = 0x26;
	other->rom[7] = rom_crc8(other->rom, 7);
	wire_net.sent = look_at_commands;
	start();
	TEST_ASSERT_EQUAL_INT(-EIO, read_error(other, "temperature"));
	TEST_ASSERT_EQUAL_INT(-EIO, read_error(other, "VDD"));
	expect(true, of(other, "identity"), "unknown");
	TEST_ASSERT_GREATER_THAN_UINT(2, commands);
	TEST_ASSERT_EQUAL_UINT(0, wrong);
}

/* Three looks in a row may have been disturbed alike: it is told anew a second later. */
static void test_a_chip_that_was_once_taken_for_neither_gets_its_values_later(void)
{
	struct sim_slave *other = wire_add(0, "DS18B20", 3);

	memcpy(other->rom, battery->rom, sizeof(other->rom));
	battery->plugged = false;
	start();
	TEST_ASSERT_EQUAL_INT(-EIO, read_error(battery, "temperature"));
	expect(true, of(battery, "identity"), "unknown");
	battery->plugged = true;
	other->plugged = false;
	TEST_ASSERT_EQUAL_INT(-EIO, read_error(battery, "temperature"));
	host_run(&host, bus, host.now + 1100 * HOST_MS);
	expect(true, of(battery, "temperature"), "       20.25");
	expect(true, of(battery, "identity"), "DS2438");
}

/* --- Clones of the DS18B20 --- */

static struct sim_slave *plug_clone(const char *chip, const uint8_t id[6])
{
	native_end();
	native_begin();
	wire_init(&host, 1, 1);
	warm = NULL;
	struct sim_slave *slave = wire_add(0, chip, 1);
	memcpy(slave->rom + 1, id, 6);
	slave->rom[7] = rom_crc8(slave->rom, 7);
	return slave;
}

/* Ids as in the catalogue. */
static const struct {
	const char *chip, *name;
	uint8_t id[6];
} clones[] = {
	{"DS18B20", "DS18B20", {0xca, 0xd6, 0x10, 0x10, 0, 0}},
	{"DS18B20-A2", "DS18B20 clone, family A2", {0x19, 0, 0, 0xb7, 0x5b, 0}},
	{"DS18B20-A3", "DS18B20 clone, family A3", {0x06, 0x64, 0x2b, 0, 0, 0}},
	{"DS18B20-B1", "DS18B20 clone, family B1", {0xaa, 0x3c, 0x61, 0x55, 0x14, 0x01}},
	{"DS18B20-B1v2", "DS18B20 clone, family B1v2 or H", {0x0d, 0x72, 0x9a, 0x20, 0x23, 0x07}},
	{"DS18B20-B2", "DS18B20 clone, family B2", {0xff, 0x7c, 0x5a, 0x61, 0x16, 0x04}},
	{"DS18B20-C", "DS18B20 clone, family C", {0xff, 0x64, 0x1d, 0xcd, 0x96, 0xf2}},
	{"DS18B20-D1", "DS18B20 clone, family D1", {0xb8, 0x0e, 0x77, 0x91, 0x0e, 0x02}},
	{"DS18B20-D2", "DS18B20 clone, family D2", {0xfd, 0x58, 0x94, 0x97, 0x14, 0x03}},
	{"DS18B20-E", "DS18B20 clone, family E", {0x00, 0x74, 0x28, 0x59, 0x43, 0x0f}},
	{"DS18B20-G", "DS18B20 clone, family G", {0xc7, 0x9e, 0xa3, 0x59, 0x83, 0xd9}},
	{"DS18B20-H", "DS18B20 clone, family H", {0x0c, 0x80, 0x53, 0x5c, 0xaa, 0x8e}},
};
#define CLONES (sizeof(clones) / sizeof(clones[0]))

static void test_each_kind_of_clone_is_called_by_its_name(void)
{
	for (unsigned i = 0; i < CLONES; i++) {
		struct sim_slave *slave = plug_clone(clones[i].chip, clones[i].id);

		wire_set(slave, "temperature", 21.4375);
		start();
		expect(true, of(slave, "identity"), clones[i].name);
		expect(true, of(slave, "type"), "DS18B20");
		/* Here nothing tells them apart but the id. */
		wire_set(slave, "temperature", 21.25);
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "identity"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING_LEN(clones[i].name, (char *)data[id], strlen("DS18B20"));
	}
}

/* At no resolution an old result is taken for a new one, however long a clone converts. */
static void test_no_clone_is_read_before_its_conversion_is_over(void)
{
	static const char *const properties[] = {"temperature12", "temperature9", "temperature10",
	                                         "temperature11", "fasttemp",     "temperature"};

	for (unsigned i = 0; i < CLONES; i++) {
		struct sim_slave *slave = plug_clone(clones[i].chip, clones[i].id);

		start();
		for (unsigned round = 0; round < 12; round++) {
			const char *property = properties[round % 6];
			char text[16];

			wire_set(slave, "temperature", 21.5 + round);
			snprintf(text, sizeof(text), "%12G", 21.5 + round);
			uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, property), NULL);
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, clones[i].chip);
			TEST_ASSERT_EQUAL_STRING_MESSAGE(text, (char *)data[id], clones[i].chip);
		}
	}
}

/* Family F holds no slot low, so nothing shows that it converts. */
static void test_a_clone_that_shows_nothing_of_its_conversion_gives_no_value(void)
{
	static const uint8_t id[] = {0x03, 0x60, 0, 0, 0x01, 0x24};
	struct sim_slave *slave = plug_clone("DS18B20-F", id);

	start();
	TEST_ASSERT_EQUAL_INT(-EBADE, read_error(slave, "temperature"));
	TEST_ASSERT_EQUAL_INT(-EBADE, read_error(slave, "identity"));
}

/* The scratchpad of family E is after a restart as if 85 degrees had been measured. */
static void test_what_a_restart_leaves_in_a_clone_is_no_reading(void)
{
	for (unsigned i = 0; i < CLONES; i++) {
		struct sim_slave *slave = plug_clone(clones[i].chip, clones[i].id);

		wire_set(slave, "temperature", 21.4375);
		start();
		expect(true, of(slave, "temperature"), "     21.4375");
		host_run(&host, bus, host.now + HOST_S);
		sim_slave_brownout(slave, wire_time());
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "latesttemp"), NULL);
		if (answer_to(id)->err)
			continue;
		/* One that keeps the last reading over it, or reads 25 degrees then. */
		TEST_ASSERT_NOT_NULL_MESSAGE(strpbrk(clones[i].chip + 7, "DGH"), clones[i].chip);
	}
}

/* --- Family 3B --- */

static void test_each_chip_of_family_3b_gets_its_own_values(void)
{
	static const char *const chips[] = {"DS1825", "MAX31825", "MAX31826", "MAX31850"};
	struct sim_slave *slave[4];
	char text[16];

	for (unsigned i = 0; i < 4; i++) {
		slave[i] = wire_add(0, chips[i], 10 + i);
		wire_set(slave[i], "temperature", -20.0625 - i);
	}
	TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave[1], "address", 0x2a));
	start();
	for (unsigned i = 0; i < 4; i++) {
		snprintf(text, sizeof(text), "%12G", -20.0625 - i);
		expect(true, of(slave[i], "temperature"), text);
		expect(true, of(slave[i], "identity"), chips[i]);
		expect(true, of(slave[i], "latesttemp"), text);
	}
	expect(true, of(slave[1], "prog_addr"), "          42");
	expect(true, of(slave[1], "tempres"), "          12");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, result(BUS_WRITE, of(slave[1], "tempres"), "9"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(slave[1], "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, read_error(slave[1], "power"));
	TEST_ASSERT_EQUAL_INT(-ENOENT, read_error(slave[1], "temperature9"));
}

static void test_a_zero_of_a_max31825_is_good_near_another_reading(void)
{
	struct sim_slave *slave = wire_add(0, "MAX31825", 10);

	wire_set(slave, "temperature", 0);
	start();
	TEST_ASSERT_EQUAL_INT(-ERANGE, read_error(slave, "temperature"));
	wire_set(slave, "temperature", 30);
	expect(true, of(slave, "temperature"), "          30");
	sim_slave_brownout(slave, wire_time());
	TEST_ASSERT_EQUAL_INT(-ERANGE, read_error(slave, "latesttemp"));
	wire_set(slave, "temperature", 2);
	expect(true, of(slave, "temperature"), "           2");
	wire_set(slave, "temperature", 0);
	expect(true, of(slave, "temperature"), "           0");
}

/* One that has the id of another is told by each of its readings. */
static void test_a_chip_of_family_3b_that_takes_the_place_of_another_is_told_anew(void)
{
	struct sim_slave *max = wire_add(0, "MAX31825", 10), *old = wire_add(0, "DS1825", 10);

	wire_set(old, "temperature", 20.25);
	wire_set(max, "temperature", -10.0625);
	max->plugged = false;
	start();
	expect(true, of(old, "temperature"), "       20.25");
	swap(old, max, "    -10.0625");
	expect(true, of(max, "identity"), "MAX31825");
	swap(max, old, "       20.25");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_of_a_ds2438_and_a_tmp1826_on_a_wire_gets_its_own_values);
	RUN_TEST(test_what_is_first_asked_of_a_chip_may_be_what_only_the_other_has);
	RUN_TEST(test_both_formats_of_a_tmp1826_and_its_limits_are_as_its_data_sheet_says);
	RUN_TEST(test_before_a_chip_is_known_it_is_sent_what_is_a_reading_for_all);
	RUN_TEST(test_a_checksum_that_fits_by_chance_makes_no_ds2438_of_a_tmp1826);
	RUN_TEST(test_no_trouble_takes_one_for_the_other);
	RUN_TEST(test_noise_takes_none_for_another);
	RUN_TEST(test_a_chip_that_takes_the_place_of_another_is_told_anew);
	RUN_TEST(test_a_chip_that_is_neither_is_unknown_and_has_no_value);
	RUN_TEST(test_a_chip_that_was_once_taken_for_neither_gets_its_values_later);
	RUN_TEST(test_each_kind_of_clone_is_called_by_its_name);
	RUN_TEST(test_no_clone_is_read_before_its_conversion_is_over);
	RUN_TEST(test_a_clone_that_shows_nothing_of_its_conversion_gives_no_value);
	RUN_TEST(test_what_a_restart_leaves_in_a_clone_is_no_reading);
	RUN_TEST(test_each_chip_of_family_3b_gets_its_own_values);
	RUN_TEST(test_a_zero_of_a_max31825_is_good_near_another_reading);
	RUN_TEST(test_a_chip_of_family_3b_that_takes_the_place_of_another_is_told_anew);
	return UNITY_END();
}
