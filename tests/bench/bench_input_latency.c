/* SPDX-License-Identifier: MIT */
/*
 * From a change at an input of a DS2408 to its sample in the image, while 50 thermometers are
 * scanned without pause: engine, native bus, driver and simulator on one virtual clock, I2C at
 * 400 kHz. Eight DS2408 with the alarm items of figure 3.3 of the manual, AlarmPeriod such that the
 * idle search of the alarms takes 4 or 10 % of the time; and the same inputs read in the cycle.
 */
#include "aid.h"

#include "hal/ds2482/codes.h"
#include "tests/unit/plant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THERMOMETERS 50
#define BOARDS       8
#define CHANGES      600
/* Waking of engine and bus threads on a small board. */
#define DELAY_NS     (100 * PLANT_US)

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

static void write_scenario(char *text, size_t size, unsigned thermometers, const char *combine)
{
	size_t n = (size_t)snprintf(text, size, "i2c speed 400 combine %s\nchip DS2482-100 0x18\n",
	                            combine);

	for (unsigned i = 0; i < thermometers; i++)
		n += (size_t)snprintf(text + n, size - n,
		                      "DS18B20 28.%08X%04X as t%u temperature %u\n",
		                      (i + 1) * 2654435761u, i, i, i % 60);
	for (unsigned i = 0; i < BOARDS; i++)
		n += (size_t)snprintf(text + n, size - n, "DS2408 29.%08X%04X as b%u\n",
		                      (i + 77) * 2654435761u, i, i);
}

/* The boards come first: records 1 to BOARDS. */
static void write_rio(char *text, size_t size, unsigned thermometers, double alarm_period)
{
	size_t n = (size_t)snprintf(text, size,
	                            "OwsDrv {\n  TargetName \"sim:plant\"\n  Period 0.1\n"
	                            "  AlarmPeriod %.4f\n", alarm_period ? alarm_period : 0.05);

	for (unsigned i = 0; i < BOARDS; i++) {
		n += (size_t)snprintf(text + n, size - n,
		                      "  Item {\n    Name \"b%u\"\n    Path \"/29.%08X%04X/sensed.BYTE\"\n"
		                      "    Type byte\n    IO input\n    Uncached on\n", i,
		                      (i + 77) * 2654435761u, i);
		if (alarm_period)
			n += (size_t)snprintf(text + n, size - n,
			                      "    Alarm on\n    LatchAlarm \"latch.BYTE\"\n"
			                      "    PorAlarm \"por\"\n"
			                      "    SetAlarm \"set_alarm=133333333\"\n"
			                      "    ResetLatch \"latch.BYTE=0\"\n");
		n += (size_t)snprintf(text + n, size - n, "  }\n");
	}
	for (unsigned i = 0; i < thermometers; i++)
		n += (size_t)snprintf(text + n, size - n,
		                      "  Item {\n    Name \"t%u\"\n    Path \"/28.%08X%04X/temperature12\"\n"
		                      "    Type double\n    IO input\n    Uncached on\n  }\n", i,
		                      (i + 1) * 2654435761u, i);
	snprintf(text + n, size - n, "}\n");
}

static void published(void *ctx)
{
	(void)ctx;
	if (change.at && !change.seen && plant.now >= change.at &&
	    plant_number(&plant, 1 + change.board) == change.value)
		change.seen = plant.now;
}

static void begin(unsigned thermometers, const char *combine, double alarm_period)
{
	static char scenario[16384], rio[32768];

	write_scenario(scenario, sizeof(scenario), thermometers, combine);
	write_rio(rio, sizeof(rio), thermometers, alarm_period);
	memset(&change, 0, sizeof(change));
	plant_begin(&plant, scenario, rio);
	plant.answer_delay_ns = DELAY_NS;
	plant.published = published;
	plant_run(&plant, plant.start + 20 * PLANT_S);
}

static double wire_ms(uint64_t from_us)
{
	return (double)(plant_count(&plant, "wire_us") - from_us) / 1e3;
}

/* The wire's time of one search that finds nobody, of a plant that has nothing else to do. */
static double idle_search_ms(void)
{
	uint64_t wire, searches;
	double ms;

	begin(0, "any", 0.05);
	wire = plant_count(&plant, "wire_us");
	searches = plant_count(&plant, "directories");
	/* The search in the background is quiet between two of its rounds. */
	plant_run(&plant, plant.now + 500 * PLANT_MS);
	ms = wire_ms(wire) / (double)(plant_count(&plant, "directories") - searches);
	plant_end(&plant);
	return ms;
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

static void measure(const char *name, const char *combine, double alarm_period)
{
	struct sim_event event = { .what = SIM_SET, .done = true };
	static double ms[CHANGES];
	char line[64];

	begin(THERMOMETERS, combine, alarm_period);
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
	snprintf(line, sizeof(line), "input_latency.%s.p50", name);
	bench_line(line, bench_percentile(ms, CHANGES, 50), "ms");
	snprintf(line, sizeof(line), "input_latency.%s.p99", name);
	bench_line(line, bench_percentile(ms, CHANGES, 99), "ms");
}

int main(void)
{
	double idle = idle_search_ms();

	bench_line("alarm_search.idle.wire", idle, "ms");
	bench_line("alarm_search.limit", (ds2482_reset_ns[0] + 32 * ds2482_slot_ns[0]) / 1e6, "ms");
	measure("alarm4", "any", idle / 1e3 / 0.04);
	measure("alarm10", "any", idle / 1e3 / 0.10);
	measure("cyclic", "any", 0);
	return 0;
}
