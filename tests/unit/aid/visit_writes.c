/* SPDX-License-Identifier: MIT */
/*
 * No trouble on the wire makes a write look as if it had happened: a property is written with each
 * command lost, each bit turned over and each presence pulse lost in turn. What is told to be
 * written is in the chip, and nothing else of it has changed.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/chips/gauge.h"
#include "hal/sim/pins.h"
#include "tests/unit/aid/visit_writes.h"

#define STATE_MAX 9216

/* What the chip holds behind an untroubled write; 1 in mask: this byte differs from run to run. */
static uint8_t truth[STATE_MAX], mask[STATE_MAX];
/* The bits of each byte that are compared. */
static uint8_t bits[STATE_MAX];
static unsigned false_writes;

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

static bool is_gauge(void)
{
	return visited->family->state_size == sizeof(struct gauge);
}

#define GAUGE_LATCHED (offsetof(struct gauge, latched) - offsetof(struct gauge, memory))
#define GAUGE_STORED (offsetof(struct gauge, eeprom) - offsetof(struct gauge, memory))
#define GAUGE_END (GAUGE_STORED + sizeof(((struct gauge *)NULL)->eeprom))

/* A light of a simulated Inferno Embedded: what it shows fades from `from` since a time. */
struct inferno_light {
	uint8_t from[4], to[4], next[4];
	uint32_t fade_ms, next_ms;
	int64_t since;
};
#define INFERNO_LIGHTS 4
#define INFERNO_LIGHT sizeof(struct inferno_light)
#define INFERNO_FROM sizeof(((struct inferno_light *)NULL)->from)
#define INFERNO_SINCE offsetof(struct inferno_light, since)

/*
 * The protocol leaves its mark in the state: only what the chip keeps is compared.
 */
static size_t kept(const struct visit *visit, const uint8_t **state)
{
	size_t size = visited->family->state_size;

	*state = visited->state;
	if (visited->family->memory_size && strcmp(visit->chip, "DS2406") != 0)
		*state = sim_slave_memory(visited, &size);
	if (strcmp(visit->chip, "DS2450") == 0)
		size = 32;
	if (strcmp(visit->chip, "DS2408") == 0)
		size = sizeof(struct sim_pins);
	if (strcmp(visit->chip, "DS2415") == 0)
		size = 1; /* the control byte */
	if (strcmp(visit->chip, "DS2890") == 0)
		size = 2; /* position and control */
	if (visited->rom[0] == 0x21 || visited->rom[0] == 0x41)
		size = 0x280; /* of the loggers the registers too */
	if (strcmp(visit->chip, "DS1977") == 0)
		size = 4096;
	if (visited->rom[0] == 0xED)
		size = INFERNO_LIGHTS * INFERNO_LIGHT + 2 + 8 + 12; /* LEDs, types, relays */
	if (is_gauge()) { /* registers, what was latched, EEPROM */
		*state = sim_state(visited, gauge)->memory;
		size = GAUGE_END;
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
	if (strcmp(visit->chip, "DS2438") == 0 || strcmp(visit->chip, "DS2437") == 0)
		memset(mask + 5, 1, 2);
	/* A commit that is sent again begins a fade anew, where the light then was. */
	for (size_t i = 0; strncmp(visit->chip, "IE_", 3) == 0 && i < INFERNO_LIGHTS; i++) {
		memset(mask + i * INFERNO_LIGHT, 1, INFERNO_FROM);
		memset(mask + i * INFERNO_LIGHT + INFERNO_SINCE, 1, INFERNO_LIGHT - INFERNO_SINCE);
	}
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
	 * A DS2720, the gauges and the boards of Hobby Boards act on a write at once, and have no
	 * checksum: a bit turned over in the address or command reaches another byte. Of them only
	 * what is told to be written is compared.
	 */
	bool at_once = strncmp(visit->chip, "DS27", 4) == 0 || strncmp(visit->chip, "HB_", 3) == 0;

	for (size_t i = 0; i < size; i++)
		bits[i] = at_once ? before[i] ^ truth[i] : 0xff;
	if (at_once && size == GAUGE_END)
		memset(bits + GAUGE_LATCHED, 0, GAUGE_STORED - GAUGE_LATCHED);
	bool changes = false;
	for (size_t i = 0; i < size; i++)
		changes |= !mask[i] && before[i] != truth[i];
	TEST_ASSERT_TRUE_MESSAGE(changes, visit->property);
	visit_each(visit, one);
	visit_in_noise(visit, 21 / visit_stride(), 0.005, one);
}

void visit_writes(const char *chip, bool parasite, const struct visit *visits)
{
	false_writes = 0;
	for (; visits->chip; visits++)
		if (strcmp(visits->chip, chip) == 0 && visits->parasite == parasite)
			look(visits);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, false_writes, chip);
}
