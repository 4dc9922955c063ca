/* SPDX-License-Identifier: MIT */
/* One thermometer that is fed by the wire, among others: how often each is new. */
#include <stdio.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define SETTLED_NS (20 * PLANT_S)
#define SECONDS 60
#define MOST 50

static struct plant plant;
static unsigned thermometers;
static int64_t last_ns[MOST], most_ns[MOST];
static unsigned readings[MOST];

void setUp(void)
{
}

void tearDown(void)
{
}

static void published(void *ctx)
{
	(void)ctx;
	for (unsigned i = 0; i < thermometers; i++) {
		struct ows_sample sample = plant_sample(&plant, i + 1);
		int64_t passed = sample.measured_ns - last_ns[i];

		if (!passed)
			continue;
		if (plant.now - plant.start > SETTLED_NS) {
			readings[i]++;
			most_ns[i] = passed > most_ns[i] ? passed : most_ns[i];
		}
		last_ns[i] = sample.measured_ns;
	}
}

/* How often each is new, in ms, on the average of the slowest; the first of them is parasitic. */
static unsigned cycle_of(unsigned n, unsigned parasitic, unsigned apart, unsigned khz)
{
	static char scenario[8192], rio[16384];
	size_t m, k;
	unsigned least = UINT32_MAX;
	int64_t most = 0;
	char text[160];

	thermometers = n;
	m = (size_t)snprintf(scenario, sizeof(scenario),
	                     "i2c speed %u combine any\nchip DS2482-100 0x18\n", khz);
	k = (size_t)snprintf(rio, sizeof(rio),
	                     "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n");
	for (unsigned i = 0; i < n; i++) {
		unsigned id = (i + 2) * 2654435761u;

		last_ns[i] = most_ns[i] = readings[i] = 0;
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS18B20 28.%08X%04X temperature 21.5%s\n", id, i,
		                      i < parasitic ? " parasite" : "");
		k += (size_t)snprintf(rio + k, sizeof(rio) - k,
		                      "  Item {\n    Name \"t%u\"\n    Type double\n"
		                      "    Path \"/28.%08X%04X/temperature\"\n    IO input\n"
		                      "    Uncached on\n    PerFactor %u\n  }\n",
		                      i, id, i, i < parasitic ? apart : 1);
	}
	snprintf(rio + k, sizeof(rio) - k, "}\n");
	plant_begin(&plant, scenario, rio);
	plant.published = published;
	plant_run(&plant, plant.start + SETTLED_NS + SECONDS * PLANT_S);
	for (unsigned i = 0; i < n; i++)
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, plant_sample(&plant, i + 1).quality);
	plant_end(&plant);
	for (unsigned i = parasitic; i < n; i++) {
		least = readings[i] < least ? readings[i] : least;
		most = most_ns[i] > most ? most_ns[i] : most;
	}
	TEST_ASSERT_GREATER_THAN_UINT(0, least);
	snprintf(
		text, sizeof(text),
		"%u thermometers, %u parasitic (each %u periods, %u readings), %u kHz: each %u ms, at most %d ms",
		n, parasitic, apart, readings[0], khz, SECONDS * 1000 / least,
		(int)(most / PLANT_MS));
	TEST_MESSAGE(text);
	return SECONDS * 1000 / least;
}

/* The pull-up holds the wire for 750 ms. The others were started before, and are read after it. */
static void test_one_that_is_fed_by_the_wire_hardly_slows_others(void)
{
	static const struct {
		unsigned khz, n, most; /* ms */
	} rows[] = {{400, 2, 900}, {400, 17, 1200}, {400, 50, 2100},
	            {100, 2, 900}, {100, 17, 1300}, {100, 50, 2600}};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		unsigned without = cycle_of(rows[i].n, 0, 1, rows[i].khz);

		TEST_ASSERT_LESS_THAN_UINT(rows[i].most, cycle_of(rows[i].n, 1, 1, rows[i].khz));
		/* asked for each 10 s */
		TEST_ASSERT_LESS_THAN_UINT(without + 350, cycle_of(rows[i].n, 1, 100, rows[i].khz));
	}
}

/* Several convert under one pull-up. */
static void test_many_that_are_fed_by_the_wire_convert_together(void)
{
	TEST_ASSERT_LESS_THAN_UINT(2300, cycle_of(17, 4, 1, 100));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_one_that_is_fed_by_the_wire_hardly_slows_others);
	RUN_TEST(test_many_that_are_fed_by_the_wire_convert_together);
	return UNITY_END();
}
