/* SPDX-License-Identifier: MIT */
/* The chip model against the tables of the data sheets. */
#include <string.h>

#include "unity.h"

#include "hal/sim/chip.h"
#include "hal/sim/families.h"

#define US INT64_C(1000)

static struct sim_chip chip;
static int64_t now;

static void make(enum sim_part part)
{
	sim_chip_clear(&chip);
	sim_chip_init(&chip, part, 0x18);
	now = 0;
}

void setUp(void)
{
	make(SIM_DS2482_100);
}

void tearDown(void)
{
	sim_chip_clear(&chip);
}

static void plug(unsigned channel, const struct sim_family *family, uint8_t last)
{
	const uint8_t id[6] = {last, 2, 3, 4, 5, 6};
	struct sim_slave *slave = sim_slave_create(family, id);

	TEST_ASSERT_NOT_NULL(slave);
	TEST_ASSERT_EQUAL_INT(0, sim_wire_add(&chip.wire[channel], slave));
	sim_slave_power_on(slave, now);
}

/* How many of the bytes were acknowledged. */
static int send(const uint8_t *bytes, int n)
{
	int taken = 0;

	TEST_ASSERT_TRUE(sim_chip_start(&chip, false, now));
	while (taken < n && sim_chip_write(&chip, bytes[taken], now))
		taken++;
	return taken;
}

static int send1(uint8_t command)
{
	return send(&command, 1);
}

static int send2(uint8_t command, uint8_t parameter)
{
	const uint8_t bytes[2] = {command, parameter};

	return send(bytes, 2);
}

static uint8_t get(void)
{
	TEST_ASSERT_TRUE(sim_chip_start(&chip, true, now));
	return sim_chip_read(&chip, now);
}

/* Busy to the end, then idle: what the operation took. */
static int64_t duration(void)
{
	int64_t begun = now;

	while (get() & SIM_1WB) {
		now += 100;
		TEST_ASSERT_LESS_THAN_INT64(INT64_C(5000000), now - begun);
	}
	return now - begun;
}

static void config(uint8_t bits)
{
	TEST_ASSERT_EQUAL_INT(2, send2(0xD2, (uint8_t)(bits | (~bits & 15) << 4)));
}

static void test_a_device_reset_gives_the_power_on_values(void)
{
	config(SIM_APU | SIM_1WS);
	TEST_ASSERT_EQUAL_INT(1, send1(0xF0));
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL, get());
	TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xC3));
	TEST_ASSERT_EQUAL_HEX8(0, get());
}

static void test_the_configuration_needs_its_complement_and_clears_rst(void)
{
	TEST_ASSERT_EQUAL_INT(1, send2(0xD2, 0x01));
	TEST_ASSERT_EQUAL_INT(1, send2(0xD2, 0x11));
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL, get());
	TEST_ASSERT_EQUAL_INT(2, send2(0xD2, 0xE1));
	TEST_ASSERT_EQUAL_HEX8(0x01, get());
	TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xF0));
	TEST_ASSERT_EQUAL_HEX8(SIM_LL, get());
}

static void test_the_read_pointer_takes_the_parts_own_codes_only(void)
{
	static const struct {
		enum sim_part part;
		const char *codes;
	} table[] = {
		{SIM_DS2482_100, "\xF0\xE1\xC3"},     {SIM_DS2482_101, "\xF0\xE1\xC3"},
		{SIM_DS2482_800, "\xF0\xE1\xC3\xD2"}, {SIM_DS2483, "\xF0\xE1\xC3\xB4"},
		{SIM_DS2484, "\xF0\xE1\xC3\xB4"},
	};

	for (unsigned i = 0; i < 5; i++) {
		make(table[i].part);
		for (int code = 1; code < 256; code++)
			TEST_ASSERT_EQUAL_INT(1 + !!strchr(table[i].codes, (char)code),
			                      send2(0xE1, (uint8_t)code));
	}
}

static void test_unknown_commands_and_bytes_too_many_are_refused(void)
{
	static const uint8_t three[] = {0xD2, 0xF0, 0xF0}, reset[] = {0xF0, 0xF0};

	for (int code = 0; code < 256; code++) {
		bool known = code && strchr("\xF0\xE1\xD2\xB4\x87\xA5\x96\x78", code);

		make(SIM_DS2482_100);
		TEST_ASSERT_EQUAL_INT(known, send1((uint8_t)code));
	}
	make(SIM_DS2482_100);
	TEST_ASSERT_EQUAL_INT(2, send(three, 3));
	TEST_ASSERT_EQUAL_INT(1, send(reset, 2));
}

static void test_channels_read_back_other_codes_than_those_written(void)
{
	static const uint8_t codes[8][2] = {{0xF0, 0xB8}, {0xE1, 0xB1}, {0xD2, 0xAA}, {0xC3, 0xA3},
	                                    {0xB4, 0x9C}, {0xA5, 0x95}, {0x96, 0x8E}, {0x87, 0x87}};

	TEST_ASSERT_EQUAL_INT(0, send2(0xC3, 0xF0)); /* a -100 has none */
	make(SIM_DS2482_800);
	for (unsigned i = 0; i < 8; i++) {
		TEST_ASSERT_EQUAL_INT(2, send2(0xC3, codes[i][0]));
		TEST_ASSERT_EQUAL_HEX8(codes[i][1], get());
	}
	TEST_ASSERT_EQUAL_INT(1, send2(0xC3, 0x78));
	TEST_ASSERT_EQUAL_INT(1, send1(0xF0));
	TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xD2));
	TEST_ASSERT_EQUAL_HEX8(0xB8, get());
}

static void test_a_channel_reaches_its_own_wire(void)
{
	make(SIM_DS2482_800);
	plug(5, &sim_ds2401, 1);
	for (unsigned i = 0; i < 8; i++) {
		send2(0xC3, (uint8_t)((15 - i) << 4 | i));
		send1(0xB4);
		duration();
		TEST_ASSERT_EQUAL_HEX8(i == 5 ? SIM_PPD : 0, get() & SIM_PPD);
	}
}

static void test_operations_take_the_data_sheets_time(void)
{
	static const struct {
		uint8_t command, speed;
		bool parameter;
		int64_t ns;
	} table[] = {
		{0xB4, 0, false, 1184000}, {0x87, 0, true, 69300},  {0xA5, 0, true, 554400},
		{0x96, 0, false, 554400},  {0x78, 0, true, 207900}, {0xB4, 8, false, 146000},
		{0x87, 8, true, 10500},    {0xA5, 8, true, 84000},  {0x96, 8, false, 84000},
		{0x78, 8, true, 31500},
	};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		make(SIM_DS2482_100);
		config(table[i].speed);
		if (table[i].parameter)
			TEST_ASSERT_EQUAL_INT(2, send2(table[i].command, 0xFF));
		else
			TEST_ASSERT_EQUAL_INT(1, send1(table[i].command));
		TEST_ASSERT_INT64_WITHIN(100, table[i].ns, duration());
	}
}

static void test_a_busy_chip_takes_device_reset_and_read_pointer_only(void)
{
	static const uint8_t refused[] = {0xD2, 0xC3, 0xB4, 0x87, 0xA5, 0x96, 0x78};

	make(SIM_DS2482_800);
	for (unsigned i = 0; i < sizeof(refused); i++) {
		send1(0xB4);
		TEST_ASSERT_EQUAL_INT(0, send2(refused[i], 0xF0));
		TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xC3));
		TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xF0));
		TEST_ASSERT_BITS_HIGH(SIM_1WB, get());
		TEST_ASSERT_EQUAL_INT(1, send1(0xF0));
		TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL, get());
	}
}

static void test_presence_and_short_are_told_apart(void)
{
	send1(0xB4);
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL, get());
	plug(0, &sim_ds2401, 1);
	send1(0xB4);
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL | SIM_PPD, get());
	chip.wire[0].shorted = true;
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_PPD, get()); /* LL follows the line at once */
	send1(0xB4);
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_SD, get());
	chip.wire[0].shorted = false;
	send1(0xB4);
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL | SIM_PPD, get());
}

static uint8_t read_wire_byte(void)
{
	send1(0x96);
	duration();
	send2(0xE1, 0xE1);
	return get();
}

static void write_wire_byte(uint8_t byte)
{
	TEST_ASSERT_EQUAL_INT(2, send2(0xA5, byte));
	duration();
}

static void test_a_byte_read_appears_in_the_data_register_when_it_is_whole(void)
{
	static const uint8_t rom[7] = {0x01, 0x07, 2, 3, 4, 5, 6};

	plug(0, &sim_ds2401, 7);
	send1(0xB4);
	duration();
	write_wire_byte(0x33);
	for (unsigned i = 0; i < 7; i++)
		TEST_ASSERT_EQUAL_HEX8(rom[i], read_wire_byte());
}

static void test_write_byte_fills_the_data_register_too(void)
{
	plug(0, &sim_ds2401, 7);
	send1(0xB4);
	duration();
	write_wire_byte(0x33);
	write_wire_byte(0xFF);
	send2(0xE1, 0xE1);
	TEST_ASSERT_EQUAL_HEX8(0x01, get());
}

static void test_a_triplet_takes_the_direction_the_table_says(void)
{
	/* 5 is 0101, 6 is 0110 in the first id byte; the lowest bit of the family is 1. */
	plug(0, &sim_ds2401, 5);
	send1(0xB4);
	duration();
	write_wire_byte(0xF0);
	send2(0x78, 0x00); /* only a 1 there: the direction is 1 whatever was asked for */
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_SBR | SIM_DIR, get() & (SIM_SBR | SIM_TSB | SIM_DIR));
	send2(0x78, 0x80); /* only a 0 there */
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_TSB, get() & (SIM_SBR | SIM_TSB | SIM_DIR));

	plug(0, &sim_ds2401, 6);
	send1(0xB4);
	duration();
	write_wire_byte(0xF0);
	for (unsigned i = 0; i < 8; i++) {
		send2(0x78, 0x80);
		duration();
	}
	send2(0x78, 0x80); /* both there: as asked for */
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_DIR, get() & (SIM_SBR | SIM_TSB | SIM_DIR));

	send1(0xB4);
	duration();
	send2(0x78, 0x00); /* nobody answers a triplet before a command: an error, direction 1 */
	duration();
	TEST_ASSERT_EQUAL_HEX8(SIM_SBR | SIM_TSB | SIM_DIR, get() & (SIM_SBR | SIM_TSB | SIM_DIR));
}

static void test_the_strong_pullup_comes_after_the_operation_and_goes_with_the_next(void)
{
	config(SIM_SPU | SIM_APU);
	TEST_ASSERT_FALSE(chip.wire[0].strong);
	write_wire_byte(0x44);
	TEST_ASSERT_TRUE(chip.wire[0].strong);
	TEST_ASSERT_EQUAL_HEX8(SIM_SPU | SIM_APU, chip.config);
	send1(0xB4);
	TEST_ASSERT_FALSE(chip.wire[0].strong);
	TEST_ASSERT_EQUAL_HEX8(SIM_APU, chip.config);
	duration();
	config(SIM_SPU);
	send2(0x87, 0x80);
	duration();
	TEST_ASSERT_TRUE(chip.wire[0].strong);
	config(SIM_SPU | SIM_APU);
	TEST_ASSERT_TRUE(chip.wire[0].strong);
	config(SIM_APU);
	TEST_ASSERT_FALSE(chip.wire[0].strong);
	config(SIM_SPU);
	send1(0x96); /* Read Byte and Reset do not bring it */
	duration();
	TEST_ASSERT_FALSE(chip.wire[0].strong);
}

static void test_a_device_reset_ends_what_has_not_happened_yet(void)
{
	plug(0, &sim_ds18b20, 1);
	send1(0xB4);
	now += 300 * US;
	send1(0xF0);
	now += 5000 * US;
	TEST_ASSERT_EQUAL_HEX8(SIM_RST | SIM_LL, get());
	TEST_ASSERT_EQUAL_UINT64(0, chip.wire[0].resets);
}

static void test_a_stuck_chip_is_freed_by_a_device_reset_or_not_at_all(void)
{
	chip.stuck = SIM_STUCK;
	TEST_ASSERT_BITS_HIGH(SIM_1WB, get());
	TEST_ASSERT_EQUAL_INT(0, send1(0xB4));
	send1(0xF0);
	TEST_ASSERT_BITS_LOW(SIM_1WB, get());
	chip.stuck = SIM_STUCK_FAST;
	send1(0xF0);
	TEST_ASSERT_BITS_HIGH(SIM_1WB, get());
}

static void test_the_port_of_a_ds2484_is_adjusted_and_read_back(void)
{
	static const uint8_t adjust[] = {0xC3, 0x0A, 0x1B, 0x6F};
	static const uint8_t expect[] = {0x0A, 0x0B, 6, 6, 6, 6, 0x0F, 6, 0x0A};

	make(SIM_DS2484);
	TEST_ASSERT_EQUAL_INT(4, send(adjust, 4));
	TEST_ASSERT_TRUE(sim_chip_start(&chip, true, now));
	for (unsigned i = 0; i < sizeof(expect); i++)
		TEST_ASSERT_EQUAL_HEX8(expect[i], sim_chip_read(&chip, now));
	TEST_ASSERT_EQUAL_INT(1, send2(0xC3, 0xA0)); /* there is no sixth parameter */
	TEST_ASSERT_EQUAL_INT64(640 * US, sim_chip_timing(&chip).reset_low_ns);
}

static void test_the_port_of_a_ds2483_can_be_switched_off(void)
{
	make(SIM_DS2483);
	plug(0, &sim_ds18b20, 1);
	chip.wire[0].slaves[0]->parasite = true;
	config(SIM_PDN);
	TEST_ASSERT_EQUAL_INT(2, send2(0xE1, 0xF0));
	TEST_ASSERT_EQUAL_HEX8(0, get() & SIM_LL);
	config(0);
	TEST_ASSERT_EQUAL_UINT64(2, chip.wire[0].slaves[0]->power_ons);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_reset_gives_the_power_on_values);
	RUN_TEST(test_the_configuration_needs_its_complement_and_clears_rst);
	RUN_TEST(test_the_read_pointer_takes_the_parts_own_codes_only);
	RUN_TEST(test_unknown_commands_and_bytes_too_many_are_refused);
	RUN_TEST(test_channels_read_back_other_codes_than_those_written);
	RUN_TEST(test_a_channel_reaches_its_own_wire);
	RUN_TEST(test_operations_take_the_data_sheets_time);
	RUN_TEST(test_a_busy_chip_takes_device_reset_and_read_pointer_only);
	RUN_TEST(test_presence_and_short_are_told_apart);
	RUN_TEST(test_a_byte_read_appears_in_the_data_register_when_it_is_whole);
	RUN_TEST(test_write_byte_fills_the_data_register_too);
	RUN_TEST(test_a_triplet_takes_the_direction_the_table_says);
	RUN_TEST(test_the_strong_pullup_comes_after_the_operation_and_goes_with_the_next);
	RUN_TEST(test_a_device_reset_ends_what_has_not_happened_yet);
	RUN_TEST(test_a_stuck_chip_is_freed_by_a_device_reset_or_not_at_all);
	RUN_TEST(test_the_port_of_a_ds2484_is_adjusted_and_read_back);
	RUN_TEST(test_the_port_of_a_ds2483_can_be_switched_off);
	return UNITY_END();
}
