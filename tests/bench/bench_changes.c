/* SPDX-License-Identifier: MIT */
/*
 * What it costs a consumer that 10 signals change: to find out which and to read them, with
 * ows_changes() and with a look at all; the writer publishes them on the other CPU. Beside it the
 * CPU time of a program that waits for changes: of an owsd whose heart alone beats, and of one that
 * reads 10 signals once a second.
 */
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "src/memory/shm/image.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"
#include "tests/bench/aid.h"

#define CHANGES 10
#define ROUNDS 4000
#define ROWS_MAX 10000
#define WAIT_S 10

static struct image image;
static uint32_t rows;
static uint32_t turn; /* odd: the writer's */
static bool stop;

static void publish(uint32_t record, double degrees)
{
	struct ows_sample sample = {.measured_ns = ows_now(), .quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE};

	sample.count = (uint32_t)degrees;
	memcpy(&sample.value, &degrees, sizeof(degrees));
	image_publish(&image, record, &sample, &attrs, NULL);
	if (record)
		image_change(&image, record);
}

/* Publishes 10 of the rows, spread over all, and the heartbeat, each time it is asked to. */
static void *write_when_asked(void *ctx)
{
	uint32_t at = 0;

	(void)ctx;
	bench_pin(bench_cpus() > 1);
	for (uint32_t n = 1;; n += 2) {
		while (__atomic_load_n(&turn, __ATOMIC_ACQUIRE) != n)
			if (__atomic_load_n(&stop, __ATOMIC_RELAXED))
				return NULL;
		publish(0, 0);
		for (int i = 0; i < CHANGES; i++, at += 7919)
			publish(at % rows + 1, n);
		__atomic_store_n(&turn, n + 1, __ATOMIC_RELEASE);
	}
}

static void let_change(void)
{
	uint32_t n = turn + 1;

	__atomic_store_n(&turn, n, __ATOMIC_RELEASE);
	while (__atomic_load_n(&turn, __ATOMIC_ACQUIRE) != n + 1)
		;
}

/* Returns how many changed. */
static int by_changes(struct ows *h, struct ows_cursor *cursor, double *sum)
{
	int signals[64], n = ows_changes(h, cursor, signals, 64, 0);
	int64_t now = ows_now();
	struct ows_value v;

	for (int i = 0; i < n; i++)
		if (ows_get_signal(h, signals[i], now, &v) == 0)
			*sum += v.number;
	return n;
}

static int by_scan(struct ows *h, uint32_t *counts, double *sum)
{
	int64_t now = ows_now();
	struct ows_value v;
	int n = 0;

	for (uint32_t i = 0; i < rows; i++) {
		if (ows_get_signal(h, (int)i, now, &v) || v.count == counts[i])
			continue;
		counts[i] = v.count;
		*sum += v.number;
		n++;
	}
	return n;
}

static bool open_instance(struct segment *segment, char *name, struct ows **h)
{
	static struct image_signal signals[ROWS_MAX];
	static char names[ROWS_MAX][16];
	struct image_plan plan = {.signals = signals,
	                          .signal_count = rows,
	                          .generation = 1,
	                          .start_id = 1,
	                          .pid = getpid(),
	                          .start_ns = ows_now(),
	                          .period_ns = 100000000};

	for (uint32_t i = 0; i < rows; i++) {
		snprintf(names[i], sizeof(names[i]), "signal%u", i);
		signals[i] = (struct image_signal){.name = names[i],
		                                   .path = "/28.0/temperature",
		                                   .type = OWS_DOUBLE,
		                                   .per_factor = 1};
	}
	sprintf(name, "bench-%d", (int)getpid());
	if (segment_create(bench_dir(), name, SEGMENT_IMAGE, image_size(&plan), segment))
		return false;
	image_build(&plan, segment->base, &image);
	for (uint32_t i = 0; i <= rows; i++)
		publish(i, 0);
	image_state(&image, OWS_STATE_LIVE);
	return segment_show(name, segment) == 0 && ows_open(name, OWS_READ, h) == 0;
}

static void measure(uint32_t count)
{
	static double changes[ROUNDS], scan[ROUNDS];
	static uint32_t counts[ROWS_MAX];
	struct ows_cursor cursor = {0};
	struct segment segment;
	char name[32], file[SEGMENT_FILE], line[48];
	pthread_t writer;
	double sum = 0;
	int missed = 0;
	struct ows *h;

	rows = count;
	turn = 0;
	stop = false;
	memset(counts, 0, sizeof(counts));
	if (!open_instance(&segment, name, &h)) {
		fprintf(stderr, "changes: no shared memory\n");
		exit(1);
	}
	by_changes(h, &cursor, &sum);
	pthread_create(&writer, NULL, write_when_asked, NULL);
	for (int i = 0; i < ROUNDS; i++) {
		int64_t begin;

		let_change();
		begin = bench_now();
		missed += by_changes(h, &cursor, &sum) != CHANGES;
		changes[i] = (double)(bench_now() - begin);
		let_change();
		by_changes(h, &cursor, &sum);
		begin = bench_now();
		by_scan(h, counts, &sum);
		scan[i] = (double)(bench_now() - begin);
	}
	__atomic_store_n(&stop, true, __ATOMIC_RELAXED);
	pthread_join(writer, NULL);
	ows_close(h);
	unlinkat(bench_dir()->fd, segment_file(name, "image", file), 0);
	segment_close(&segment);
	if (missed || sum <= 0)
		fprintf(stderr, "changes: %d rounds did not give %d changes\n", missed, CHANGES);
	snprintf(line, sizeof(line), "changes.%u", count);
	bench_line(line, bench_percentile(changes, ROUNDS, 50), "ns");
	snprintf(line, sizeof(line), "changes.scan.%u", count);
	bench_line(line, bench_percentile(scan, ROUNDS, 50), "ns");
}

static bool write_files(const char *folder)
{
	char path[64];
	FILE *f;

	snprintf(path, sizeof(path), "%s/bench.sim", folder);
	f = fopen(path, "w");
	if (!f)
		return false;
	fputs("i2c speed 400\nchip DS2482-100 0x18\n", f);
	for (int i = 0; i < CHANGES; i++)
		fprintf(f, "DS2405 05.0000000000%02X\n", i + 1);
	if (fclose(f))
		return false;
	snprintf(path, sizeof(path), "%s/bench.rio", folder);
	f = fopen(path, "w");
	if (!f)
		return false;
	fprintf(f, "OwsDrv {\n  TargetName \"sim:%s/bench.sim\"\n  Period 0.1\n", folder);
	for (int i = 0; i < CHANGES; i++)
		fprintf(f,
		        "  Item {\n    Name \"i%d\"\n    Path \"/05.0000000000%02X/sensed\"\n"
		        "    Type bool\n    IO input\n    PerFactor 10\n  }\n",
		        i, i + 1);
	fputs("}\n", f);
	return fclose(f) == 0;
}

static pid_t start_owsd(const char *self, const char *folder, const char *instance)
{
	const char *slash = strrchr(self, '/');
	char program[512], file[64];
	pid_t pid;

	snprintf(program, sizeof(program), "%.*s/../owsd-sim", slash ? (int)(slash - self) : 1,
	         slash ? self : ".");
	snprintf(file, sizeof(file), "%s/bench.rio", folder);
	pid = fork();
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		if (!freopen("/dev/null", "w", stderr))
			_exit(127);
		execl(program, program, "-c", file, "-n", instance, (char *)NULL);
		_exit(127);
	}
	return pid;
}

static int64_t cpu_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Follow the instance for some seconds; prints what that costs and how much it was. */
static void follow(struct ows *h, const char *name)
{
	int64_t begin = bench_now(), end = begin + WAIT_S * INT64_C(1000000000), cpu = cpu_now();
	int signals[64], n, changes = 0;
	struct ows_cursor cursor = {0};
	char line[64];
	struct ows_value v;

	for (int64_t now = begin; now < end; now = bench_now()) {
		n = ows_changes(h, &cursor, signals, 64, end - now);
		for (int i = 0; i < n; i++)
			changes += ows_get_signal(h, signals[i], ows_now(), &v) == 0;
	}
	cpu = cpu_now() - cpu;
	bench_line(name, (double)cpu / (double)(bench_now() - begin) * 100, "%");
	snprintf(line, sizeof(line), "%s.changes", name);
	bench_line(line, (double)changes / WAIT_S, "1/s");
}

static void wait_beside_owsd(const char *self)
{
	char folder[] = "/tmp/owsd-bench-XXXXXX", instance[32], path[64];
	struct ows *h = NULL;
	pid_t pid;

	snprintf(instance, sizeof(instance), "bench-wait-%d", (int)getpid());
	if (!mkdtemp(folder) || !write_files(folder))
		return;
	pid = start_owsd(self, folder, instance);
	for (int i = 0; i < 200 && !h; i++) {
		usleep(20000);
		if (ows_open(instance, OWS_READ, &h))
			h = NULL;
	}
	sleep(2);
	if (h)
		follow(h, "changes.waiting");
	ows_close(h);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	snprintf(path, sizeof(path), "%s/bench.sim", folder);
	unlink(path);
	snprintf(path, sizeof(path), "%s/bench.rio", folder);
	unlink(path);
	rmdir(folder);
}

/* Nothing changes but the heart beats: what an idle owsd publishes. */
static void *beat(void *ctx)
{
	(void)ctx;
	while (!__atomic_load_n(&stop, __ATOMIC_RELAXED)) {
		publish(0, 0);
		usleep(100000);
	}
	return NULL;
}

static void wait_beside_an_idle_one(void)
{
	struct segment segment;
	char name[32], file[SEGMENT_FILE];
	pthread_t heart;
	struct ows *h;

	rows = 10;
	stop = false;
	if (!open_instance(&segment, name, &h))
		return;
	pthread_create(&heart, NULL, beat, NULL);
	follow(h, "changes.waiting_idle");
	__atomic_store_n(&stop, true, __ATOMIC_RELAXED);
	pthread_join(heart, NULL);
	ows_close(h);
	unlinkat(bench_dir()->fd, segment_file(name, "image", file), 0);
	segment_close(&segment);
}

int main(int argc, char **argv)
{
	static const uint32_t tables[] = {10, 1000, 10000};

	(void)argc;
	bench_pin(0);
	for (unsigned i = 0; i < sizeof(tables) / sizeof(tables[0]); i++)
		measure(tables[i]);
	wait_beside_an_idle_one();
	wait_beside_owsd(argv[0]);
	return 0;
}
