/* SPDX-License-Identifier: MIT */
/* Searches by slots and by paths find the same devices in the same order. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/native/state.h"
#include "hal/wire/search.h"
#include "tests/unit/aid/native_scene.h"

#define DEVICES 24

static struct sim_slave *chip[DEVICES];
static struct link *link;

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
}

void tearDown(void)
{
	native_end();
}

static void begin(bool paths)
{
	static const char *const types[] = {"DS18B20", "DS2401", "DS2413", "DS18S20"};

	wire_net.has_paths = paths;
	for (unsigned i = 0; i < DEVICES; i++)
		chip[i] = wire_add(0, types[i % 4], i * 37 + 1);
	start();
	link = ((struct native *)bus)->channel[0].link;
	TEST_ASSERT_EQUAL(paths, link->facts->paths);
}

static void again(void)
{
	tearDown();
	setUp();
}

/* The ids that a search finds; the number of them. */
static unsigned find_all(bool alarm, uint8_t family, uint8_t roms[DEVICES + 1][8])
{
	struct search search;
	unsigned n = 0;
	int found;

	search_begin(&search, alarm, family);
	while ((found = search_next(&search, link)) > 0 && n <= DEVICES)
		memcpy(roms[n++], search.rom, 8);
	TEST_ASSERT_EQUAL_INT(0, found);
	return n;
}

static void test_paths_find_what_slots_find(void)
{
	static const uint8_t families[] = {0, 0x28, 0x01, 0x3a, 0x10, 0x29};
	uint8_t by_slots[sizeof(families)][DEVICES + 1][8], by_paths[DEVICES + 1][8];
	unsigned n[sizeof(families)];

	begin(false);
	for (unsigned i = 0; i < sizeof(families); i++)
		n[i] = find_all(false, families[i], by_slots[i]);
	TEST_ASSERT_EQUAL_UINT(DEVICES, n[0]);
	TEST_ASSERT_EQUAL_UINT(DEVICES / 4, n[1]);
	TEST_ASSERT_EQUAL_UINT(0, n[5]);
	TEST_ASSERT_EQUAL_UINT(0, wire_net.paths);
	again();
	begin(true);
	wire_net.paths = 0;
	for (unsigned i = 0; i < sizeof(families); i++) {
		TEST_ASSERT_EQUAL_UINT(n[i], find_all(false, families[i], by_paths));
		TEST_ASSERT_EQUAL_INT(0, memcmp(by_slots[i], by_paths, 8 * n[i]));
	}
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2 * DEVICES, wire_net.paths);
}

static void test_a_path_shows_who_is_in_alarm(void)
{
	uint8_t roms[DEVICES + 1][8];

	begin(true);
	TEST_ASSERT_EQUAL_UINT(0, find_all(true, 0, roms));
	/* with the limits of the factory thermometers are in alarm once they have converted */
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(chip[4], "temperature"), NULL));
	TEST_ASSERT_EQUAL_UINT(DEVICES / 2, find_all(true, 0, roms));
	TEST_ASSERT_EQUAL_INT(1, search_verify(link, chip[4]->rom, true));
	TEST_ASSERT_EQUAL_INT(0, search_verify(link, chip[1]->rom, true));
}

static void test_one_path_shows_several_to_be_away(void)
{
	for (int paths = 0; paths < 2; paths++) {
		const uint8_t *roms[3];
		bool away[3] = {false};
		uint8_t gone[8];

		begin(paths);
		TEST_ASSERT_EQUAL_INT(1, search_verify(link, chip[3]->rom, false));
		for (unsigned i = 3; i < 6; i++)
			sim_wire_plug(&wire_net.wire[0], chip[i], false, wire_time());
		memcpy(gone, chip[3]->rom, 8);
		TEST_ASSERT_EQUAL_INT(0, search_verify(link, gone, false));
		/* no chip is of the family of the first two */
		for (unsigned i = 0; i < DEVICES; i++)
			if (i % 4 == 1)
				sim_wire_plug(&wire_net.wire[0], chip[i], false, wire_time());
		roms[0] = chip[1]->rom;
		roms[1] = chip[9]->rom;
		roms[2] = chip[0]->rom;
		TEST_ASSERT_EQUAL_INT(0, search_among(link, roms, away, 3, 64));
		TEST_ASSERT_TRUE(away[0] && away[1]);
		TEST_ASSERT_FALSE(away[2]);
		again();
	}
}

static void test_a_wire_without_chips_has_none_by_a_path(void)
{
	uint8_t roms[DEVICES + 1][8];

	begin(true);
	for (unsigned i = 0; i < DEVICES; i++)
		sim_wire_plug(&wire_net.wire[0], chip[i], false, wire_time());
	TEST_ASSERT_EQUAL_UINT(0, find_all(false, 0, roms));
	TEST_ASSERT_EQUAL_INT(0, search_verify(link, chip[0]->rom, false));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_paths_find_what_slots_find);
	RUN_TEST(test_a_path_shows_who_is_in_alarm);
	RUN_TEST(test_one_path_shows_several_to_be_away);
	RUN_TEST(test_a_wire_without_chips_has_none_by_a_path);
	return UNITY_END();
}
