/* SPDX-License-Identifier: MIT */
/*
 * A plant whose chips lose their power again and again, for a short time: no value of them that is
 * good is another than what they measure.
 */
#include <math.h>
#include <stdio.h>

#include "unity.h"

#include "src/public/ows_layout.h"
#include "tests/unit/aid/plant.h"

static struct plant plant;
static const char *const names[] = {"oven", "cold", "vdd", "vad", "vdd8", "vad8", "t1"};
static const double truths[] = {900, 21.5, 5, 2, 5, 2, 21.5};
#define ITEMS 7
static unsigned wrong[ITEMS], good[ITEMS];

void setUp(void)
{
}

void tearDown(void)
{
}

static void published(void *ctx)
{
	(void)ctx;
	for (unsigned i = 0; i < ITEMS; i++) {
		if (plant_sample(&plant, i + 1).quality < OWS_Q_GOOD)
			continue;
		good[i]++;
		wrong[i] += fabs(plant_number(&plant, i + 1) - truths[i]) > 0.1;
	}
}

static void run(const char *troubles, unsigned seconds)
{
	static const char chips[] =
		"i2c speed 400 combine any\n"
		"chip DS2482-100 0x18\n"
		"MAX31850 3B.000000000001 as m1 temperature 21.5 thermocouple 900\n"
		"DS2437 1E.000000000001 as d1 temperature 21.5 vdd 5 vad 2\n"
		"DS2438 26.000000000001 as d2 temperature 21.5 vdd 5 vad 2\n"
		"DS18B20 28.000000000001 as t1 temperature 21.5\n"
		"DS18B20 28.000000000002 as t2 temperature 21.5\n"
		"DS18B20 28.000000000003 as t3 temperature 21.5\n";
	static const char items[] =
		"OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.2\n"
		"  Item { Name oven Path \"/3B.000000000001/thermocouple\" Type double }\n"
		"  Item { Name cold Path \"/3B.000000000001/temperature\" Type double }\n"
		"  Item { Name vdd Path \"/1E.000000000001/VDD\" Type double Uncached on }\n"
		"  Item { Name vad Path \"/1E.000000000001/VAD\" Type double Uncached on }\n"
		"  Item { Name vdd8 Path \"/26.000000000001/VDD\" Type double Uncached on }\n"
		"  Item { Name vad8 Path \"/26.000000000001/VAD\" Type double Uncached on }\n"
		"  Item { Name t1 Path \"/28.000000000001/temperature\" Type double Uncached on }\n"
		"  Item { Name t2 Path \"/28.000000000002/temperature\" Type double Uncached on }\n"
		"  Item { Name t3 Path \"/28.000000000003/temperature\" Type double Uncached on }\n"
		"}\n";
	char scenario[2000];

	snprintf(scenario, sizeof(scenario), "%s%s", chips, troubles);
	plant_begin(&plant, scenario, items);
	plant.published = published;
	plant_run(&plant, plant.start + seconds * PLANT_S);
	plant_end(&plant);
	for (unsigned i = 0; i < ITEMS; i++) {
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, wrong[i], names[i]);
		TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(seconds, good[i], names[i]);
		wrong[i] = good[i] = 0;
	}
}

/* The bus asks a thermometer that has restarted for its supply: to a DS2438 that is Convert V. */
static void test_a_restart_of_others_makes_no_false_value_good(void)
{
	run("at 8s every 9s brownout m1\nat 3s every 1370ms brownout t1\n", 300);
}

static void test_a_restart_makes_no_false_value_good(void)
{
	run("at 8s every 2s brownout m1\nat 3s every 1370ms brownout d1\n"
	    "at 3s every 1270ms brownout d2\n",
	    100);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_restart_of_others_makes_no_false_value_good);
	RUN_TEST(test_a_restart_makes_no_false_value_good);
	return UNITY_END();
}
