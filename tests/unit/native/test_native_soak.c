/* SPDX-License-Identifier: MIT */
/* Everything at once: devices come and go, wires short, calls fail, and requests of all kinds. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "hal/owfs/path.h"
#include "tests/unit/aid/wire_link.h"

#define DEVICES 24
#define SLOTS 100
#define ROUNDS 600

static struct host host;
static struct bus *bus;
static struct sim_slave *slave[DEVICES];
static struct bus_req req[SLOTS];
static char path[SLOTS][80];
static uint8_t data[SLOTS][1024];
static unsigned device_of[SLOTS];
static bool lent[SLOTS], temperature[SLOTS];
static unsigned answers, good, seen;
static uint32_t seed;

void setUp(void)
{
	host_init_virtual(&host);
}

void tearDown(void)
{
	bus_destroy(bus);
	bus = NULL;
	wire_clear();
}

static uint32_t random_below(uint32_t n)
{
	seed = seed * 1664525u + 1013904223u;
	return (seed >> 8) % n;
}

static void take_answers(void)
{
	for (; seen < host.answers; seen++) {
		const struct bus_answer *answer = &host.answer[seen];
		uint32_t slot = answer->id % SLOTS;

		TEST_ASSERT_TRUE(lent[slot]);
		TEST_ASSERT_EQUAL_UINT32(req[slot].id, answer->id);
		lent[slot] = false;
		answers++;
		TEST_ASSERT_LESS_OR_EQUAL_INT64(req[slot].deadline_ns + 2 * HOST_S, host.now);
		if (answer->err)
			continue;
		good++;
		TEST_ASSERT_LESS_OR_EQUAL_INT64(host.now, answer->measured_ns);
		if (temperature[slot])
			TEST_ASSERT_EQUAL_DOUBLE(20 + device_of[slot], answer->number);
	}
	host.answers = seen = 0;
	host.events = 0;
}

static void ask(uint32_t slot, uint32_t round)
{
	static const char *const properties[] = {
		"temperature", "temperature9", "power",         "type",
		"templow",     "scratchpad",   "temperature12", ""};
	unsigned n = random_below(DEVICES), what = random_below(8);
	char name[ROM_TEXT_MAX];

	rom_print(slave[n]->rom, ROM_F_I, name);
	snprintf(path[slot], sizeof(path[slot]), "/%s%s%s", name, what < 7 ? "/" : "",
	         properties[what]);
	temperature[slot] = what == 0 || what == 1 || what == 6;
	device_of[slot] = n;
	req[slot] = (struct bus_req){.id = round * SLOTS + slot,
	                             .path = path[slot],
	                             .op = what == 7 ? BUS_PROBE : BUS_READ,
	                             .prio = (uint8_t)random_below(4),
	                             .fresh = random_below(3) > 0,
	                             .data = data[slot],
	                             .len = sizeof(data[slot]),
	                             .deadline_ns = host.now +
	                                            (int64_t)(1 + random_below(20)) * HOST_S};
	if (what == 7 && random_below(4) == 0) {
		req[slot].op = BUS_DIR;
		snprintf(path[slot], sizeof(path[slot]), random_below(2) ? "/alarm" : "/");
	}
	lent[slot] = true;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[slot]));
}

static void happen(void)
{
	static const int faults[] = {-EIO, -ETIMEDOUT, -ENXIO, -EIO};
	unsigned n = random_below(DEVICES);

	switch (random_below(8)) {
	case 0:
		sim_wire_plug(&wire_net.wire[n % 2], slave[n], !slave[n]->plugged, host.now);
		break;
	case 1:
		wire_net.wire[random_below(2)].shorted = random_below(3) == 0;
		break;
	case 2:
		wire_net.fault = faults[random_below(4)];
		wire_net.fault_count = random_below(20) ? 1 + random_below(3) : 40;
		wire_net.fault_until = LINK_CHIP_RESET;
		break;
	case 3:
		sim_slave_power_on(slave[n], host.now);
		break;
	case 4:
		slave[n]->corrupt_every = random_below(2) ? 5 + random_below(20) : 0;
		break;
	default:
		break;
	}
}

static void soak(uint32_t from)
{
	char message[32];

	seed = from;
	snprintf(message, sizeof(message), "seed %u", from);
	TEST_MESSAGE(message);
	wire_init(&host, 2, random_below(2) + 1);
	for (unsigned i = 0; i < DEVICES; i++) {
		slave[i] = wire_add(i % 2, "DS18B20", i + 1);
		wire_set(slave[i], "temperature", 20 + i);
		slave[i]->parasite = i % 2 == 0 && i % 6 == 0;
	}
	bus = wire_open();
	answers = good = seen = 0;
	memset(lent, 0, sizeof(lent));
	for (uint32_t round = 0; round < ROUNDS; round++) {
		for (uint32_t slot = 0; slot < SLOTS; slot++)
			if (!lent[slot] && random_below(4) == 0)
				ask(slot, round);
		happen();
		host_run(&host, bus, host.now + (int64_t)random_below(700) * HOST_MS);
		take_answers();
	}
	wire_net.wire[0].shorted = wire_net.wire[1].shorted = false;
	for (unsigned i = 0; i < DEVICES; i++) {
		slave[i]->corrupt_every = 0;
		sim_wire_plug(&wire_net.wire[i % 2], slave[i], true, host.now);
	}
	for (int i = 0; i < 60; i++) {
		host_run(&host, bus, host.now + HOST_S);
		take_answers();
	}
	for (uint32_t slot = 0; slot < SLOTS; slot++)
		TEST_ASSERT_FALSE(lent[slot]);
	TEST_ASSERT_GREATER_THAN_UINT(answers / 4, good);
	/* All is well again. */
	for (uint32_t slot = 0; slot < DEVICES; slot++) {
		char name[ROM_TEXT_MAX];

		rom_print(slave[slot]->rom, ROM_F_I, name);
		snprintf(path[slot], sizeof(path[slot]), "/%s/temperature", name);
		req[slot] = (struct bus_req){.id = 1000000 + slot,
		                             .path = path[slot],
		                             .op = BUS_READ,
		                             .prio = BUS_INPUT,
		                             .fresh = true,
		                             .data = data[slot],
		                             .len = sizeof(data[slot]),
		                             .deadline_ns = host.now + 20 * HOST_S};
		TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[slot]));
	}
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, DEVICES, host.now + 20 * HOST_S));
	for (uint32_t slot = 0; slot < DEVICES; slot++) {
		const struct bus_answer *answer = host_answer(&host, 1000000 + slot);

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_EQUAL_DOUBLE(20 + slot, answer->number);
	}
	bus_destroy(bus);
	bus = NULL;
	wire_clear();
	host_init_virtual(&host);
}

static void test_every_request_is_answered_once_and_no_false_value_is_good(void)
{
	for (uint32_t from = 1; from <= 6; from++)
		soak(from);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_request_is_answered_once_and_no_false_value_is_good);
	return UNITY_END();
}
