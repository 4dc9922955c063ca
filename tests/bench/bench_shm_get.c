/* SPDX-License-Identifier: MIT */
/*
 * One signal read from shared memory while a writer on the other CPU publishes 10 000 times a
 * second; beside it, in the same run, one READ of the genuine owserver from another CPU than the
 * server's.
 */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/memory/shm/image.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"
#include "tests/bench/aid.h"

#define BATCH 1000
#define BATCHES 20000
#define WRITES_PER_S 10000

static struct image image;
static int stop;

static void publish(double degrees)
{
	struct ows_sample sample = {.measured_ns = ows_now(), .quality = OWS_Q_GOOD, .count = 1};
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE};

	memcpy(&sample.value, &degrees, sizeof(degrees));
	image_publish(&image, 1, &sample, &attrs, NULL);
	sample.value = 0;
	image_publish(&image, 0, &sample, &attrs, NULL);
}

static void *write_all_the_time(void *ctx)
{
	int64_t next = bench_now();

	(void)ctx;
	bench_pin(1);
	for (double d = 0; !__atomic_load_n(&stop, __ATOMIC_RELAXED); d++) {
		publish(d);
		next += 1000000000 / WRITES_PER_S;
		while (bench_now() < next)
			;
	}
	return NULL;
}

static bool open_instance(struct segment *segment, char *name, struct ows **h)
{
	const struct image_signal signal = {
		.name = "room", .path = "/28.0/temperature", .type = OWS_DOUBLE, .per_factor = 1};
	struct image_plan plan = {.signals = &signal,
	                          .signal_count = 1,
	                          .generation = 1,
	                          .start_id = 1,
	                          .pid = getpid(),
	                          .start_ns = ows_now(),
	                          .period_ns = 100000000};
	size_t size = image_size(&plan);

	sprintf(name, "bench-%d", (int)getpid());
	if (segment_create(bench_dir(), name, SEGMENT_IMAGE, size, segment))
		return false;
	image_build(&plan, segment->base, &image);
	publish(0);
	image_state(&image, OWS_STATE_LIVE);
	return segment_show(name, segment) == 0 && ows_open(name, OWS_READ, h) == 0;
}

static double median_get_ns(struct ows *h)
{
	static double per_get[BATCHES];
	int id = ows_find(h, "room");
	struct ows_value v;
	volatile double sum = 0;

	for (int b = 0; b < BATCHES; b++) {
		int64_t begin = bench_now(), now = ows_now();

		for (int i = 0; i < BATCH; i++)
			if (ows_get(h, id, now, &v) == 0)
				sum = sum + v.number;
		per_get[b] = (double)(bench_now() - begin) / BATCH;
	}
	return bench_percentile(per_get, BATCHES, 50);
}

/* One by one, the reading of the clock included; beside it the clock alone. */
static void distribution(struct ows *h, bool get, const char *name)
{
	enum { GETS = 500000 };
	static double ns[GETS];
	int id = ows_find(h, "room");
	struct ows_value v;
	volatile double sum = 0;
	int64_t stamp = ows_now();

	for (int i = 0; i < GETS; i++) {
		int64_t begin = bench_now();

		if (get && ows_get(h, id, stamp, &v) == 0)
			sum = sum + v.number;
		ns[i] = (double)(bench_now() - begin);
	}
	bench_distribution(name, ns, GETS, "ns");
}

static double median_read_ns(void)
{
	enum { READS = 4000 };
	static double ns[READS];
	struct bench_peer peer;
	char data[64];
	int fd;

	if (!bench_peer_start(&peer, 10, 1))
		return 0;
	fd = bench_socket(peer.port);
	for (int i = 0; i < READS; i++) {
		int64_t begin = bench_now();

		if (bench_read(fd, peer.paths[i % 10], data, sizeof(data)) < 0) {
			bench_note("owserver refused a read");
			break;
		}
		ns[i] = (double)(bench_now() - begin);
	}
	close(fd);
	bench_peer_end(&peer);
	bench_distribution("shm_get.owserver_read", ns, READS, "ns");
	return bench_percentile(ns, READS, 50);
}

int main(void)
{
	struct segment segment;
	pthread_t writer;
	struct ows *h;
	char name[32];
	double get, read;

	if (!open_instance(&segment, name, &h)) {
		fprintf(stderr, "shm_get: no shared memory\n");
		return 1;
	}
	if (bench_cpus() < 2)
		bench_note("shm_get: one CPU only, the writer shares it");
	bench_pin(0);
	pthread_create(&writer, NULL, write_all_the_time, NULL);
	get = median_get_ns(h);
	distribution(h, true, "shm_get.single");
	distribution(h, false, "shm_get.clock");
	__atomic_store_n(&stop, 1, __ATOMIC_RELAXED);
	pthread_join(writer, NULL);
	ows_close(h);
	segment_close(&segment);
	bench_line("shm_get", get, "ns");
	read = median_read_ns();
	if (read > 0) {
		bench_line("shm_get.owserver_read", read, "ns");
		bench_line("shm_get.ratio", read / get, "times");
	}
	return 0;
}
