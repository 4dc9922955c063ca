/* SPDX-License-Identifier: MIT */
/*
 * A chip whose answers are wrong from now on, each of them: how long its signal stays good, with
 * the engine's defaults (MaxRetries 3), alone on its wire and among many.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define MANY 50
#define BREAKS_NS (20 * PLANT_S)

static struct plant plant;
static struct ows_sample broken;
static int64_t bad_ns;
static bool target_down;

void setUp(void)
{
	bad_ns = 0;
	target_down = false;
}

void tearDown(void)
{
}

static void published(void *ctx)
{
	struct ows_sample sample = plant_sample(&plant, 1);

	(void)ctx;
	if (plant.now < plant.start + BREAKS_NS)
		return;
	if (!bad_ns && sample.quality < OWS_Q_GOOD) {
		bad_ns = plant.now - plant.start - BREAKS_NS;
		broken = sample;
	}
	target_down |= sample.quality == OWS_Q_TARGET;
}

/* The chip, and so many thermometers beside it. */
static void run(const char *chip, unsigned code, const char *property, bool uncached,
                unsigned others)
{
	static char scenario[8192], rio[16384];
	size_t n = 0, m = 0;

	m += (size_t)snprintf(scenario, sizeof(scenario),
	                      "chip DS2482-100 0x18\n%s %02X.000000000001 as it%s\n"
	                      "at 20s corrupt it each 1 seed 7\n",
	                      chip, code, code == 0x26 ? " vad 2" : "");
	n += (size_t)snprintf(rio, sizeof(rio),
	                      "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n  Item {\n"
	                      "    Name \"it\"\n    Path \"/%02X.000000000001/%s\"\n"
	                      "    Type double\n    IO input\n%s  }\n",
	                      code, property, uncached ? "    Uncached on\n" : "");
	for (unsigned i = 0; i < others; i++) {
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS18B20 28.%08X%04X temperature %u\n", (i + 2) * 2654435761u,
		                      i, 10 + i % 60);
		n += (size_t)snprintf(
			rio + n, sizeof(rio) - n,
			"  Item {\n    Name \"t%u\"\n    Path \"/28.%08X%04X/temperature\"\n"
			"    Type double\n    IO input\n  }\n",
			i, (i + 2) * 2654435761u, i);
	}
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	plant_begin(&plant, scenario, rio);
	plant.published = published;
	plant_run(&plant, plant.start + BREAKS_NS);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, plant_sample(&plant, 1).quality, chip);
	plant_run(&plant, plant.start + BREAKS_NS + 60 * PLANT_S);
	plant_end(&plant);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, bad_ns, chip);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_DEVICE, broken.quality, chip);
	TEST_ASSERT_FALSE_MESSAGE(target_down, chip);
	char text[100];
	snprintf(text, sizeof(text), "%s: bad after %d ms", chip, (int)(bad_ns / 1000000));
	TEST_MESSAGE(text);
}

/* Those that answer with so many bits that the wrong one is always among them. */
static void test_a_chip_whose_checksums_are_wrong_is_bad_within_three_seconds(void)
{
	static const struct {
		const char *chip;
		unsigned code;
		const char *property;
	} chips[] = {
		{"DS18S20", 0x10, "temperature"},  {"DS1822", 0x22, "temperature"},
		{"DS18B20", 0x28, "temperature"},  {"DS1825", 0x3b, "temperature"},
		{"DS28EA00", 0x42, "temperature"}, {"DS2408", 0x29, "sensed.BYTE"},
		{"DS2423", 0x1d, "counter.A"},     {"DS2438", 0x26, "VAD"},
		{"DS2438", 0x26, "humidity"},      {"DS2450", 0x20, "volt.A"},
	};

	for (size_t i = 0; i < sizeof(chips) / sizeof(chips[0]); i++) {
		setUp();
		run(chips[i].chip, chips[i].code, chips[i].property, false, 0);
		TEST_ASSERT_LESS_THAN_INT64_MESSAGE(3 * PLANT_S, bad_ns, chips[i].chip);
	}
}

/* A result that could not be read is read again by the next try, which converts nothing. */
static void test_one_that_is_never_answered_from_what_is_kept_is_bad_as_soon(void)
{
	run("DS18B20", 0x28, "temperature", true, 0);
	TEST_ASSERT_LESS_THAN_INT64(3 * PLANT_S, bad_ns);
}

static void test_among_many_it_is_the_device_that_is_bad_and_not_the_target(void)
{
	run("DS18B20", 0x28, "temperature", false, MANY);
	TEST_ASSERT_LESS_THAN_INT64(10 * PLANT_S, bad_ns);
	setUp();
	run("DS18B20", 0x28, "temperature", true, MANY);
	TEST_ASSERT_LESS_THAN_INT64(20 * PLANT_S, bad_ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_chip_whose_checksums_are_wrong_is_bad_within_three_seconds);
	RUN_TEST(test_one_that_is_never_answered_from_what_is_kept_is_bad_as_soon);
	RUN_TEST(test_among_many_it_is_the_device_that_is_bad_and_not_the_target);
	return UNITY_END();
}
