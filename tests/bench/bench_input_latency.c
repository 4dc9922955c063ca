/* SPDX-License-Identifier: MIT */
/*
 * From a change at an input of a DS2408 to its sample in the image, while 50 thermometers are
 * scanned without pause: engine, native bus, driver and simulator on one virtual clock, I2C at
 * 400 kHz. Eight DS2408 with the alarm items of figure 3.3 of the manual, AlarmPeriod such that the
 * idle search of the alarms takes 4 or 10 % of the time; and the same inputs read in the cycle.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/ds2482/codes.h"
#include "tests/bench/aid.h"
#include "tests/unit/aid/plant.h"

#define THERMOMETERS 50
#define BOARDS 8
#define CHANGES 600
#define LISTS 101
#define LIST_NS (20 * PLANT_MS)
/* Waking of engine and bus threads on a small board. */
#define DELAY_NS (100 * PLANT_US)

static struct plant plant;
static struct {
	unsigned board;
	int64_t at, seen;
	double value;
} change;
static uint32_t seed = 1;

static uint32_t below(uint32_t n)
{
	seed = seed * 1664525u + 1013904223u;
	return (seed >> 8) % n;
}

static void write_scenario(char *text, size_t size)
{
	size_t n = (size_t)snprintf(text, size, "i2c speed 400\nchip DS2482-100 0x18\n");

	for (unsigned i = 0; i < THERMOMETERS; i++)
		n += (size_t)snprintf(text + n, size - n,
		                      "DS18B20 28.%08X%04X as t%u temperature %u\n",
		                      (i + 1) * 2654435761u, i, i, i % 60);
	for (unsigned i = 0; i < BOARDS; i++)
		n += (size_t)snprintf(text + n, size - n, "DS2408 29.%08X%04X as b%u\n",
		                      (i + 77) * 2654435761u, i, i);
}

/* The boards come first: records 1 to BOARDS. */
static void write_rio(char *text, size_t size, double alarm_period, unsigned per_factor)
{
	size_t n = (size_t)snprintf(text, size,
	                            "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n"
	                            "  AlarmPeriod %.4f\n",
	                            alarm_period ? alarm_period : 0.05);

	for (unsigned i = 0; i < BOARDS; i++) {
		n += (size_t)snprintf(
			text + n, size - n,
			"  Item {\n    Name \"b%u\"\n    Path \"/29.%08X%04X/sensed.BYTE\"\n"
			"    Type byte\n    IO input\n    Uncached on\n",
			i, (i + 77) * 2654435761u, i);
		if (alarm_period)
			n += (size_t)snprintf(text + n, size - n,
			                      "    Alarm on\n    LatchAlarm \"latch.BYTE\"\n"
			                      "    PorAlarm \"por\"\n"
			                      "    SetAlarm \"set_alarm=133333333\"\n"
			                      "    ResetLatch \"latch.BYTE=0\"\n");
		n += (size_t)snprintf(text + n, size - n, "  }\n");
	}
	for (unsigned i = 0; i < THERMOMETERS; i++)
		n += (size_t)snprintf(
			text + n, size - n,
			"  Item {\n    Name \"t%u\"\n    Path \"/28.%08X%04X/temperature12\"\n"
			"    Type double\n    IO input\n    Uncached on\n"
			"    PerFactor %u\n  }\n",
			i, (i + 1) * 2654435761u, i, per_factor);
	snprintf(text + n, size - n, "}\n");
}

static void published(void *ctx)
{
	(void)ctx;
	if (change.at && !change.seen && plant.now >= change.at &&
	    plant_number(&plant, 1 + change.board) == change.value)
		change.seen = plant.now;
}

static void begin(double alarm_period, unsigned per_factor)
{
	static char scenario[16384], rio[32768];

	write_scenario(scenario, sizeof(scenario));
	write_rio(rio, sizeof(rio), alarm_period, per_factor);
	memset(&change, 0, sizeof(change));
	plant_begin(&plant, scenario, rio);
	plant.answer_delay_ns = DELAY_NS;
	plant.published = published;
	plant_run(&plant, plant.start + 20 * PLANT_S);
}

/*
 * The wire's time of one search that finds no board in alarm: the median, as the search in the
 * background goes on. The thermometers, read once, are all in alarm, by the limits of the factory.
 */
static double idle_search_ms(void)
{
	double ms[LISTS];

	begin(LIST_NS / 1e9, 100000);
	for (int i = 0; i < LISTS;) {
		uint64_t wire = plant_count(&plant, "wire_us");
		uint64_t lists = plant_count(&plant, "directories");

		plant_run(&plant, plant.now + LIST_NS);
		if (plant_count(&plant, "directories") == lists + 1)
			ms[i++] = (double)(plant_count(&plant, "wire_us") - wire) / 1e3;
	}
	plant_end(&plant);
	return bench_percentile(ms, LISTS, 50);
}

static void one_change(void)
{
	struct sim_event *event = &plant.net->event[0];
	char name[8];

	change.board = below(BOARDS);
	snprintf(name, sizeof(name), "b%u", change.board);
	change.value = plant_number(&plant, 1 + change.board) == 255 ? 254 : 255;
	change.seen = 0;
	change.at = plant.now + 50 * PLANT_MS + below(1000000) * PLANT_US;
	event->slave = sim_net_slave(plant.net, name);
	event->curve = sim_constant(change.value == 255);
	event->at_ns = plant_time(&plant, change.at);
	event->done = false;
}

static void measure(const char *name, double alarm_period)
{
	struct sim_event event = {.what = SIM_SET, .done = true};
	static double ms[CHANGES];
	char line[64];

	begin(alarm_period, 1);
	event.input = 0;
	if (sim_net_add_event(plant.net, &event))
		exit(1);
	for (int i = 0; i < CHANGES; i++) {
		one_change();
		while (!change.seen && plant.now < change.at + 20 * PLANT_S)
			plant_run(&plant, plant.now + 100 * PLANT_MS);
		if (!change.seen) {
			fprintf(stderr, "input_latency: a change was never published\n");
			exit(1);
		}
		ms[i] = (double)(change.seen - change.at) / 1e6;
	}
	plant_end(&plant);
	snprintf(line, sizeof(line), "input_latency.%s", name);
	bench_distribution(line, ms, CHANGES, "ms");
}

int main(void)
{
	double idle = idle_search_ms();

	bench_line("alarm_search.idle.wire", idle, "ms");
	bench_line("alarm_search.idle.limit", (ds2482_reset_ns + 32 * ds2482_slot_ns) / 1e6, "ms");
	measure("alarm4", idle / 1e3 / 0.04);
	measure("alarm10", idle / 1e3 / 0.10);
	measure("cyclic", 0);
	return 0;
}
