/* SPDX-License-Identifier: MIT */
/*
 * How soon each kind of signal shows that the kernel has no slave for its device any more, and that
 * it has one again: by engine and w1 bus in virtual time, on a directory like that of sysfs.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/fs_scene.h"
#include "tests/unit/aid/plant.h"

#define SOON_NS (3 * PLANT_S)

static struct plant plant;
static char rio[1024], target[100];

static const struct kind {
	const char *what, *property, *keys;
	bool output;
} kinds[] = {
	{"alarm item", "sensed.BYTE", "Alarm on LatchAlarm \"latch.BYTE\" PorAlarm \"por\" ",
         false},
	{"PerFactor 1000", "sensed.BYTE", "PerFactor 1000 ", false},
	{"ReadBack 0", "PIO.BYTE", "ReadBack 0 ", true},
	{"InitValue", "PIO.BYTE", "ReadBack 0 InitValue \"85\" ", true},
	{"ReadBack", "PIO.BYTE", "InitValue \"85\" ", true},
};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

void setUp(void)
{
	fs_begin();
}
void tearDown(void)
{
	fs_end();
}

static int64_t until(bool good)
{
	int64_t from = plant.now;

	while (ows_good(plant_sample(&plant, 1).quality) != good && plant.now < from + 70 * PLANT_S)
		plant_run(&plant, plant.now + 10 * PLANT_MS);
	return plant.now - from;
}

/* With another signal of the device that is read in each period, or alone. */
static void begin(const struct kind *kind, bool alone)
{
	fs_text("w1_bus_master1", "uevent", "");
	fs_board(0xff, 0x80);
	snprintf(target, sizeof(target), "w1:root=%s", fs.root);
	snprintf(rio, sizeof(rio),
	         "OwsDrv {\n\tItem { Name \"row\" Path \"" BOARD_OW
	         "/%s\" Type \"byte\" IO \"%s\" %s}\n%s}\n",
	         kind->property, kind->output ? "output" : "input", kind->keys,
	         alone ? ""
	               : "\tItem { Name \"plain\" Path \"" BOARD_OW
	                 "/sensed.0\" Type \"byte\" IO \"input\" Uncached on }\n");
	plant_begin_on(&plant, target, rio);
	plant_run(&plant, plant.now + 2 * PLANT_S);
	if (kind->output)
		plant_set(&plant, 1, 85);
	plant_run(&plant, plant.now + 4 * PLANT_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, plant_sample(&plant, 1).quality, kind->what);
}

static void goes_and_comes(const struct kind *kind, bool alone)
{
	begin(kind, alone);
	fs_gone(BOARD);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(alone ? SOON_NS : PLANT_S, until(false), kind->what);
	plant_run(&plant, plant.now + PLANT_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_NO_DEVICE, plant_sample(&plant, 1).quality,
	                               kind->what);

	fs_board(0xff, 0x80);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(SOON_NS, until(true), kind->what);
	if (kind->output)
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(85, (uint8_t)~fs_now_in(BOARD, "output")[0],
		                               kind->what);
	plant_end(&plant);
}

static void test_each_signal_shows_that_its_slave_is_gone_and_back(void)
{
	for (size_t i = 0; i < 2 * KINDS; i++) {
		goes_and_comes(&kinds[i / 2], i % 2);
		fs_end();
		fs_begin();
	}
}

/* With its master, as an adapter that is pulled; its slave may be there again before it is read. */
static void test_no_signal_is_good_unread_after_its_master_was_away(void)
{
	for (size_t i = 0; i < KINDS; i++) {
		uint32_t count;
		int64_t end_ns;

		begin(&kinds[i], true);
		fs_gone(BOARD);
		fs_erase("w1_bus_master1");
		TEST_ASSERT_LESS_THAN_INT64_MESSAGE(SOON_NS, until(false), kinds[i].what);
		plant_run(&plant, plant.now + 12 * PLANT_S);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_TARGET, plant_sample(&plant, 1).quality,
		                               kinds[i].what);
		count = plant_sample(&plant, 1).count;
		fs_text("w1_bus_master1", "uevent", "");
		fs_board(0xff, 0x80);
		for (end_ns = plant.now + 30 * PLANT_S; plant.now < end_ns;) {
			plant_run(&plant, plant.now + 5 * PLANT_MS);
			if (ows_good(plant_sample(&plant, 1).quality))
				TEST_ASSERT_GREATER_THAN_UINT32_MESSAGE(
					count, plant_sample(&plant, 1).count, kinds[i].what);
		}
		TEST_ASSERT_NOT_EQUAL_MESSAGE(OWS_Q_TARGET, plant_sample(&plant, 1).quality,
		                              kinds[i].what);
		plant_end(&plant);
		fs_end();
		fs_begin();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_signal_shows_that_its_slave_is_gone_and_back);
	RUN_TEST(test_no_signal_is_good_unread_after_its_master_was_away);
	return UNITY_END();
}
