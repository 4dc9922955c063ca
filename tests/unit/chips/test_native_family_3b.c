/* SPDX-License-Identifier: MIT */
/*
 * Family 3B beside the data sheets: DS1825 (19-7384), MAX31826 (19-6264), MAX31850 and MAX31851
 * (19-6725). The parts here are scratchpads that a test fills, with the MAX31826's memory.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/crc.h"
#include "tests/unit/aid/native_scene.h"

#define MEMORY 128
#define PAGE 8

struct part {
	uint8_t scratchpad[8];
	uint8_t memory[MEMORY], second[PAGE], taken[2 + PAGE];
	uint8_t command, got, target;
	bool locked, garbled;    /* the EEPROM takes nothing; the second scratchpad is read wrong */
	unsigned copies, writes; /* of the second scratchpad; of the first */
};

static struct sim_slave *slave;
static struct part *part;

static void send_with_crc(struct sim_slave *s, const uint8_t *bytes, size_t n)
{
	uint8_t out[PAGE + 1];

	memcpy(out, bytes, n);
	out[n] = sim_crc8(0, bytes, n);
	sim_send(s, out, n + 1);
}

static void begin(struct sim_slave *s, uint8_t byte)
{
	part->command = byte;
	part->got = 0;
	switch (byte) {
	case 0x44: /* Convert T: the line is low meanwhile */
	case 0xb4: /* Read Power Supply: external */
		sim_send_bits(s);
		return;
	case 0xbe: /* Read Scratchpad */
		send_with_crc(s, part->scratchpad, 8);
		return;
	case 0x4e: /* Write Scratchpad: of these parts none is changed by it */
		part->writes++;
		return;
	case 0xf0: /* Read Memory */
	case 0x0f: /* Write Scratchpad 2 */
	case 0xaa: /* Read Scratchpad 2 */
	case 0x55: /* Copy Scratchpad 2 */
		return;
	default:
		sim_end(s);
	}
}

static void received(struct sim_slave *s, uint8_t byte, int64_t t)
{
	(void)t;
	if (!part->command) {
		begin(s, byte);
		return;
	}
	if (part->got < sizeof(part->taken))
		part->taken[part->got++] = byte;
	if (part->command == 0xf0) {
		sim_send(s, part->memory + byte % MEMORY, PAGE);
	} else if (part->command == 0xaa) {
		part->second[0] ^= part->garbled;
		send_with_crc(s, part->second, PAGE);
		part->second[0] ^= part->garbled;
	} else if (part->command == 0x0f && part->got == 1 + PAGE) {
		part->target = part->taken[0];
		memcpy(part->second, part->taken + 1, PAGE);
	} else if (part->command == 0x55 && byte == 0xa5) {
		part->copies++;
		if (!part->locked)
			memcpy(part->memory + part->target, part->second, PAGE);
		sim_end(s);
	}
}

static bool bit(struct sim_slave *s, int64_t t)
{
	(void)s;
	(void)t;
	return part->command != 0x44;
}

static void reset(struct sim_slave *s, int64_t t)
{
	(void)s;
	(void)t;
	part->command = 0;
}

/* clang-format off */
static const struct sim_family family = {
	.name = "family 3B", .code = 0x3b, .state_size = sizeof(struct part), .reset = reset,
	.received = received, .bit = bit,
};
/* clang-format on */

/* A part with these first five bytes of its scratchpad. */
static void plug(unsigned temperature, unsigned second, uint8_t config)
{
	static const uint8_t id[6] = {1, 2, 3, 4, 5, 6};

	wire_init(&host, 1, 1);
	slave = sim_slave_create(&family, id);
	TEST_ASSERT_NOT_NULL(slave);
	TEST_ASSERT_EQUAL_INT(0, sim_wire_add(&wire_net.wire[0], slave));
	part = slave->state;
	memset(part->scratchpad, 0xff, sizeof(part->scratchpad));
	part->scratchpad[0] = (uint8_t)temperature;
	part->scratchpad[1] = (uint8_t)(temperature >> 8);
	part->scratchpad[2] = (uint8_t)second;
	part->scratchpad[3] = (uint8_t)(second >> 8);
	part->scratchpad[4] = config;
	for (unsigned i = 0; i < MEMORY; i++)
		part->memory[i] = (uint8_t)(i * 7);
	start();
}

static void replug(unsigned temperature, unsigned second, uint8_t config)
{
	native_end();
	native_begin();
	plug(temperature, second, config);
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
	plug(0, 0x464b, 0x7f);
	for (size_t i = 0; i < TABLE; i++) {
		part->scratchpad[0] = (uint8_t)table[i].raw;
		part->scratchpad[1] = (uint8_t)(table[i].raw >> 8);
		expect(true, of(slave, "temperature"), as_number(table[i].celsius));
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

		replug(0x0191, 0x464b, (uint8_t)(0x10 | resolution << 5 | i));
		expect_number("prog_addr", i);
		expect_number("tempres", 9 + resolution);
		/* undefined bits of a coarser reading count as 0 */
		expect(true, of(slave, "latesttemp"),
		       as_number((0x191 & ~((1 << (3 - resolution)) - 1)) / 16.0));
	}
}

static void test_the_power_on_value_of_a_ds1825_is_no_reading(void)
{
	plug(0x0550, 0x464b, 0x7f);
	part->scratchpad[6] = 0x0c;
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "temperature"), NULL));
}

static void test_limits_of_one_below_zero_make_no_max31826_of_a_ds1825(void)
{
	plug(0x0191, 0xffff, 0x7f);
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
		replug(0, 0xffff, configs[k]);
		for (size_t i = 0; i < TABLE; i++) {
			part->scratchpad[0] = (uint8_t)table[i].raw;
			part->scratchpad[1] = (uint8_t)(table[i].raw >> 8);
			expect(true, of(slave, "temperature"), as_number(table[i].celsius));
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
	plug(0x0191, 0xffff, 0xf0);
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
	TEST_ASSERT_EQUAL_INT(-EBADMSG, result(BUS_WRITE, of(slave, "pages/page.0"), "x"));
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

	plug(0, 0, 0xfa);
	for (size_t i = 0; i < 8; i++) {
		part->scratchpad[0] = (uint8_t)thermocouple[i].raw;
		part->scratchpad[1] = (uint8_t)(thermocouple[i].raw >> 8);
		part->scratchpad[2] = (uint8_t)junction[i].raw;
		part->scratchpad[3] = (uint8_t)(junction[i].raw >> 8);
		expect(true, of(slave, "temperature"), as_number(junction[i].celsius));
		expect(true, of(slave, "thermocouple"), as_number(thermocouple[i].celsius));
		expect(true, of(slave, "latesttemp"), as_number(junction[i].celsius));
		forget();
	}
	expect(true, of(slave, "type"), "MAX31850");
	expect_number("prog_addr", 10);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "temphigh"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "memory"), NULL));
	TEST_ASSERT_EQUAL_UINT(0, part->writes);
}

static void test_a_fault_of_the_thermocouple_is_told_and_its_temperature_is_not(void)
{
	static const struct {
		const char *property;
		uint8_t bit;
	} faults[] = {{"open_circuit", 1}, {"ground_short", 2}, {"vdd_short", 4}};

	plug(0x0190, 0x1900, 0xf0);
	expect(true, of(slave, "temperature"), "          25");
	expect(true, of(slave, "thermocouple"), "          25");
	for (int which = 0; which < 3; which++) {
		part->scratchpad[0] = 0x90 | 1;
		part->scratchpad[2] = faults[which].bit;
		expect(true, of(slave, "fault"), "1");
		for (int i = 0; i < 3; i++)
			expect(true, of(slave, faults[i].property), i == which ? "1" : "0");
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EIO,
		                              result(BUS_READ, of(slave, "thermocouple"), NULL),
		                              faults[which].property);
		/* the chip's own is right none the less */
		expect(true, of(slave, "temperature"), "          25");
		forget();
	}
	part->scratchpad[0] = 0x90;
	part->scratchpad[2] = 0;
	expect(true, of(slave, "fault"), "0");
	expect(true, of(slave, "thermocouple"), "          25");
}

static void test_which_chip_it_is_need_not_be_known_before_a_request(void)
{
	static const struct {
		const char *property;
		int ds1825, max31826, max31850; /* what each answers first of all */
	} first[] = {
		{"thermocouple", -ENOENT, -ENOENT, 0}, {"open_circuit", -ENOENT, -ENOENT, 0},
		{"memory", -ENOENT, 0, -ENOENT},       {"pages/page.1", -ENOENT, 0, -ENOENT},
		{"temphigh", 0, -ENOENT, -ENOENT},     {"latesttemp", 0, 0, 0},
		{"fasttemp", 0, -ENOENT, -ENOENT},     {"prog_addr", 0, 0, 0},
	};

	for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++) {
		const char *property = first[i].property;

		replug(0x0190, 0x464b, 0x70);
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].ds1825, result(BUS_READ, of(slave, property), NULL), property);
		replug(0x0190, 0xffff, 0xf0);
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].max31826, result(BUS_READ, of(slave, property), NULL), property);
		replug(0x0190, 0x1500, 0xf0);
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			first[i].max31850, result(BUS_READ, of(slave, property), NULL), property);
		expect(true, of(slave, "temperature"), "          21");
		expect(true, of(slave, "thermocouple"), "          25");
	}
	replug(0x0190, 0x1500, 0xf0);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(slave, "templow"), "5"));
	replug(0x0190, 0x1500, 0xf0);
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_WRITE, of(slave, "pages/page.2"), "x"));
	replug(0x0190, 0xffff, 0xf0);
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "memory"), "x"));
	TEST_ASSERT_EQUAL_HEX8('x', part->memory[0]);
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
	RUN_TEST(test_a_write_to_a_max31826_keeps_the_rest_of_the_page_and_copies_what_is_new);
	RUN_TEST(test_a_part_of_a_max31826_is_written_anywhere);
	RUN_TEST(test_a_locked_max31826_refuses_and_a_garbled_scratchpad_is_not_copied);
	RUN_TEST(test_a_max31850_tells_thermocouple_and_cold_junction_as_its_tables_say);
	RUN_TEST(test_a_fault_of_the_thermocouple_is_told_and_its_temperature_is_not);
	RUN_TEST(test_which_chip_it_is_need_not_be_known_before_a_request);
	return UNITY_END();
}
