/* SPDX-License-Identifier: MIT */
/*
 * A chip that answers whole and says by itself that it has no value: its signal is bad at the first
 * reading, whatever MaxRetries is, and good again at the first one that has a value.
 */
#include <stdio.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define MANY 16
#define BEGINS_NS (20 * PLANT_S)
#define ENDS_NS (40 * PLANT_S)

static const struct {
	const char *chip;
	unsigned code;
	const char *property, *input;
	double healthy, fault;
	uint8_t quality;
	const char *start; /* of another input */
} rows[] = {
	{"MAX31850", 0x3b, "thermocouple", "open_circuit", 0, 1, OWS_Q_DEVICE},
	{"MAX31850", 0x3b, "thermocouple", "ground_short", 0, 1, OWS_Q_DEVICE},
	{"MAX31850", 0x3b, "thermocouple", "vdd_short", 0, 1, OWS_Q_DEVICE},
	{"DS2438", 0x26, "VDD", "vdd", 5, 0, OWS_Q_DEVICE},
	{"DS2438", 0x26, "humidity", "vdd", 5, 0, OWS_Q_DEVICE, "vad 2.5"},
	{"TMP1826", 0x26, "temperature", "temperature", 20, 150, OWS_Q_SENSOR},
	{"DS2780", 0x32, "typeS/temperature", "vis", 1, 51.1, OWS_Q_SENSOR},
	{"DS2760", 0x30, "typeS/temperature", "vis", 1, 51.1, OWS_Q_SENSOR},
};
#define ROWS (sizeof(rows) / sizeof(rows[0]))

static struct plant plant;
static int64_t bad_ns, back_ns; /* since the fault began and ended; 0: not yet */
static int64_t reads_apart_ns;  /* the longest time between two readings before */
static struct ows_sample last;

void setUp(void)
{
}

void tearDown(void)
{
}

static void published(void *ctx)
{
	const struct ows_sample sample = plant_sample(&plant, 1);
	int64_t passed = plant.now - plant.start;

	(void)ctx;
	if (passed > BEGINS_NS / 2 && passed < BEGINS_NS && sample.count != last.count &&
	    sample.measured_ns - last.measured_ns > reads_apart_ns)
		reads_apart_ns = sample.measured_ns - last.measured_ns;
	if (!bad_ns && passed >= BEGINS_NS && sample.quality < OWS_Q_GOOD)
		bad_ns = passed - BEGINS_NS;
	if (!back_ns && passed >= ENDS_NS && sample.quality >= OWS_Q_GOOD)
		back_ns = passed - ENDS_NS;
	last = sample;
}

/* The chip and so many thermometers beside it. */
static void run(size_t row, unsigned others)
{
	char scenario[4000], rio[8000], text[120];
	size_t n = 0, m = 0;

	bad_ns = back_ns = 0;
	reads_apart_ns = 0;
	m += (size_t)snprintf(scenario, sizeof(scenario),
	                      "chip DS2482-100 0x18\n%s %02X.000000000001 as it %s\n"
	                      "at 0s set it %s %g\nat 20s set it %s %g\nat 40s set it %s %g\n",
	                      rows[row].chip, rows[row].code,
	                      rows[row].start ? rows[row].start : "", rows[row].input,
	                      rows[row].healthy, rows[row].input, rows[row].fault, rows[row].input,
	                      rows[row].healthy);
	n += (size_t)snprintf(rio, sizeof(rio),
	                      "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n"
	                      "  MaxRetries 20\n  Item {\n    Name \"it\"\n"
	                      "    Path \"/%02X.000000000001/%s\"\n    Type double\n"
	                      "    IO input\n  }\n",
	                      rows[row].code, rows[row].property);
	for (unsigned i = 0; i < others; i++) {
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS18B20 28.0000000001%02X temperature 21.5\n", i);
		n += (size_t)snprintf(rio + n, sizeof(rio) - n,
		                      "  Item {\n    Name \"t%u\"\n    Type double\n"
		                      "    Path \"/28.0000000001%02X/temperature\"\n"
		                      "    IO input\n  }\n",
		                      i, i);
	}
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	plant_begin(&plant, scenario, rio);
	plant.published = published;
	plant_run(&plant, plant.start + BEGINS_NS);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, plant_sample(&plant, 1).quality,
	                               rows[row].property);
	plant_run(&plant, plant.start + ENDS_NS);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(rows[row].quality, plant_sample(&plant, 1).quality,
	                               rows[row].property);
	plant_run(&plant, plant.start + ENDS_NS + 10 * PLANT_S);
	plant_end(&plant);
	snprintf(text, sizeof(text),
	         "%s %s %s, %u others: %d ms between readings, bad after %d ms, back after %d ms",
	         rows[row].chip, rows[row].property, rows[row].input, others,
	         (int)(reads_apart_ns / PLANT_MS), (int)(bad_ns / PLANT_MS),
	         (int)(back_ns / PLANT_MS));
	TEST_MESSAGE(text);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, bad_ns, text);
	/* the one under way may have seen it healthy, and a zero is measured twice */
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(2 * reads_apart_ns + PLANT_S, bad_ns, text);
	TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, back_ns, text);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(reads_apart_ns + 2 * PLANT_S, back_ns, text);
}

static void test_what_a_chip_says_of_itself_is_in_force_at_once(void)
{
	for (size_t row = 0; row < ROWS; row++)
		run(row, 0);
}

static void test_what_a_chip_says_of_itself_is_in_force_at_once_among_many(void)
{
	for (size_t row = 0; row < ROWS; row++)
		run(row, MANY);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_a_chip_says_of_itself_is_in_force_at_once);
	RUN_TEST(test_what_a_chip_says_of_itself_is_in_force_at_once_among_many);
	return UNITY_END();
}
