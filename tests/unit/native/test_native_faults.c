/* SPDX-License-Identifier: MIT */
/*
 * How soon the signals of a device show a fault of it, and its end, by engine, bus and simulator in
 * virtual time: of one and of half of the devices of a wire of 50, by the engine's defaults.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define ALL 50
#define MOST 25 /* faulty ones */
#define PHASES 2
#define BEGINS_NS (20 * PLANT_S)
#define LASTS_NS (20 * PLANT_S) /* longer than a back-off that doubles would notice its end */
#define WATCH_NS (6 * PLANT_S)  /* after it */
#define SOON_NS (3 * PLANT_S)

static struct plant plant;

struct fault {
	const char *what; /* the event: "unplug", "corrupt" */
	const char *chip; /* of the faulty devices; the others are DS18B20 */
	unsigned code;
	const char *property;
	unsigned faulty;
	const char *how; /* more of the event */
};

/* Since the fault began, and since it ended. */
static struct {
	int64_t begins_ns, ends_ns;
	unsigned faulty;
	int64_t bad_ns[MOST], good_ns[MOST];
	int64_t oldest_ns; /* of the healthy ones' values, from the fault on */
} seen;

void setUp(void)
{
}

void tearDown(void)
{
}

static void published(void *ctx)
{
	(void)ctx;
	if (plant.now < seen.begins_ns)
		return;
	for (unsigned i = 0; i < seen.faulty; i++) {
		struct ows_sample sample = plant_sample(&plant, i + 1);
		bool good = ows_good(sample.quality);

		if (!good && !seen.bad_ns[i])
			seen.bad_ns[i] = plant.now - seen.begins_ns;
		if (!good)
			seen.good_ns[i] = 0;
		else if (plant.now >= seen.ends_ns && !seen.good_ns[i])
			seen.good_ns[i] = plant.now - seen.ends_ns;
	}
	for (unsigned i = seen.faulty; i < ALL; i++) {
		int64_t age = plant.now - plant_sample(&plant, i + 1).measured_ns;

		seen.oldest_ns = age > seen.oldest_ns ? age : seen.oldest_ns;
	}
}

static char scenario[16384], rio[32768];

static void set_out(const struct fault *fault, unsigned khz, int64_t begins_ms)
{
	size_t n = 0, m = 0;

	m += (size_t)snprintf(scenario, sizeof(scenario), "i2c speed %u\nchip DS2482-100 0x18\n",
	                      khz);
	n += (size_t)snprintf(rio, sizeof(rio),
	                      "OwsDrv {\n  TargetName \"sim:plant\"\n"
	                      "  Period 0.1\n");
	for (unsigned i = 0; i < ALL; i++) {
		bool faulty = i < fault->faulty;
		unsigned code = faulty ? fault->code : 0x28, id = (i + 2) * 2654435761u;

		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "%s %02X.%08X%04X as d%u\n", faulty ? fault->chip : "DS18B20",
		                      code, id, i, i);
		n += (size_t)snprintf(rio + n, sizeof(rio) - n,
		                      "  Item {\n    Name \"t%u\"\n    Path \"/%02X.%08X%04X/%s\"\n"
		                      "    Type double\n    IO input\n    Uncached on\n  }\n",
		                      i, code, id, i, faulty ? fault->property : "temperature");
	}
	for (unsigned i = 0; i < fault->faulty; i++)
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "at %dms %s d%u%s for %dms\n", (int)begins_ms, fault->what, i,
		                      fault->how, (int)(LASTS_NS / PLANT_MS));
	snprintf(rio + n, sizeof(rio) - n, "}\n");
}

static int64_t most(const int64_t *ns, unsigned n)
{
	int64_t most = 0;

	for (unsigned i = 0; i < n; i++) {
		if (!ns[i])
			return INT64_MAX / 2;
		most = ns[i] > most ? ns[i] : most;
	}
	return most;
}

/* Half of a wire that sends what is wrong: 150 readings beside those of the other half. */
static int64_t notice_within(const struct fault *fault, unsigned khz)
{
	if (fault->faulty == 1 || strcmp(fault->what, "corrupt") != 0)
		return SOON_NS;
	return khz == 400 ? 7 * PLANT_S / 2 : 9 * PLANT_S / 2;
}

static void run(const struct fault *fault, unsigned khz)
{
	int64_t notice = 0, over = 0, oldest = 0;
	char text[200];

	for (unsigned phase = 0; phase < PHASES; phase++) {
		int64_t begins_ms = BEGINS_NS / PLANT_MS + 470 * phase;

		set_out(fault, khz, begins_ms);
		memset(&seen, 0, sizeof(seen));
		plant_begin(&plant, scenario, rio);
		plant.published = published;
		seen.begins_ns = plant.start + begins_ms * PLANT_MS;
		seen.ends_ns = seen.begins_ns + LASTS_NS;
		seen.faulty = fault->faulty;
		plant_run(&plant, seen.ends_ns + WATCH_NS);
		plant_end(&plant);
		int64_t bad = most(seen.bad_ns, fault->faulty),
			good = most(seen.good_ns, fault->faulty);
		notice = bad > notice ? bad : notice;
		over = good > over ? good : over;
		oldest = seen.oldest_ns > oldest ? seen.oldest_ns : oldest;
	}
	snprintf(text, sizeof(text),
	         "%s of %u %s at %u kHz: noticed %d ms, over %d ms, others %d ms", fault->what,
	         fault->faulty, fault->chip, khz, (int)(notice / PLANT_MS), (int)(over / PLANT_MS),
	         (int)(oldest / PLANT_MS));
	TEST_MESSAGE(text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(notice_within(fault, khz), notice, text);
	/* Half of a wire that comes back waits for the conversions of the other half, too. */
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(fault->faulty > 1 ? 4 * PLANT_S : SOON_NS, over, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(6 * PLANT_S, oldest, text);
}

static const struct fault faults[] = {
	{"unplug", "DS18B20", 0x28, "temperature", 1, ""},
	{"unplug", "DS2408", 0x29, "sensed.BYTE", 1, ""},
	{"unplug", "DS2760", 0x30, "volt", 1, ""},
	{"unplug", "DS2438", 0x26, "VAD", 1, ""},
	{"unplug", "DS18B20", 0x28, "temperature", 25, ""},
	{"corrupt", "DS18B20", 0x28, "temperature", 1, " each 1 seed 7"},
	{"corrupt", "DS18B20", 0x28, "temperature", 25, " each 1 seed 7"},
	{"corrupt", "DS2438", 0x26, "VAD", 1, " each 1 seed 7"},
	{"corrupt", "DS2408", 0x29, "sensed.BYTE", 1, " each 1 seed 7"},
};

static void test_a_fault_is_noticed_and_over_within_three_seconds(void)
{
	for (unsigned khz = 100; khz <= 400; khz += 300)
		for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++)
			run(&faults[i], khz);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_fault_is_noticed_and_over_within_three_seconds);
	return UNITY_END();
}
