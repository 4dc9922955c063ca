/* SPDX-License-Identifier: MIT */
/* An instance of many signals without owsd, which change, and wake those that follow them. */
#include "tests/bench/many.h"

#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "src/config/read/config.h"
#include "src/memory/control/control.h"
#include "src/memory/shm/image.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"
#include "tests/bench/aid.h"

#define SECOND INT64_C(1000000000)
#define PARTS 10               /* of a second, in each of which a part of the signals is read */
#define LEAST_NS (SECOND / 20) /* between two probes */
#define SPREAD_NS (SECOND / 5)

static struct {
	char name[32];
	uint32_t count;
	struct segment segment;
	struct image image;
	struct config config;
	struct controller_layout layout;
	struct control *control;
	double values[MANY_MOST];
	int64_t base_ms;
	pthread_t thread;
	sem_t bell; /* of the thread that stands for the engine's */
	unsigned changing;
	bool probe, stop;
} many;

static uint64_t seed = 88172645463325252;

static uint32_t any(uint32_t n)
{
	seed ^= seed << 13;
	seed ^= seed >> 7;
	seed ^= seed << 17;
	return (uint32_t)(seed >> 32) % n;
}

const char *many_instance(void)
{
	return many.name;
}

int64_t many_base_ms(void)
{
	return many.base_ms;
}

double many_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_REALTIME, &t);
	return (double)(t.tv_sec * 1000 - many.base_ms) + (double)t.tv_nsec / 1e6;
}

static void publish(uint32_t record, uint32_t reading, bool changed)
{
	struct ows_sample sample = {
		.measured_ns = ows_now(), .quality = OWS_Q_GOOD, .count = reading};
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE};

	if (record)
		memcpy(&sample.value, &many.values[record - 1], sizeof(sample.value));
	image_publish(&many.image, record, &sample, &attrs, NULL);
	if (changed)
		image_change(&many.image, record);
}

static void wake_all(void)
{
	image_news(&many.image);
	control_news(many.control, &many.image.header->news);
}

static void read_part(uint32_t part, uint32_t reading)
{
	uint32_t from = part * many.count / PARTS, until = (part + 1) * many.count / PARTS;
	unsigned changing = __atomic_load_n(&many.changing, __ATOMIC_RELAXED);

	publish(0, reading, false);
	for (uint32_t i = from ? from : 1; changing && i < until; i++) {
		bool changed = any(100) < changing;

		if (changed)
			many.values[i] += any(2) ? 0.0625 : -0.0625;
		publish(i + 1, reading, changed);
	}
	wake_all();
}

static void publish_probe(uint32_t reading)
{
	many.values[0] = round(many_now() * 1000) / 1000;
	publish(1, reading, true);
	wake_all();
}

/* Programs that come and go, until then. */
static void welcome_until(int64_t until_ns)
{
	struct timespec t = {.tv_sec = (time_t)(until_ns / SECOND),
	                     .tv_nsec = (long)(until_ns % SECOND)};
	struct control_message message;

	while (sem_clockwait(&many.bell, CLOCK_MONOTONIC, &t) == 0)
		while (control_next(many.control, &message))
			control_done(many.control, &message);
}

static void *live(void *ctx)
{
	int64_t part_ns = bench_now(), probe_ns = part_ns;

	(void)ctx;
	for (uint32_t n = 0; !__atomic_load_n(&many.stop, __ATOMIC_RELAXED);) {
		welcome_until(part_ns < probe_ns ? part_ns : probe_ns);
		if (bench_now() >= part_ns) {
			read_part(n % PARTS, n / PARTS + 1);
			part_ns += SECOND / PARTS;
			n++;
		}
		if (bench_now() < probe_ns)
			continue;
		probe_ns = bench_now() + LEAST_NS + any((uint32_t)SPREAD_NS);
		if (__atomic_load_n(&many.probe, __ATOMIC_RELAXED))
			publish_probe(n);
	}
	return NULL;
}

static void ring(void *ctx)
{
	(void)ctx;
	sem_post(&many.bell);
}

static bool open_control(const uint8_t *types)
{
	const struct controller_plan plan = {.types = types,
	                                     .signal_count = many.count,
	                                     .text_cap = 64,
	                                     .generation = 1,
	                                     .start_id = 1};
	struct control_setup setup = {.config = &many.config,
	                              .directory = bench_dir()->fd,
	                              .instance = many.name,
	                              .ring = ring};
	char why[200];

	if (controller_layout_make(&many.layout, &plan) ||
	    control_create(&setup, &many.control, why, sizeof(why)))
		return false;
	return control_start(many.control, &many.layout) == 0;
}

static bool open_image(const struct image_signal *signals)
{
	struct image_plan plan = {.signals = signals,
	                          .signal_count = many.count,
	                          .generation = 1,
	                          .start_id = 1,
	                          .pid = getpid(),
	                          .start_ns = ows_now(),
	                          .period_ns = SECOND / PARTS};

	if (segment_create(bench_dir(), many.name, SEGMENT_IMAGE, image_size(&plan), &many.segment))
		return false;
	image_build(&plan, many.segment.base, &many.image);
	for (uint32_t i = 0; i <= many.count; i++)
		publish(i, 1, false);
	image_state(&many.image, OWS_STATE_LIVE);
	return segment_show(many.name, &many.segment) == 0;
}

bool many_open(uint32_t count)
{
	static struct image_signal signals[MANY_MOST];
	static struct config_item items[MANY_MOST];
	static char names[MANY_MOST][16];
	static uint8_t types[MANY_MOST];

	memset(&many, 0, sizeof(many));
	snprintf(many.name, sizeof(many.name), "bench-%d", (int)getpid());
	many.count = count;
	many.base_ms = (int64_t)time(NULL) * 1000;
	for (uint32_t i = 0; i < count; i++) {
		snprintf(names[i], sizeof(names[i]), "signal%u", (unsigned)i);
		signals[i] = (struct image_signal){.name = names[i],
		                                   .path = "/28.0/temperature",
		                                   .type = OWS_DOUBLE,
		                                   .per_factor = 1};
		items[i] = (struct config_item){.name = names[i], .type = OWS_DOUBLE};
		types[i] = OWS_DOUBLE;
		many.values[i] = 20 + (double)any(64) / 16;
	}
	many.config.items = items;
	many.config.item_count = count;
	sem_init(&many.bell, 0, 0);
	if (!open_image(signals) || !open_control(types) ||
	    pthread_create(&many.thread, NULL, live, NULL)) {
		bench_note("left out: no shared memory, or no thread");
		return false;
	}
	return true;
}

void many_pace(struct many_pace pace)
{
	__atomic_store_n(&many.changing, pace.changing, __ATOMIC_RELAXED);
	__atomic_store_n(&many.probe, pace.probe, __ATOMIC_RELAXED);
}

void many_close(void)
{
	char file[SEGMENT_FILE];

	__atomic_store_n(&many.stop, true, __ATOMIC_RELAXED);
	pthread_join(many.thread, NULL);
	control_destroy(many.control);
	controller_layout_free(&many.layout);
	unlinkat(bench_dir()->fd, segment_file(many.name, "image", file), 0);
	segment_close(&many.segment);
	sem_destroy(&many.bell);
}

bool many_write_config(const char *path)
{
	FILE *f = fopen(path, "w");

	if (!f)
		return false;
	fputs("OwsDrv {\n  TargetName \"localhost:4304\"\n", f);
	for (uint32_t i = 0; i < many.count; i++)
		fprintf(f,
		        "  Item {\n    Name \"signal%u\"\n    Path \"/28.0/temperature\"\n"
		        "    Type double\n    IO input\n  }\n",
		        (unsigned)i);
	fputs("}\n", f);
	return fclose(f) == 0;
}
