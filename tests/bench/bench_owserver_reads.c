/* SPDX-License-Identifier: MIT */
/*
 * Reads per second of our owserver bus on one connection, beside a bare persistent socket loop and
 * libownet, all against the same genuine owserver and all on one CPU with it; and the CPU time a
 * read costs on both sides.
 */
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "tests/bench/aid.h"

#define READS 5000
#define ROUNDS 7

static struct bus_answer last;
static bool answered, is_up;

static int64_t now(void *ctx)
{
	struct timespec t;

	(void)ctx;
	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static int wait_for(void *ctx, int fd, short events, int64_t until_ns)
{
	struct pollfd p = {.fd = fd, .events = events};
	int64_t left = until_ns - now(ctx);
	struct timespec t = {left > 0 ? left / 1000000000 : 0, left > 0 ? left % 1000000000 : 0};

	return ppoll(&p, fd >= 0, &t, NULL) > 0;
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	last = *answer;
	answered = true;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	(void)ctx;
	if (event->news == BUS_UP)
		is_up = true;
}

static const struct bus_env env = {
	.now = now, .wait = wait_for, .answer = take_answer, .event = take_event};

static bool read_ours(struct bus *bus, const char *path)
{
	static uint8_t data[128];
	struct bus_req req = {.op = BUS_READ, .path = path, .len = sizeof(data), .data = data};

	req.deadline_ns = now(NULL) + 1000000000;
	answered = false;
	if (bus_submit(bus, &req))
		return false;
	while (!answered)
		bus_step(bus, now(NULL));
	return last.err == 0;
}

/* libownet, as a program of its users is linked */
static struct {
	int handle;
	int (*read)(int handle, const char *path, char **text);
} ownet;

static bool open_ownet(int port)
{
	int (*init)(const char *);
	char address[32];
	void *library = dlopen("libownet.so", RTLD_NOW);

	if (!library)
		library = dlopen("libownet-3.2.so.4", RTLD_NOW);
	if (!library)
		return false;
	*(void **)&init = dlsym(library, "OWNET_init");
	*(void **)&ownet.read = dlsym(library, "OWNET_read");
	snprintf(address, sizeof(address), "127.0.0.1:%d", port);
	if (!init || !ownet.read)
		return false;
	ownet.handle = init(address);
	return ownet.handle >= 0;
}

static int64_t own_cpu_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

enum who { OURS, BARE, OWNET, WHO };
static const char *const names[WHO] = {
	[OURS] = "owserver_reads",
	[BARE] = "owserver_reads.bare_socket",
	[OWNET] = "owserver_reads.libownet",
};

static bool read_one(enum who who, struct bus *bus, int fd, const char *path)
{
	char data[128], *text = NULL;
	bool good = false;

	switch (who) {
	case OURS:
		return read_ours(bus, path);
	case BARE:
		return bench_read(fd, path, data, sizeof(data)) >= 0;
	case OWNET:
		good = ownet.read(ownet.handle, path, &text) >= 0;
		free(text);
		break;
	case WHO:
		break;
	}
	return good;
}

int main(void)
{
	static double per_s[WHO][ROUNDS], own_us[WHO], peer_us[WHO];
	bool has_ownet;
	struct bench_peer peer;
	struct bus *bus;
	char where[32], why[128], name[64];
	int fd;

	bench_pin(0);
	if (!bench_peer_start(&peer, 100, 0))
		return 0;
	snprintf(where, sizeof(where), "127.0.0.1:%d", peer.port);
	if (bus_create(where, &env, &bus, why, sizeof(why))) {
		fprintf(stderr, "owserver_reads: %s\n", why);
		bench_peer_end(&peer);
		return 1;
	}
	while (!is_up)
		bus_step(bus, now(NULL));
	fd = bench_socket(peer.port);
	has_ownet = open_ownet(peer.port);
	if (!has_ownet)
		bench_note("owserver_reads.libownet left out: libownet is not installed");
	for (int round = 0; round < ROUNDS; round++)
		for (int who = 0; who < WHO; who++) {
			int64_t begin = bench_now(), own = own_cpu_ns(),
				its = bench_cpu_ns(peer.pid);

			if (who == OWNET && !has_ownet)
				continue;
			for (int i = 0; i < READS; i++)
				if (!read_one((enum who)who, bus, fd,
				              peer.paths[i % (int)peer.devices])) {
					fprintf(stderr, "%s: a read failed\n", names[who]);
					bench_peer_end(&peer);
					return 1;
				}
			per_s[who][round] = READS * 1e9 / (double)(bench_now() - begin);
			own_us[who] += (double)(own_cpu_ns() - own) / 1e3 / READS / ROUNDS;
			peer_us[who] += (double)(bench_cpu_ns(peer.pid) - its) / 1e3 / READS /
			                ROUNDS;
		}
	for (int who = 0; who < WHO; who++) {
		if (who == OWNET && !has_ownet)
			continue;
		bench_line(names[who], bench_percentile(per_s[who], ROUNDS, 50), "reads/s");
		snprintf(name, sizeof(name), "%s.cpu", names[who]);
		bench_line(name, own_us[who], "us/read");
		snprintf(name, sizeof(name), "%s.server_cpu", names[who]);
		bench_line(name, peer_us[who], "us/read");
	}
	close(fd);
	bus_destroy(bus);
	bench_peer_end(&peer);
	return 0;
}
