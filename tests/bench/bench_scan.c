/* SPDX-License-Identifier: MIT */
/*
 * A full fresh scan of DS18B20s on the simulated DS2482, on the simulator's clock: no figure here
 * depends on the machine. All thermometers are asked for at once, as the engine does; the time is
 * that to the last answer, the mean of several scans with the background search going on.
 *
 * Steady: each is asked for again 100 us after its answer (the time of an engine's thread), for a
 * minute. The figure is the mean time between two answers of the thermometer for which that is
 * longest. Each answer is of a conversion that began after the request.
 *
 * The limit is what the protocol cannot avoid, by the times that the data sheets call typical:
 *   reset      1184 us = tRSTL 600 + tRSTH 584   DS2482-100 rev. 19-4930, DS2482-800 19-4932
 *   time slot  69.3 us = tSLOT                    the same
 *   conversion 750 ms  = tCONV at 12 bits         DS18B20 19-7487
 * Convert T is a reset and 2 bytes for each channel; a reading is a reset, Match ROM with its 8
 * bytes, the command and 9 bytes: 19 bytes. One conversion, because all channels convert at once.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "tests/bench/aid.h"

#define RESET_NS 1184000.0
#define SLOT_NS 69300.0
#define CONVERT_NS 750e6
#define SHORTEST_NS INT64_C(750000000)
#define QUICKEST_NS INT64_C(600000000)
#define MS INT64_C(1000000)
#define S INT64_C(1000000000)
#define MOST 100
#define SCANS 8
#define STEADY_NS (60 * S)
#define ENGINE_NS (MS / 10)
#define START_NS (1000 * S)

/* Temperatures that stay, or chips that take four fifths of the longest time. */
enum kind { PLAIN, QUICK };
struct rio_position {
	struct bus_env env;
	struct bus *bus;
	char file[32];
	int64_t now;
	uint64_t waits; /* those of the simulated adapter included */
	unsigned answers, failures, channels, chips, thermometers;
	bool up;
	struct bus_req req[MOST];
	uint8_t data[MOST][64];
	char path[MOST][64];
	/* Steady. */
	bool steady;
	enum kind kind;
	int64_t asked[MOST], again[MOST]; /* when; 0: it is asked for */
	int64_t first[MOST], last[MOST];  /* answers, and how many lie between */
	unsigned renewed[MOST];
};

static int64_t place_now(void *ctx)
{
	return ((struct rio_position *)ctx)->now;
}

static int place_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct rio_position *p = ctx;

	(void)fd;
	(void)events;
	p->waits++;
	if (until_ns > p->now)
		p->now = until_ns;
	return 0;
}

static void place_answer(void *ctx, const struct bus_answer *answer)
{
	struct rio_position *p = ctx;

	p->answers++;
	p->failures += answer->err != 0;
	if (!p->steady)
		return;
	int64_t least = p->kind == QUICK ? QUICKEST_NS : SHORTEST_NS;
	p->failures += answer->measured_ns < p->asked[answer->id] + least;
	if (!p->first[answer->id])
		p->first[answer->id] = p->now;
	else
		p->renewed[answer->id]++;
	p->last[answer->id] = p->now;
	p->again[answer->id] = p->now + ENGINE_NS;
}

static void place_event(void *ctx, const struct bus_event *event)
{
	struct rio_position *p = ctx;

	p->up |= event->news == BUS_UP;
}

static void run(struct rio_position *p, unsigned answers, int64_t until_ns)
{
	while (p->answers < answers && p->now < until_ns) {
		int64_t next = bus_step(p->bus, p->now);

		if (next > until_ns)
			next = until_ns;
		if (p->answers < answers && next > p->now)
			p->now = next;
	}
}

static void describe(FILE *f, unsigned thermometers, unsigned channels, unsigned chips, int khz,
                     const char *combine, enum kind kind)
{
	fprintf(f, "i2c speed %d combine %s\n", khz, combine);
	for (unsigned i = 0; i < thermometers; i++) {
		unsigned wire = i / (thermometers / channels), each = channels / chips;

		if (i % (thermometers / chips) == 0)
			fprintf(f, "chip DS2482-%d 0x%x\n", each > 1 ? 800 : 100,
			        0x18 + wire / each);
		if (i % (thermometers / channels) == 0)
			fprintf(f, "channel %u\n", wire % each);
		/* Ids differ in all bits, as those of a real delivery do. */
		fprintf(f, "DS18B20 28.%08X%04X as t%u ", (i + 1) * 2654435761u, i, i);
		if (kind == PLAIN)
			fprintf(f, "temperature %u\n", i % 60);
		else
			fprintf(f, "speed 80 temperature ramp %u 120 600s\n", i % 60);
	}
}

static void begin(struct rio_position *p, unsigned thermometers, unsigned channels, unsigned chips,
                  int khz, const char *combine, enum kind kind)
{
	char target[48], why[200] = "";
	int fd;
	FILE *f;

	memset(p, 0, sizeof(*p));
	p->now = START_NS;
	p->channels = channels;
	p->thermometers = thermometers;
	p->env = (struct bus_env){.ctx = p,
	                          .now = place_now,
	                          .wait = place_wait,
	                          .answer = place_answer,
	                          .event = place_event};
	snprintf(p->file, sizeof(p->file), "/tmp/owsd-bench-XXXXXX");
	fd = mkstemp(p->file);
	f = fd < 0 ? NULL : fdopen(fd, "w");
	if (!f)
		exit(1);
	describe(f, thermometers, channels, chips, khz, combine, kind);
	p->kind = kind;
	fclose(f);
	snprintf(target, sizeof(target), "sim:%s", p->file);
	if (bus_create(target, &p->env, &p->bus, why, sizeof(why))) {
		fprintf(stderr, "scan: %s\n", why);
		exit(1);
	}
	unlink(p->file);
}

static uint64_t counter(struct rio_position *p, const char *name)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(p->bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, name) == 0)
			return counters[i].value;
	exit(1);
}

static void ask(struct rio_position *p, unsigned i, const char *property)
{
	snprintf(p->path[i], sizeof(p->path[i]), "/28.%08X%04X/%s", (i + 1) * 2654435761u, i,
	         property);
	p->req[i] = (struct bus_req){.id = i,
	                             .op = BUS_READ,
	                             .prio = BUS_INPUT,
	                             .fresh = true,
	                             .deadline_ns = p->now + 20 * S,
	                             .path = p->path[i],
	                             .len = sizeof(p->data[i]),
	                             .data = p->data[i]};
	if (bus_submit(p->bus, &p->req[i]))
		exit(1);
}

static double scan(struct rio_position *p)
{
	int64_t begun = p->now;

	p->answers = 0;
	for (unsigned i = 0; i < p->thermometers; i++)
		ask(p, i, "temperature12");
	run(p, p->thermometers, p->now + 60 * S);
	if (p->failures || p->answers < p->thermometers) {
		fprintf(stderr, "scan: %u of %u answered, %u failed\n", p->answers, p->thermometers,
		        p->failures);
		exit(1);
	}
	return (double)(p->now - begun);
}

/* From the opening of the bus to the last answer of all that are asked for as soon as it is up. */
static void measure_first(unsigned thermometers, unsigned channels)
{
	static struct rio_position p;
	char line[64], wires[16];

	begin(&p, thermometers, channels, 1, 400, "any", PLAIN);
	int64_t begun = p.now;
	while (!p.up && p.now < begun + 60 * S) {
		int64_t next = bus_step(p.bus, p.now);

		p.now = next > p.now ? next : p.now;
	}
	(void)scan(&p);
	snprintf(wires, sizeof(wires), "on%u", channels);
	snprintf(line, sizeof(line), "scan.%u%s.400kHz.first", thermometers,
	         channels > 1 ? wires : "");
	bench_line(line, (double)(p.now - begun) / 1e9, "s");
	bus_destroy(p.bus);
}

/* Each thermometer again as soon as it was answered. */
static double steady(struct rio_position *p)
{
	int64_t end = p->now + STEADY_NS;
	double longest = 0;

	p->steady = true;
	for (unsigned i = 0; i < p->thermometers; i++)
		p->again[i] = p->now;
	while (p->now < end) {
		int64_t next = end;

		for (unsigned i = 0; i < p->thermometers; i++) {
			if (p->again[i] && p->again[i] <= p->now) {
				p->again[i] = 0;
				p->asked[i] = p->now;
				ask(p, i, "temperature12");
			}
			if (p->again[i] && p->again[i] < next)
				next = p->again[i];
		}
		int64_t step = bus_step(p->bus, p->now);
		next = step < next ? step : next;
		p->now = next > p->now ? next : p->now;
	}
	p->steady = false;
	for (unsigned i = 0; i < p->thermometers; i++) {
		double mean = (double)(p->last[i] - p->first[i]) / p->renewed[i];

		p->failures += p->renewed[i] == 0;
		longest = mean > longest ? mean : longest;
	}
	if (p->failures) {
		fprintf(stderr, "scan: %u failed or are too old\n", p->failures);
		exit(1);
	}
	return longest;
}

static double limit(const struct rio_position *p)
{
	return p->channels * (RESET_NS + 2 * 8 * SLOT_NS) + CONVERT_NS +
	       p->thermometers * (RESET_NS + 19 * 8 * SLOT_NS);
}

/* Cost of one reading of a scratchpad: the median, as a background search may come between. */
static void scratchpad(struct rio_position *p, const char *name)
{
	double transfers[SCANS], calls[SCANS];
	char line[64];

	for (int i = 0; i < SCANS; i++) {
		uint64_t before = counter(p, "i2c_transfers"), waits = p->waits;
		uint64_t system = counter(p, "syscalls");

		p->answers = 0;
		ask(p, 0, "scratchpad");
		run(p, 1, p->now + 20 * S);
		transfers[i] = (double)(counter(p, "i2c_transfers") - before);
		/* The simulated adapter waits once a transfer where the kernel does it for us. */
		calls[i] = (double)(counter(p, "syscalls") - system) +
		           ((double)(p->waits - waits) - transfers[i]);
	}
	snprintf(line, sizeof(line), "scan.%s.transfers", name);
	bench_line(line, bench_percentile(transfers, SCANS, 50), "per_scratchpad");
	snprintf(line, sizeof(line), "scan.%s.syscalls", name);
	bench_line(line, bench_percentile(calls, SCANS, 50), "per_scratchpad");
}

static void measure(unsigned thermometers, unsigned channels, unsigned chips, int khz,
                    const char *combine, bool cost, bool quick)
{
	static struct rio_position p;
	double sum = 0;
	char name[40], line[64], wires[16];

	begin(&p, thermometers, channels, chips, khz, combine, quick ? QUICK : PLAIN);
	run(&p, 1, p.now + 60 * S);
	scan(&p); /* supply and resolution are asked for once */
	/* Each minute one scan asks one by one, and learns what the chips show. */
	for (int i = 0; i < 3 && quick; i++) {
		run(&p, UINT32_MAX, p.now + 30 * S);
		scan(&p);
	}
	for (int i = 0; i < SCANS; i++) {
		sum += scan(&p);
		run(&p, UINT32_MAX, p.now + 137 * MS * (i + 1));
	}
	snprintf(wires, sizeof(wires), chips > 1 ? "on%uchips" : "on%u", channels);
	snprintf(name, sizeof(name), "%u%s.%dkHz%s%s", thermometers, channels > 1 ? wires : "", khz,
	         strcmp(combine, "any") == 0 ? "" : ".one-read", quick ? ".quick" : "");
	snprintf(line, sizeof(line), "scan.%s.seconds", name);
	bench_line(line, sum / SCANS / 1e9, "s");
	snprintf(line, sizeof(line), "scan.%s.over_limit", name);
	bench_line(line, sum / SCANS / limit(&p), "ratio");
	if (cost)
		scratchpad(&p, name);
	snprintf(line, sizeof(line), "scan.%s.steady", name);
	bench_line(line, steady(&p) / 1e9, "s");
	bus_destroy(p.bus);
}

int main(void)
{
	static const struct {
		unsigned thermometers, channels, chips;
	} nets[] = {{1, 1, 1},  {2, 1, 1},   {5, 1, 1},  {10, 1, 1}, {20, 1, 1},
	            {50, 1, 1}, {100, 1, 1}, {80, 8, 1}, {80, 4, 4}, {80, 8, 8}};
	static const char *const combines[] = {"any", "one-read"};
	static const int speeds[] = {400, 100};

	for (unsigned s = 0; s < 2; s++)
		for (unsigned c = 0; c < 2; c++)
			for (unsigned i = 0; i < sizeof(nets) / sizeof(nets[0]); i++)
				measure(nets[i].thermometers, nets[i].channels, nets[i].chips,
				        speeds[s], combines[c], nets[i].thermometers == 50, false);
	for (unsigned i = 0; i < 6; i++)
		measure(nets[i].thermometers, 1, 1, 400, "any", false, true);
	measure_first(1, 1);
	measure_first(10, 1);
	measure_first(50, 1);
	measure_first(80, 8);
	return 0;
}
