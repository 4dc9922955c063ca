/* SPDX-License-Identifier: MIT */
/*
 * No temperature is older than it says, whatever comes between Convert T and the reading: settings
 * that are written, other resolutions, readings of other properties, searches, Convert T for all,
 * requests that are given up while the chip converts. The temperatures climb all the time, so that
 * each value tells when it was taken. What a chip does with a Convert T while it converts, no data
 * sheet says: both are tried.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/sim/chips/thermometer.h"
#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define SLOPE 2 /* degrees in a second: one of 12 bits in 31 ms */
#define ROUNDS 120

struct setup {
	const char *chip;
	unsigned count;
	bool passive, parasite, once;
	bool resolutions; /* they are changed; a value is then good to half a degree */
	int64_t pause_ns, early_ns;
};

static uint32_t seed;
static unsigned disturbed, answers, refused;

void setUp(void)
{
	native_begin();
	fleet_begin();
}

void tearDown(void)
{
	native_end();
}

static uint32_t random_below(uint32_t n)
{
	seed = seed * 1664525u + 1013904223u;
	return (seed >> 8) % n;
}

/* Write Scratchpad and Recall reach a chip that converts. */
static void look_for_disturbance(const uint8_t *bytes, size_t n)
{
	for (unsigned i = 0; n >= 10 && i < fleet.count; i++) {
		const struct sim_slave *slave = fleet.slave[i];

		if (memcmp(bytes + 1, slave->rom, 8) != 0 || !slave->busy ||
		    slave->until <= host.now || strncmp(slave->family->name, "DS", 2) != 0)
			continue;
		const struct sim_thermometer *s = slave->state;
		disturbed += !s->copying && (bytes[9] == 0x4e || bytes[9] == 0xb8);
	}
}

static void set_out(const struct setup *setup)
{
	fleet_again();
	wire_init(&host, 1, 1);
	wire_net.passive = setup->passive;
	wire_net.sent = look_for_disturbance;
	fleet_slope = SLOPE;
	fleet_add(setup->chip, setup->count);
	fleet.step = setup->resolutions ? 0.5 : 0;
	fleet.early_ns = setup->early_ns;
	fleet.slave[0]->parasite = setup->parasite;
	for (unsigned i = 0; i < setup->count; i++) {
		fleet.pause_ns[i] = setup->pause_ns * i;
		sim_slave_option(fleet.slave[i], "once", setup->once);
	}
	/* It is refused at once. */
	if (setup->passive && setup->parasite)
		fleet.pause_ns[0] = 500 * HOST_MS;
	start();
	fleet_run(host.now + 4 * HOST_S);
	fleet_forget();
}

/* Something that may come in between. */
static void happen(const struct setup *setup, unsigned i)
{
	static const char *const reads[] = {"temphigh", "latesttemp", "power", "scratchpad"};
	static const char *const temperatures[] = {"temperature9", "temperature10", "temperature11",
	                                           "temperature12"};
	enum bus_prio prio = random_below(2) ? BUS_GUEST : BUS_OUTPUT;
	char what[100], text[16];
	bool memory = strcmp(setup->chip, "MAX31826") == 0;
	int err = 0;

	snprintf(text, sizeof(text), "%u", 60 + random_below(60));
	switch (random_below(setup->resolutions ? 8 : 6)) {
	case 0:
	case 1:
		snprintf(what, sizeof(what), "%s",
		         of(fleet.slave[i], memory            ? "pages/page.3"
		                            : random_below(2) ? "temphigh"
		                                              : "templow"));
		fleet_answered(fleet_write(prio, what, text), &err);
		break;
	case 2:
		snprintf(what, sizeof(what), "%s", of(fleet.slave[i], reads[random_below(4)]));
		fleet_answered(fleet_ask(prio, BUS_READ, what), &err);
		break;
	case 3:
		fleet_answered(fleet_write(prio, "/simultaneous/temperature", "1"), &err);
		break;
	case 4:
		fleet_answered(fleet_ask(prio, BUS_DIR, random_below(2) ? "/alarm" : "/"), &err);
		break;
	case 5:
		/* Some of its conversions are given up. */
		fleet.patience_ns[i] = random_below(2) ? 0 : (300 + random_below(900)) * HOST_MS;
		break;
	case 6:
		snprintf(what, sizeof(what), "%s",
		         of(fleet.slave[i], temperatures[random_below(4)]));
		fleet_answered(fleet_ask(prio, BUS_READ, what), &err);
		break;
	default:
		snprintf(what, sizeof(what), "%s", of(fleet.slave[i], "tempres"));
		snprintf(text, sizeof(text), "%u", 9 + random_below(4));
		fleet_answered(fleet_write(prio, what, text), &err);
	}
	answers++;
	refused += err != 0;
}

static void check(const struct setup *setup, unsigned rounds)
{
	char text[160];

	set_out(setup);
	disturbed = answers = refused = 0;
	for (unsigned round = 0; round < rounds; round++) {
		fleet_run(host.now + random_below(1100) * HOST_MS);
		happen(setup, random_below(setup->count));
		host.events = 0;
	}
	snprintf(text, sizeof(text), "%s, %u%s%s%s%s: %u good, %u failed, %u of %u refused",
	         setup->chip, setup->count, setup->passive ? ", passive" : "",
	         setup->parasite ? ", parasite" : "", setup->once ? ", once" : "",
	         setup->resolutions ? ", resolutions" : "", fleet.good, fleet.failed, refused,
	         answers);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, fleet.wrong, text);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, disturbed, text);
	TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(rounds / 3, fleet.good, text);
	TEST_ASSERT_LESS_THAN_UINT_MESSAGE(rounds / 2, refused, text);
}

/* On each kind of link, one chip and several, whatever a chip does with a second Convert T. */
static void check_each(struct setup setup, unsigned rounds)
{
	unsigned several = setup.count;

	for (unsigned bits = 0; bits < 16; bits++) {
		setup.passive = bits & 1;
		setup.once = bits & 2;
		setup.parasite = bits & 4;
		setup.count = bits & 8 ? several : 1;
		/* A thermometer that is fed by a passive link is refused. */
		if (setup.passive && setup.parasite && setup.count == 1)
			continue;
		seed = 1 + bits;
		check(&setup, rounds);
	}
}

static void test_no_temperature_is_older_than_it_says(void)
{
	check_each((struct setup){.chip = "DS18B20", .count = 4}, ROUNDS);
}

static void test_the_same_of_a_ds18s20_that_is_asked_for_with_pauses(void)
{
	check_each((struct setup){.chip = "DS18S20", .count = 4, .pause_ns = 130 * HOST_MS},
	           ROUNDS);
}

/* So many convert all at once. */
static void test_the_same_of_many(void)
{
	struct setup many = {.chip = "DS18B20", .count = 90};

	seed = 1;
	check(&many, ROUNDS / 2);
	many.passive = many.once = true;
	check(&many, ROUNDS / 2);
}

/* 150 ms, where all of its family code are given 750. */
static void test_the_same_while_a_memory_is_written(void)
{
	check_each((struct setup){.chip = "MAX31826", .count = 4, .early_ns = 600 * HOST_MS},
	           ROUNDS);
}

static void test_the_same_with_other_resolutions_in_between(void)
{
	check_each((struct setup){.chip = "DS18B20", .count = 4, .resolutions = true}, ROUNDS);
}

/* Before it was read once nobody knows its resolution, and so how long it takes. */
static void test_the_first_value_of_a_chip_has_the_time_of_its_resolution(void)
{
	static const int64_t ms[] = {94, 188, 375, 750};

	for (unsigned bits = 9; bits <= 12; bits++) {
		fleet_again();
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, "DS18B20", 1);
		sim_slave_option(slave, "resolution", bits);
		sim_slave_power_on(slave, host.now);
		start();
		int64_t begun = host.now;
		const struct bus_answer *answer = answer_to(
			ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL));

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_GREATER_THAN_INT64(begun + (ms[bits - 9] - 1) * HOST_MS,
		                               answer->measured_ns);
		TEST_ASSERT_LESS_THAN_INT64(begun + (ms[bits - 9] + 50) * HOST_MS,
		                            answer->measured_ns);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_temperature_is_older_than_it_says);
	RUN_TEST(test_the_same_of_a_ds18s20_that_is_asked_for_with_pauses);
	RUN_TEST(test_the_same_of_many);
	RUN_TEST(test_the_same_while_a_memory_is_written);
	RUN_TEST(test_the_same_with_other_resolutions_in_between);
	RUN_TEST(test_the_first_value_of_a_chip_has_the_time_of_its_resolution);
	return UNITY_END();
}
