/* SPDX-License-Identifier: MIT */
/*
 * No trouble on the wire makes a write look as if it had happened: each property that can be
 * written is, with each command lost, each bit turned over and each presence pulse lost in turn.
 * What is told to be written is in the chip, and nothing else of it has changed.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/pins.h"
#include "tests/unit/aid/visit.h"

#define STATE_MAX 4096

/* What the chip holds behind an untroubled write; 1 in mask: this byte differs from run to run. */
static uint8_t truth[STATE_MAX], mask[STATE_MAX];
/* The bits of each byte that are compared. */
static uint8_t bits[STATE_MAX];
static unsigned false_writes;

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
}

/* Until then the chip has come to rest; what it was told last is the same in all runs. */
static void settle(const struct visit *visit, int64_t begun)
{
	char name[100];

	host_run(&host, bus, begun + 30 * HOST_S);
	snprintf(name, sizeof(name), "%s", visit->property);
	(void)result(BUS_READ, of(visited, strcmp(visit->chip, "DS2405") == 0 ? "sensed" : "type"),
	             NULL);
	sim_wire_reset(&wire_net.wire[0], false, wire_time());
	sim_slave_advance(visited, wire_time());
}

static int run(const struct visit *visit, const struct trouble *what, int64_t later)
{
	int64_t begun = host.now;

	host_run(&host, bus, begun + later);
	int err = answer_to(visit_go(visit, what))->err;

	settle(visit, begun);
	return err;
}

/*
 * The protocol leaves its mark in the state: only what the chip keeps is compared.
 */
static size_t kept(const struct visit *visit, const uint8_t **state)
{
	size_t size = visited->family->state_size;

	*state = visited->state;
	if (visited->family->memory && strcmp(visit->chip, "DS2406") != 0)
		*state = visited->family->memory(visited, &size);
	if (strcmp(visit->chip, "DS2450") == 0)
		size = 32;
	if (strcmp(visit->chip, "DS2408") == 0)
		size = sizeof(struct sim_pins) + 3; /* and mask, polarity, control */
	if (strcmp(visit->chip, "DS2720") == 0) {   /* registers, shadow, EEPROM */
		*state = visited->state;
		size = 256 + 8;
	}
	TEST_ASSERT_LESS_OR_EQUAL_size_t(STATE_MAX, size);
	return size;
}

/* The power-on flag was cleared, and a restart told in its place. */
static bool was_told(const struct visit *visit, unsigned difference)
{
	return strcmp(visit->chip, "DS2408") == 0 && difference == 0x08 &&
	       host_events(&host, BUS_POR) > 0;
}

static void one(const struct visit *visit, const struct trouble *what)
{
	const uint8_t *state;
	int err = run(visit, what, 0);
	size_t size = kept(visit, &state), wrong = size;

	for (size_t i = 0; i < size && !err; i++)
		if (!mask[i] && ((state[i] ^ truth[i]) & bits[i]) &&
		    !was_told(visit, state[i] ^ truth[i])) {
			wrong = i;
			break;
		}
	if (wrong == size)
		return;
	char text[300];

	snprintf(text, sizeof(text), "%s: byte %zu is %02X, not %02X", visit_says(visit, what),
	         wrong, state[wrong], truth[wrong]);
	TEST_MESSAGE(text);
	false_writes++;
}

static void look(const struct visit *visit)
{
	static const int64_t laters[] = {0, 37 * HOST_MS, 211 * HOST_MS};
	const uint8_t *state;
	uint8_t before[STATE_MAX];

	if (getenv("ONLY") && !strstr(visit->property, getenv("ONLY")))
		return;
	visit_begin(visit);
	size_t size = kept(visit, &state);
	settle(visit, host.now);
	memcpy(before, state, size);
	visit_end();
	memset(mask, 0, sizeof(mask));
	/* A recall has the current measured. */
	if (strcmp(visit->chip, "DS2438") == 0)
		memset(mask + 5, 1, 2);
	for (size_t i = 0; i < sizeof(laters) / sizeof(laters[0]); i++) {
		visit_begin(visit);
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			0, run(visit, &(struct trouble){.kind = TROUBLE_NONE}, laters[i]),
			visit->property);
		size = kept(visit, &state);
		for (size_t j = 0; j < size; j++) {
			mask[j] |= i && state[j] != truth[j];
			truth[j] = i ? truth[j] : state[j];
		}
		visit_end();
	}
	/*
	 * A DS2720 acts on a write at once, and has no checksum: a bit turned over in the address
	 * reaches another byte. Of it only what is told to be written is compared.
	 */
	for (size_t i = 0; i < size; i++)
		bits[i] = strcmp(visit->chip, "DS2720") == 0 ? before[i] ^ truth[i] : 0xff;
	bool changes = false;
	for (size_t i = 0; i < size; i++)
		changes |= !mask[i] && before[i] != truth[i];
	TEST_ASSERT_TRUE_MESSAGE(changes, visit->property);
	visit_each(visit, one);
}

static const struct visit visits[] = {
	{.chip = "DS18B20", .property = "temphigh", .write = "33"},
	{.chip = "DS18B20", .property = "templow", .write = "-7", .parasite = true},
	{.chip = "DS18B20", .property = "tempres", .write = "10"},
	{.chip = "DS18S20", .property = "temphigh", .write = "33"},
	{.chip = "DS28EA00", .property = "latch.BYTE", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "0", .turned = true},
	{.chip = "DS2406", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2406", .property = "PIO.A", .write = "1"},
	{.chip = "DS2406", .property = "set_alarm", .write = "121"},
	{.chip = "DS2406", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "PIO.BYTE", .write = "165"},
	{.chip = "DS2408", .property = "PIO.3", .write = "1"},
	{.chip = "DS2408", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "set_alarm", .write = "133333333"},
	{.chip = "DS2408", .property = "strobe", .write = "1"},
	{.chip = "DS2408", .property = "por", .write = "0"},
	{.chip = "DS2413", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2423", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS2430A", .property = "memory", .write = "some bytes", .stride = 3},
	{.chip = "DS2431", .property = "pages/page.1", .write = "123456789", .stride = 3},
	{.chip = "DS2433", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS2438", .property = "pages/page.4", .write = "abcdefgh", .stride = 3},
	{.chip = "DS2438", .property = "B1-R1-A/gain", .write = "12.34", .stride = 3},
	{.chip = "DS2438", .property = "IAD", .write = "0", .stride = 3},
	{.chip = "DS2450", .property = "PIO.B", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/high.C", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/unset", .write = "1"},
	{.chip = "DS2450", .property = "set_alarm/volthigh.D", .write = "3"},
	{.chip = "DS2450", .property = "power", .write = "1"},
	{.chip = "DS2450", .property = "pages/page.2", .write = "abcdefgh"},
	{.chip = "DS2720", .property = "ce", .write = "0"},
	{.chip = "DS2720", .property = "uv", .write = "0"},
	{.chip = "DS2720", .property = "psf", .write = "1"},
	{.chip = "DS2720", .property = "pages/page.1", .write = "wxyz"},
	{.chip = "DS2720", .property = "lock.0", .write = "1"},
	{.chip = "DS28EC20", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
};

static void look_at(const char *chip)
{
	false_writes = 0;
	for (size_t i = 0; i < sizeof(visits) / sizeof(visits[0]); i++)
		if (strcmp(visits[i].chip, chip) == 0)
			look(&visits[i]);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, false_writes, chip);
}

#define WRITES(name, chip) \
	static void test_what_is_told_to_be_written_is_in_the_##name(void) \
	{ \
		look_at(chip); \
	}

WRITES(ds18b20, "DS18B20")
WRITES(ds18s20, "DS18S20")
WRITES(ds28ea00, "DS28EA00")
WRITES(ds2405, "DS2405")
WRITES(ds2406, "DS2406")
WRITES(ds2408, "DS2408")
WRITES(ds2413, "DS2413")
WRITES(ds2423, "DS2423")
WRITES(ds2430a, "DS2430A")
WRITES(ds2431, "DS2431")
WRITES(ds2433, "DS2433")
WRITES(ds2438, "DS2438")
WRITES(ds2450, "DS2450")
WRITES(ds2720, "DS2720")
WRITES(ds28ec20, "DS28EC20")

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds18b20);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds18s20);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds28ea00);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2405);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2406);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2408);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2413);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2423);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2430a);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2431);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2433);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2438);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2450);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds2720);
	RUN_TEST(test_what_is_told_to_be_written_is_in_the_ds28ec20);
	return UNITY_END();
}
