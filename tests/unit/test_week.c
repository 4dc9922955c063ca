/* SPDX-License-Identifier: MIT */
/*
 * A week of owsd's life with everything that can go wrong: engine, native bus, driver and simulated
 * chips on one virtual clock. Twenty minutes at a time: faults of all kinds at random for some of
 * them, over each other, then quiet. At any time a value that is good is what the scenario says,
 * and nothing is stuck; at the end of each quiet all is good and the relays are as commanded.
 *
 * The unit tests live through some hours; `test_week 168` (make soak) through the week.
 */
#include "plant.h"
#include "unity.h"

#include "hal/sim/scenario.h"
#include "src/libows/ows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EPISODE  (1200 * PLANT_S)
#define FAULTS   (500 * PLANT_S) /* of an episode */
#define ALONE    (100 * PLANT_S) /* the longest fault */
#define STUCK    (180 * PLANT_S) /* so long nothing may go untried: the back-off is 60 s at most */
#define SPINS    5000            /* steps of the engine in 20 s */
#define HOURS    6

static const char scenario[] =
	"i2c speed 100 combine one-read\n"
	"chip DS2482-100 0x18\n"
	"DS18B20 28.0000000000B1 as boiler temperature sine 60 6 2h\n"
	"DS18B20 28.0000000000B2 as hot temperature sine 82 8 3h\n" /* through 85, the power-on value */
	"DS2408 29.000000000001 as board\n"
	"chip DS2482-800 0x19\n"
	"channel 3\n"
	"DS18B20 28.0000000000A3 as outside parasite temperature sine 8 12 1d\n"
	"channel 6\n"
	"DS2438 26.000000000001 as air temperature sine 22 3 4h vdd 5.0\n";

static const char rio[] =
	"OwsDrv {\n"
	"  TargetName \"sim:plant\"\n  Period 10\n  AlarmPeriod 2\n"
	"  Item { Name \"boiler\" Path \"/28.0000000000B1/temperature12\"\n"
	"         Type double IO input Uncached on }\n"
	"  Item { Name \"hot\" Path \"/28.0000000000B2/temperature12\"\n"
	"         Type double IO input Uncached on }\n"
	"  Item { Name \"outside\" Path \"/28.0000000000A3/temperature11\"\n"
	"         Type double IO input Uncached on }\n"
	"  Item { Name \"air\" Path \"/26.000000000001/temperature\"\n"
	"         Type double IO input Uncached on }\n"
	"  Item { Name \"sensed\" Path \"/29.000000000001/sensed.BYTE\"\n"
	"         Type byte IO input Alarm on\n"
	"         LatchAlarm \"latch.BYTE\" PorAlarm \"por\" SetAlarm \"set_alarm=133333333\"\n"
	"         ResetLatch \"latch.BYTE=0\" }\n"
	"  Item { Name \"relays\" Path \"/29.000000000001/PIO.BYTE\"\n"
	"         Type byte IO output InitValue \"0\" }\n"
	"}\n";

enum { BOILER = 1, HOT, OUTSIDE, AIR, SENSED, RELAYS, RECORDS = RELAYS };
static const char *const names[] = {
	[BOILER] = "boiler", [HOT] = "hot", [OUTSIDE] = "outside", [AIR] = "air",
};

static const char *const faults[] = {
	"unplug boiler for",       "unplug outside for",
	"unplug board for",        "unplug air for",
	"brownout hot",                "brownout outside",
	"brownout board",              "brownout air",
	"corrupt hot each 3 for",  "corrupt board chance 0.3 seed 5 for",
	"corrupt air each 2 for",  "corrupt outside each 1 for",
	"short 0x18 for",          "short 0x19.3 for",
	"short 0x19.6 for",        "stick 0x18",
	"stick 0x19",                  "jam 0x18 for",
	"jam 0x19 for",            "reset 0x18",
	"reset 0x19",                  "sleep 0x18 for",
	"sleep 0x19 for",          "refuse 0x18 each 7 for",
	"refuse 0x19 for",         "refuse-data 0x18 each 11 for",
	"refuse-data 0x19 each 5 for", "remove adapter for",
};
#define KINDS (sizeof(faults) / sizeof(faults[0]))

static struct plant plant;
static uint32_t seed, first_seed;
static unsigned hours = HOURS;
static int64_t measured[RECORDS + 1];
static struct ows_sample last[RECORDS + 1];
/* The inputs of the board, pins 4 to 7, and what they were before. */
static struct {
	int64_t since;
	unsigned pins;
} inputs[4];
static unsigned relays;
static uint64_t checked;
static char history[8][64];
static unsigned events;

void setUp(void)
{
}

void tearDown(void)
{
}

static uint32_t below(uint32_t n)
{
	seed = seed * 1664525u + 1013904223u;
	return (seed >> 8) % n;
}

static const char *told(const char *what, unsigned record)
{
	static char text[900];
	size_t n = (size_t)snprintf(text, sizeof(text), "%s: record %u at %.3f s, seed %u;", what,
	                            record, (double)(plant.now - plant.start) / 1e9, first_seed);

	for (unsigned i = events > 8 ? events - 8 : 0; i < events; i++)
		n += (size_t)snprintf(text + n, sizeof(text) - n, " %s;", history[i % 8]);
	return text;
}

static void happen(const char *line)
{
	char why[200] = "";

	snprintf(history[events % 8], sizeof(history[0]), "%.1f %s",
	         (double)(plant.now - plant.start) / 1e9, line);
	events++;
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_event(plant.net, line, plant.now, why, sizeof(why)), why);
}

/* Does the value agree with the curve, as it was when the chip measured? */
static bool true_temperature(unsigned record, const struct ows_sample *sample)
{
	const struct sim_slave *slave = sim_net_slave(plant.net, names[record]);
	double value = plant_number(&plant, record);

	return fabs(value - sim_input_at(slave, 0, plant_time(&plant, sample->measured_ns))) < 0.15;
}

static bool true_inputs(const struct ows_sample *sample)
{
	unsigned pins = (unsigned)sample->value >> 4;

	for (unsigned i = 0; i < 4; i++) {
		/* What was replaced a second before the measurement is not true any more. */
		if (i > 0 && inputs[i - 1].since < sample->measured_ns - PLANT_S)
			break;
		if (inputs[i].pins == pins)
			return true;
	}
	return false;
}

static void published(void *ctx)
{
	(void)ctx;
	for (unsigned record = BOILER; record <= SENSED; record++) {
		struct ows_sample sample = plant_sample(&plant, record);

		if (sample.count == last[record].count && sample.quality == last[record].quality)
			continue;
		last[record] = sample;
		if (!ows_good(sample.quality))
			continue;
		checked++;
		if (sample.measured_ns < measured[record])
			TEST_FAIL_MESSAGE(told("older than the one before", record));
		if (sample.measured_ns > plant.now)
			TEST_FAIL_MESSAGE(told("from the future", record));
		measured[record] = sample.measured_ns;
		if (record == SENSED ? !true_inputs(&sample) : !true_temperature(record, &sample))
			TEST_FAIL_MESSAGE(told("a false value is good", record));
	}
}

static void nothing_is_stuck(void)
{
	for (unsigned record = BOILER; record <= RELAYS; record++) {
		struct ows_sample sample = plant_sample(&plant, record);
		bool down = sample.quality == OWS_Q_TARGET;

		if (record != RELAYS && !down && sample.tried_ns < plant.now - STUCK)
			TEST_FAIL_MESSAGE(told("stuck", record));
	}
}

static void all_is_well(void)
{
	for (unsigned record = BOILER; record <= RELAYS; record++) {
		struct ows_sample sample = plant_sample(&plant, record);

		if (!ows_good(sample.quality))
			TEST_FAIL_MESSAGE(told(ows_quality_text(sample.quality), record));
		if (record != RELAYS && sample.measured_ns < plant.now - 70 * PLANT_S)
			TEST_FAIL_MESSAGE(told("good and old", record));
	}
	if (plant_sample(&plant, RELAYS).value != relays)
		TEST_FAIL_MESSAGE(told("not as commanded", RELAYS));
	/* A transistor that conducts pulls its pin low: the relays as the chip has them. */
	if (((unsigned)plant_sample(&plant, SENSED).value & 0xf) != (~relays & 0xf))
		TEST_FAIL_MESSAGE(told("the chip has other outputs", SENSED));
	if ((unsigned)plant_sample(&plant, SENSED).value >> 4 != inputs[0].pins)
		TEST_FAIL_MESSAGE(told("not as the inputs are", SENSED));
}

static void change_inputs(void)
{
	char line[40];
	unsigned pin = below(4);

	memmove(inputs + 1, inputs, sizeof(inputs) - sizeof(inputs[0]));
	inputs[0].pins ^= 1u << pin;
	inputs[0].since = plant.now;
	snprintf(line, sizeof(line), "set board pin.%u %u", 4 + pin, inputs[0].pins >> pin & 1);
	happen(line);
}

/* An engine that asks to be called at once for ever burns a processor. */
static void nothing_spins(uint64_t steps)
{
	if (plant.engine_steps - steps > SPINS)
		TEST_FAIL_MESSAGE(told("the engine spins", 0));
}

static void run_until(int64_t t)
{
	while (plant.now < t) {
		int64_t next = plant.now + 20 * PLANT_S;
		uint64_t steps = plant.engine_steps;

		plant_run(&plant, next < t ? next : t);
		nothing_is_stuck();
		nothing_spins(steps);
	}
}

static const char *fault(char *line, size_t size)
{
	const char *text = faults[below(KINDS)];
	size_t len = strlen(text);
	unsigned seconds = 1 + below(ALONE / PLANT_S);

	if (strcmp(text + len - 4, " for") == 0)
		snprintf(line, size, "%s %us", text, seconds);
	else
		snprintf(line, size, "%s", text);
	return line;
}

static void episode(void)
{
	int64_t begun = plant.now, quiet = begun + FAULTS - ALONE;
	char line[64];

	while (plant.now < quiet) {
		switch (below(4)) {
		case 0:
			change_inputs();
			break;
		case 1:
			relays = below(16);
			plant_set(&plant, RELAYS, relays);
			break;
		default:
			happen(fault(line, sizeof(line)));
		}
		run_until(plant.now + (1 + below(100000)) * PLANT_MS);
	}
	run_until(begun + EPISODE);
	all_is_well();
	change_inputs();
	run_until(plant.now + 10 * PLANT_S);
	all_is_well();
}

static void test_through_all_faults_no_false_value_is_good_and_all_is_well_again(void)
{
	char message[64];
	int64_t end;

	snprintf(message, sizeof(message), "seed %u, %u hours", seed, hours);
	TEST_MESSAGE(message);
	for (unsigned i = 0; i < 4; i++)
		inputs[i].pins = 0xf;
	plant_begin(&plant, scenario, rio);
	plant.answer_delay_ns = 100 * PLANT_US;
	plant.published = published;
	inputs[0].since = plant.start;
	end = plant.start + hours * 3600 * PLANT_S;
	run_until(plant.start + 120 * PLANT_S);
	all_is_well();
	while (plant.now < end)
		episode();
	TEST_ASSERT_GREATER_THAN_UINT64(hours * 1000, checked);
	plant_end(&plant);
}

int main(int argc, char **argv)
{
	if (argc > 1)
		hours = (unsigned)strtoul(argv[1], NULL, 10);
	first_seed = seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
	UNITY_BEGIN();
	RUN_TEST(test_through_all_faults_no_false_value_is_good_and_all_is_well_again);
	return UNITY_END();
}
