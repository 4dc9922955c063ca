/* SPDX-License-Identifier: MIT */
/*
 * How soon outputs have their InitValue at a start at which many alarm items are armed, by engine,
 * native bus, driver and simulator in virtual time. I2C at 400 kHz.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

#define BOARDS 40
#define OUTPUTS 2 /* the first records: of a board without alarm item, and of one with */
#define RECORDS (OUTPUTS + 1 + BOARDS)
#define SOON_NS (100 * PLANT_MS)

static struct plant plant;
static int64_t good_ns[RECORDS + 1]; /* since the start */

void setUp(void)
{
	memset(good_ns, 0, sizeof(good_ns));
}

void tearDown(void)
{
	plant_end(&plant);
}

static void published(void *ctx)
{
	(void)ctx;
	for (unsigned i = 1; i <= RECORDS; i++)
		if (!good_ns[i] && ows_good(plant_sample(&plant, i).quality))
			good_ns[i] = plant.now - plant.start;
}

static char scenario[8192], rio[32768];

static void begin(bool alarm)
{
	size_t n = 0, m = 0;

	m += (size_t)snprintf(scenario, sizeof(scenario),
	                      "i2c speed 400\nchip DS2482-100 0x18\n"
	                      "DS18B20 28.000000000001 as boiler temperature 60\n"
	                      "DS2408 29.0000000000FF as lamps\n");
	n += (size_t)snprintf(rio, sizeof(rio),
	                      "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n"
	                      "  Item { Name \"lamp\" Path \"/29.0000000000FF/PIO.0\" Type bool\n"
	                      "    IO output InitValue \"1\" }\n"
	                      "  Item { Name \"relay\" Path \"/29.000000000028/PIO.0\" Type bool\n"
	                      "    IO output InitValue \"1\" }\n"
	                      "  Item { Name \"boiler\" Path \"/28.000000000001/temperature\"\n"
	                      "    Type double }\n");
	for (unsigned i = 1; i <= BOARDS; i++) {
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS2408 29.%012X as b%u\n", i, i);
		n += (size_t)snprintf(
			rio + n, sizeof(rio) - n,
			"  Item { Name \"in%u\" Path \"/29.%012X/sensed.BYTE\"\n"
			"    Type byte Uncached on Alarm %s LatchAlarm \"latch.BYTE\"\n"
			"    PorAlarm \"por\" SetAlarm \"set_alarm=133333331\"\n"
			"    ResetLatch \"latch.BYTE=0\" }\n",
			i, i, alarm ? "on" : "off");
	}
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	plant_begin(&plant, scenario, rio);
	plant.published = published;
	plant_run(&plant, plant.start + 30 * PLANT_S);
}

static void test_outputs_do_not_wait_while_alarms_are_armed(void)
{
	int64_t without[OUTPUTS + 1];

	begin(false);
	memcpy(without, good_ns, sizeof(without));
	plant_end(&plant);
	setUp();
	begin(true);
	for (unsigned i = 1; i <= OUTPUTS; i++) {
		TEST_ASSERT_GREATER_THAN_INT64(0, without[i]);
		TEST_ASSERT_GREATER_THAN_INT64(0, good_ns[i]);
		TEST_ASSERT_LESS_OR_EQUAL_INT64(without[i] + SOON_NS, good_ns[i]);
	}
	for (unsigned i = OUTPUTS + 1; i <= RECORDS; i++) {
		TEST_ASSERT_GREATER_THAN_INT64(0, good_ns[i]);
		TEST_ASSERT_LESS_OR_EQUAL_INT64(10 * PLANT_S, good_ns[i]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_outputs_do_not_wait_while_alarms_are_armed);
	return UNITY_END();
}
