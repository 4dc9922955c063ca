/* SPDX-License-Identifier: MIT */
/* Family 3B: what is read of a DS1825, a MAX31826 and a MAX31850 is what their data sheets say. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/chips/thermometer.h"
#include "tests/unit/aid/native_scene.h"

#define MEMORY SIM_MAX_MEMORY
#define PAGE SIM_MAX_PAGE

static struct sim_slave *slave;
static struct sim_max *part; /* of a MAX31826, MAX31850 */
static uint8_t *scratchpad;
static unsigned writes; /* of the scratchpad */

static void count_writes(const uint8_t *bytes, size_t n)
{
	writes += n && memchr(bytes, 0x4e, n) != NULL;
}

/* A part that has just got power; of a DS1825 the option comes first. */
static void plug_with(const char *chip, const char *option, double value)
{
	native_end();
	native_begin();
	wire_init(&host, 1, 1);
	wire_net.sent = count_writes;
	writes = 0;
	slave = wire_add(0, chip, 1);
	if (option)
		TEST_ASSERT_EQUAL_INT(0, sim_slave_option(slave, option, value));
	sim_slave_power_on(slave, wire_time());
	part = slave->state;
	scratchpad = part->scratchpad;
	if (strcmp(chip, "DS1825") == 0)
		scratchpad = ((struct sim_thermometer *)slave->state)->scratchpad;
	for (unsigned i = 0; strcmp(chip, "MAX31826") == 0 && i < MEMORY; i++)
		part->memory[i] = (uint8_t)(i * 7);
}

static void plug(const char *chip)
{
	plug_with(chip, NULL, 0);
	start();
}

static void expect_raw(unsigned raw, unsigned at)
{
	TEST_ASSERT_EQUAL_HEX16(raw, scratchpad[at] | scratchpad[at + 1] << 8);
}

/* What it seems to have measured before. */
static void put_raw(unsigned raw, unsigned at)
{
	scratchpad[at] = (uint8_t)raw;
	scratchpad[at + 1] = (uint8_t)(raw >> 8);
}

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static const char *as_number(double value)
{
	static char text[16];

	snprintf(text, sizeof(text), "%12G", value);
	return text;
}

static void expect_number(const char *property, double value)
{
	expect(true, of(slave, property), as_number(value));
}

/* DS1825 and MAX31826, "Temperature/Data Relationship". */
static const struct {
	double celsius;
	unsigned raw;
} table[] = {
	{125, 0x07d0},  {25.0625, 0x0191}, {10.125, 0x00a2},   {0.5, 0x0008}, {0, 0x0000},
	{-0.5, 0xfff8}, {-10.125, 0xff5e}, {-25.0625, 0xfe6f}, {-55, 0xfc90},
};
#define TABLE (sizeof(table) / sizeof(table[0]))

static void test_a_ds1825_measures_as_its_table_says(void)
{
	plug("DS1825");
	for (size_t i = 0; i < TABLE; i++) {
		wire_set(slave, "temperature", table[i].celsius);
		expect(true, of(slave, "temperature"), as_number(table[i].celsius));
		expect_raw(table[i].raw, 0);
		expect(true, of(slave, "latesttemp"), as_number(table[i].celsius));
		forget();
	}
	expect(true, of(slave, "type"), "DS1825");
	expect_number("temphigh", 75);
	expect_number("templow", 70);
	expect(true, of(slave, "power"), "1");
}

static void test_a_ds1825_tells_its_address_pins_and_resolution(void)
{
	/* 0 R1 R0 1 AD3 AD2 AD1 AD0 */
	for (unsigned i = 0; i < 16; i++) {
		unsigned resolution = i % 4;

		plug_with("DS1825", "address", i);
		sim_slave_option(slave, "resolution", 9 + resolution);
		sim_slave_power_on(slave, wire_time());
		start();
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
		put_raw(0x0191, 0);
		TEST_ASSERT_EQUAL_HEX8(0x10 | resolution << 5 | i, scratchpad[4]);
		expect_number("prog_addr", i);
		expect_number("tempres", 9 + resolution);
		/* undefined bits of a coarser reading count as 0 */
		expect(true, of(slave, "latesttemp"),
		       as_number((0x191 & ~((1 << (3 - resolution)) - 1)) / 16.0));
	}
}

static void test_the_power_on_value_of_a_ds1825_is_no_reading(void)
{
	plug_with("DS1825", "fixed", 1);
	start();
	wire_set(slave, "temperature", 85);
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "temperature"), NULL));
	expect_raw(0x0550, 0);
	TEST_ASSERT_EQUAL_HEX8(0x0c, scratchpad[6]);
}

static void test_limits_of_one_below_zero_make_no_max31826_of_a_ds1825(void)
{
	plug_with("DS1825", "high", -1);
	sim_slave_option(slave, "low", -1);
	sim_slave_power_on(slave, wire_time());
	start();
	wire_set(slave, "temperature", 25.0625);
	expect(true, of(slave, "temperature"), "     25.0625");
	expect(true, of(slave, "type"), "DS1825");
	expect_number("temphigh", -1);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "memory"), NULL));
}

static void test_a_max31826_measures_as_its_table_says(void)
{
	/* bit 7 of its configuration is 1, what the others are no table says */
	static const uint8_t configs[] = {0x85, 0x95, 0xe5, 0xf5};

	for (size_t k = 0; k < sizeof(configs); k++) {
		plug_with("MAX31826", "address", 5);
		TEST_ASSERT_EQUAL_HEX8(0xf5, scratchpad[4]);
		scratchpad[4] = configs[k];
		start();
		for (size_t i = 0; i < TABLE; i++) {
			wire_set(slave, "temperature", table[i].celsius);
			expect(true, of(slave, "temperature"), as_number(table[i].celsius));
			expect_raw(table[i].raw, 0);
			forget();
		}
		expect(true, of(slave, "type"), "MAX31826");
		expect_number("prog_addr", 5);
		TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "templow"), NULL));
		TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "thermocouple"), NULL));
		TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "temperature9"), NULL));
	}
}

static void make_max31826(void)
{
	plug("MAX31826");
	wire_set(slave, "temperature", 25.0625);
	expect(true, of(slave, "temperature"), "     25.0625");
}

static void test_the_memory_of_a_max31826_is_read_by_page_and_whole(void)
{
	uint32_t id;

	make_max31826();
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "pages/page.15"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(PAGE, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY(part->memory + 120, data[id], PAGE);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "memory"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_UINT(MEMORY, answer_to(id)->len);
	TEST_ASSERT_EQUAL_MEMORY(part->memory, data[id], MEMORY);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "pages/page.16"), NULL));
}

/* The memory has no checksum, so that ones are also what is heard of nobody. */
static void test_what_is_erased_in_a_max31826_is_read_as_ones(void)
{
	unsigned id;

	plug("MAX31826");
	memset(part->memory, 0xff, MEMORY - PAGE);
	memset(part->memory + MEMORY - PAGE, 0, PAGE);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "memory"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_MEMORY(part->memory, data[id], MEMORY);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "pages/page.0"), NULL));
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_LESS_THAN_INT(0, result(BUS_READ, of(slave, "pages/page.0"), NULL));
}

static void test_a_write_to_a_max31826_keeps_the_rest_of_the_page_and_copies_what_is_new(void)
{
	uint8_t want[MEMORY];

	make_max31826();
	memcpy(want, part->memory, MEMORY);
	memcpy(want + 24, "abc", 3);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "pages/page.3"), "abc"));
	TEST_ASSERT_EQUAL_MEMORY(want, part->memory, MEMORY);
	TEST_ASSERT_EQUAL_UINT(1, part->copies);
	/* an EEPROM wears: what is there is not written again */
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "pages/page.3"), "abc"));
	TEST_ASSERT_EQUAL_UINT(1, part->copies);
	memcpy(want, "twenty bytes of text", 20);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "memory"), "twenty bytes of text"));
	TEST_ASSERT_EQUAL_MEMORY(want, part->memory, MEMORY);
	TEST_ASSERT_EQUAL_UINT(4, part->copies);
}

static void test_a_part_of_a_max31826_is_written_anywhere(void)
{
	static const struct {
		const char *name;
		unsigned at, start, copies;
	} parts[] = {{"memory", 0, 5, 2},        {"memory", 0, 8, 1},
	             {"memory", 0, 127, 1},      {"memory", 0, 128, 0},
	             {"pages/page.4", 32, 3, 1}, {"pages/page.4", 32, 6, 1},
	             {"pages/page.4", 32, 8, 0}};
	uint8_t want[MEMORY];
	char text[5] = "";

	make_max31826();
	memcpy(want, part->memory, MEMORY);
	for (unsigned i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		unsigned end = parts[i].at ? 8 : MEMORY, room = end - parts[i].start;
		unsigned copies = part->copies;

		memset(text, 'a' + (int)i, 4);
		memcpy(want + parts[i].at + parts[i].start, text, room < 4 ? room : 4);
		write_offset = parts[i].start;
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, parts[i].name), text));
		TEST_ASSERT_EQUAL_MEMORY(want, part->memory, MEMORY);
		TEST_ASSERT_EQUAL_UINT(parts[i].copies, part->copies - copies);
	}
	write_offset = 0;
}

static void test_a_locked_max31826_refuses_and_a_garbled_scratchpad_is_not_copied(void)
{
	make_max31826();
	part->locked = true;
	TEST_ASSERT_EQUAL_INT(-EIO, result(BUS_WRITE, of(slave, "pages/page.0"), "x"));
	part->locked = false;
	part->copies = 0;
	part->garbled = true;
	TEST_ASSERT_EQUAL_INT(-EBADE, result(BUS_WRITE, of(slave, "pages/page.0"), "x"));
	TEST_ASSERT_EQUAL_UINT(0, part->copies);
	TEST_ASSERT_EQUAL_HEX8(0, part->memory[0]);
}

static void test_a_max31850_tells_thermocouple_and_cold_junction_as_its_tables_say(void)
{
	/* tables 3 and 4: D[31:18] above two bits, D[15:4] above four */
	static const struct {
		double celsius;
		unsigned raw;
	} thermocouple[] =
		{
			{1600, 0x6400}, {1000, 0x3e80},  {100.75, 0x064c}, {25, 0x0190},
			{0, 0x0000},    {-0.25, 0xfffc}, {-1, 0xfff0},     {-250, 0xf060},
		},
	  junction[] = {
		  {127, 0x7f00},     {100.5625, 0x6490}, {25, 0x1900},  {0, 0x0000},
		  {-0.0625, 0xfff0}, {-1, 0xff00},       {-20, 0xec00}, {-55, 0xc900},
	  };

	plug_with("MAX31850", "address", 10);
	sim_slave_power_on(slave, wire_time());
	start();
	for (size_t i = 0; i < 8; i++) {
		wire_set(slave, "thermocouple", thermocouple[i].celsius);
		wire_set(slave, "temperature", junction[i].celsius);
		expect(true, of(slave, "temperature"), as_number(junction[i].celsius));
		expect_raw(thermocouple[i].raw, 0);
		expect_raw(junction[i].raw, 2);
		expect(true, of(slave, "thermocouple"), as_number(thermocouple[i].celsius));
		expect(true, of(slave, "latesttemp"), as_number(junction[i].celsius));
		forget();
	}
	expect(true, of(slave, "type"), "MAX31850");
	expect_number("prog_addr", 10);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "temphigh"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "memory"), NULL));
	TEST_ASSERT_EQUAL_UINT(0, writes);
}

static void test_a_fault_of_the_thermocouple_is_told_and_its_temperature_is_not(void)
{
	static const char *const faults[] = {"open_circuit", "ground_short", "vdd_short"};

	plug("MAX31850");
	wire_set(slave, "thermocouple", 25);
	wire_set(slave, "temperature", 25);
	expect(true, of(slave, "temperature"), "          25");
	expect(true, of(slave, "thermocouple"), "          25");
	for (int which = 0; which < 3; which++) {
		wire_set(slave, faults[which], 1);
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-ENODATA, result(BUS_READ, of(slave, "thermocouple"), NULL), faults[which]);
		expect_raw(0x0191, 0);
		expect_raw(0x1900 | 1 << which, 2);
		expect(true, of(slave, "fault"), "1");
		for (int i = 0; i < 3; i++)
			expect(true, of(slave, faults[i]), i == which ? "1" : "0");
		/* the chip's own is right none the less */
		expect(true, of(slave, "temperature"), "          25");
		wire_set(slave, faults[which], 0);
		forget();
	}
	expect(true, of(slave, "thermocouple"), "          25");
	expect(true, of(slave, "fault"), "0");
}

/* It has measured 25 and 21 degrees before. */
static void plug_warm(const char *chip)
{
	bool junction = strcmp(chip, "MAX31850") == 0;

	plug_with(chip, NULL, 0);
	put_raw(0x0190, 0);
	if (junction) {
		put_raw(0x1500, 2);
		wire_set(slave, "thermocouple", 25);
	}
	wire_set(slave, "temperature", junction ? 21 : 25);
	start();
}

static void test_which_chip_it_is_need_not_be_known_before_a_request(void)
{
	static const struct {
		const char *property;
		int ds1825, max31826, max31850; /* what each answers first of all */
	} first[] = {
		{"thermocouple", -ENOENT, -ENOENT, 0}, {"open_circuit", -ENOENT, -ENOENT, 0},
		{"memory", -ENOENT, 0, -ENOENT},       {"pages/page.1", -ENOENT, 0, -ENOENT},
		{"temphigh", 0, -ENOENT, -ENOENT},     {"latesttemp", -EIO, -EIO, -EIO},
		{"fasttemp", 0, -ENOENT, -ENOENT},     {"prog_addr", 0, 0, 0},
	};

	for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++) {
		const char *property = first[i].property;

		plug_warm("DS1825");
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].ds1825, result(BUS_READ, of(slave, property), NULL), property);
		plug_warm("MAX31826");
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].max31826, result(BUS_READ, of(slave, property), NULL), property);
		plug_warm("MAX31850");
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].max31850, result(BUS_READ, of(slave, property), NULL), property);
		expect(true, of(slave, "temperature"), "          21");
		expect(true, of(slave, "thermocouple"), "          25");
	}
	plug_warm("MAX31850");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(slave, "templow"), "5"));
	plug_warm("MAX31850");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(slave, "pages/page.2"), "x"));
	plug_warm("MAX31826");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "memory"), "x"));
	TEST_ASSERT_EQUAL_HEX8('x', part->memory[0]);
}

static void test_which_chip_it_is_may_become_known_while_a_request_waits(void)
{
	static const struct {
		enum bus_op op;
		const char *property;
	} waits[] = {
		{BUS_READ, "temphigh"}, {BUS_READ, "fasttemp"}, {BUS_READ, "pages/page.1"},
		{BUS_WRITE, "templow"}, {BUS_WRITE, "memory"},
	};

	for (size_t i = 0; i < sizeof(waits) / sizeof(waits[0]); i++) {
		const char *property = waits[i].property;

		plug_warm("MAX31850");
		uint32_t first = ask(BUS_READ, BUS_GUEST, false, of(slave, "prog_addr"), NULL);
		uint32_t second = ask(waits[i].op, BUS_GUEST, false, of(slave, property),
		                      waits[i].op == BUS_WRITE ? "5" : NULL);

		TEST_ASSERT_EQUAL_INT(0, answer_to(first)->err);
		TEST_ASSERT_EQUAL_INT_MESSAGE(-ENOENT, answer_to(second)->err, property);
		TEST_ASSERT_EQUAL_UINT(0, writes);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds1825_measures_as_its_table_says);
	RUN_TEST(test_a_ds1825_tells_its_address_pins_and_resolution);
	RUN_TEST(test_the_power_on_value_of_a_ds1825_is_no_reading);
	RUN_TEST(test_limits_of_one_below_zero_make_no_max31826_of_a_ds1825);
	RUN_TEST(test_a_max31826_measures_as_its_table_says);
	RUN_TEST(test_the_memory_of_a_max31826_is_read_by_page_and_whole);
	RUN_TEST(test_what_is_erased_in_a_max31826_is_read_as_ones);
	RUN_TEST(test_a_write_to_a_max31826_keeps_the_rest_of_the_page_and_copies_what_is_new);
	RUN_TEST(test_a_part_of_a_max31826_is_written_anywhere);
	RUN_TEST(test_a_locked_max31826_refuses_and_a_garbled_scratchpad_is_not_copied);
	RUN_TEST(test_a_max31850_tells_thermocouple_and_cold_junction_as_its_tables_say);
	RUN_TEST(test_a_fault_of_the_thermocouple_is_told_and_its_temperature_is_not);
	RUN_TEST(test_which_chip_it_is_need_not_be_known_before_a_request);
	RUN_TEST(test_which_chip_it_is_may_become_known_while_a_request_waits);
	return UNITY_END();
}
