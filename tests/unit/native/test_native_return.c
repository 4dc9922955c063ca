/* SPDX-License-Identifier: MIT */
/*
 * What was away comes back: an adapter, half of the chips of a wire. The first value and all values
 * are there as soon as after a start.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define AWAY_NS (30 * PLANT_S)
#define MOST 128

static struct plant plant;
static unsigned signals, checked; /* those that are looked at: the first */
static int64_t from_ns;           /* what is below counts from then on */
static int64_t first_ns, all_ns, bad_ns;
static bool seen[MOST];

void setUp(void)
{
}

void tearDown(void)
{
}

static void look_from(int64_t ns)
{
	from_ns = ns;
	first_ns = all_ns = bad_ns = 0;
	memset(seen, 0, sizeof(seen));
}

static void published(void *ctx)
{
	unsigned good = 0, all = 0;

	(void)ctx;
	if (plant.now < from_ns)
		return;
	for (unsigned i = 0; i < checked; i++) {
		struct ows_sample sample = plant_sample(&plant, i + 1);

		/* measured since then: "good" alone may be of before */
		seen[i] |= ows_good(sample.quality) && sample.measured_ns >= from_ns;
		all += seen[i];
		good += ows_good(sample.quality);
	}
	if (!first_ns && all)
		first_ns = plant.now - from_ns;
	if (!all_ns && all == checked)
		all_ns = plant.now - from_ns;
	if (!bad_ns && !good)
		bad_ns = plant.now - from_ns;
}

static void begin(const char *scenario, const char *items, unsigned count)
{
	static char rio[16384];

	snprintf(rio, sizeof(rio), "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n%s}\n",
	         items);
	plant_begin(&plant, scenario, rio);
	plant.published = published;
	signals = checked = count;
	look_from(plant.start);
}

static size_t add_item(char *rio, size_t size, unsigned i, const char *path)
{
	return (size_t)snprintf(rio, size,
	                        "  Item {\n    Name \"s%u\"\n    Path \"%s\"\n    Type double\n"
	                        "    IO input\n    Uncached on\n  }\n",
	                        i, path);
}

/* 20 parts, 25 signals, as a house has them. */
static const char parts[] =
	"i2c speed 100 combine any\nchip DS2482-100 0x18\n"
	"DS18B20 28.000000000001 as p1\nDS18B20 28.000000000002 as p2\nDS18B20 28.000000000003 as p3\n"
	"DS18B20 28.000000000004 as p4\nDS18B20 28.000000000005 as p5\nDS18B20 28.000000000006 as p6\n"
	"DS18S20 10.000000000001 as p7\nDS1822 22.000000000001 as p8\nDS28EA00 42.000000000001 as p9\n"
	"MAX31850 3B.000000000001 as p10 thermocouple 900\nDS1825 3B.000000000002 as p11\n"
	"DS2438 26.000000000001 as p12 vad 2\nDS2437 1E.000000000001 as p13 vad 2\nTMP1826 26.000000000002 as p14\n"
	"DS2408 29.000000000001 as p15\nDS2413 3A.000000000001 as p16\nDS2423 1D.000000000001 as p17\n"
	"DS2450 20.000000000001 as p18 volt.A 2\nDS2406 12.000000000001 as p19\nDS1921G 21.000000000001 as p20\n";
#define PARTS 20
static const char *const paths[] = {
	"/28.000000000001/temperature",  "/28.000000000002/temperature",
	"/28.000000000003/temperature",  "/28.000000000004/temperature",
	"/28.000000000005/temperature",  "/28.000000000006/temperature",
	"/10.000000000001/temperature",  "/22.000000000001/temperature",
	"/42.000000000001/temperature",  "/3B.000000000001/temperature",
	"/3B.000000000001/thermocouple", "/3B.000000000002/temperature",
	"/26.000000000001/temperature",  "/26.000000000001/VAD",
	"/26.000000000001/VDD",          "/1E.000000000001/VAD",
	"/1E.000000000001/temperature",  "/26.000000000002/temperature",
	"/29.000000000001/sensed.BYTE",  "/3A.000000000001/sensed.BYTE",
	"/1D.000000000001/counter.A",    "/20.000000000001/volt.A",
	"/20.000000000001/volt.B",       "/12.000000000001/sensed.A",
	"/1D.000000000001/counter.B",
};
#define PATHS (sizeof(paths) / sizeof(paths[0]))

static void adapter_away_for(unsigned ms)
{
	static char scenario[4096], rio[8192];
	char text[160];
	size_t n = 0, m;

	m = (size_t)snprintf(scenario, sizeof(scenario), "%sat 30s remove adapter for %ums\n",
	                     parts, ms);
	for (unsigned i = 1; i <= PARTS; i++) /* they get their supply from it */
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "at 30s unplug p%u for %ums\n", i, ms);
	for (unsigned i = 0; i < PATHS; i++)
		n += add_item(rio + n, sizeof(rio) - n, i, paths[i]);
	begin(scenario, rio, PATHS);
	plant_run(&plant, plant.start + AWAY_NS);
	int64_t start_first = first_ns, start_all = all_ns;
	for (unsigned i = 0; i < PATHS; i++)
		if (!seen[i])
			TEST_MESSAGE(paths[i]);
	TEST_ASSERT_GREATER_THAN_INT64(0, start_all);
	look_from(plant.start + AWAY_NS + (int64_t)ms * PLANT_MS);
	plant_run(&plant, from_ns + 40 * PLANT_S);
	plant_end(&plant);
	snprintf(text, sizeof(text),
	         "start: first %d, all %d ms; away for %u ms: first %d, all %d ms",
	         (int)(start_first / PLANT_MS), (int)(start_all / PLANT_MS), ms,
	         (int)(first_ns / PLANT_MS), (int)(all_ns / PLANT_MS));
	TEST_MESSAGE(text);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, all_ns, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(3 * PLANT_S, first_ns, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(start_all + PLANT_S, all_ns, text);
}

static void test_an_adapter_that_returns_gives_its_values_as_after_a_start(void)
{
	for (unsigned ms = 300; ms < 40000; ms += 100 + ms / 2)
		adapter_away_for(ms);
}

/* In the order of the items those that are pulled come first; on the wire they are mixed. */
static void half_of_the_wire(unsigned khz, unsigned wire, int most_ms)
{
	static char scenario[16384], rio[16384];
	char text[160], path[40];
	size_t n = 0, m = 0;
	int64_t bad;

	m += (size_t)snprintf(scenario, sizeof(scenario),
	                      "i2c speed %u combine any\nchip DS2482-100 0x18\n", khz);
	for (unsigned i = 0; i < wire; i++) {
		unsigned id = (i + 2) * 2654435761u;

		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS18B20 28.%08X%04X as t%u temperature %u\n", id, i, i,
		                      10 + i);
		snprintf(path, sizeof(path), "/28.%08X%04X/temperature", id, i);
		n += add_item(rio + n, sizeof(rio) - n, i, path);
	}
	for (unsigned i = 0; i < wire / 2; i++)
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "at %ums unplug t%u for 30s\n", 30000 + 3 * i, i);
	begin(scenario, rio, wire);
	plant_run(&plant, plant.start + AWAY_NS);
	checked = wire / 2;
	look_from(plant.start + AWAY_NS);
	plant_run(&plant, plant.start + AWAY_NS + 30 * PLANT_S);
	bad = bad_ns;
	look_from(plant.start + AWAY_NS + 30 * PLANT_S);
	plant_run(&plant, from_ns + 30 * PLANT_S);
	plant_end(&plant);
	snprintf(text, sizeof(text), "%u kHz: all of %u of %u bad after %d ms, back after %d ms",
	         khz, wire / 2, wire, (int)(bad / PLANT_MS), (int)(all_ns / PLANT_MS));
	TEST_MESSAGE(text);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, bad, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(wire * 50 * PLANT_MS, bad, text);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, all_ns, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(most_ms * PLANT_MS, all_ns, text);
}

static void test_half_of_a_wire_is_bad_soon_and_back_soon(void)
{
	half_of_the_wire(100, 50, 3000);
	half_of_the_wire(400, 50, 3000);
	half_of_the_wire(100, 100, 5000);
	half_of_the_wire(400, 100, 5000);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_adapter_that_returns_gives_its_values_as_after_a_start);
	RUN_TEST(test_half_of_a_wire_is_bad_soon_and_back_soon);
	return UNITY_END();
}
