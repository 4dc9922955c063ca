/* SPDX-License-Identifier: MIT */
/*
 * What this machine cannot do faster, for the figures to stand beside: a word out of memory and out
 * of the other CPU's cache, a thread woken, and a request and its answer of the owserver protocol's
 * size over loopback TCP with nothing in between, by 1, 16 and 64 connections and a new one each.
 */
#include "src/memory/shm/futex.h"
#include "tests/bench/aid.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define LINE 64
#define WORDS (64 << 20)
#define HOPS 4000
#define TURNS 1000
#define SERIES 100
#define WAKES 1000
#define TRIPS 20000
#define CONNECTIONS 64
#define ASKED 54 /* header and "/28.0123456789AB/temperature" */
#define TOLD 36  /* header and 12 characters */

/* Each load needs the one before: nothing can be fetched ahead. */
static void memory(const char *name, size_t size)
{
	size_t lines = size / LINE, at = 0;
	uint8_t *room = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
	                     0);
	double ns[SERIES];

	if (room == MAP_FAILED)
		return;
	/*
	 * a full cycle through all lines, by steps that no prefetcher knows (lines is a power of 2)
	 */
	for (size_t i = 0, here = 0; i < lines; i++) {
		size_t next = (here * 1664525u + 1013904223u) % lines;

		memcpy(room + here * LINE, &next, sizeof(next));
		here = next;
	}
	for (int series = 0; series < SERIES; series++) {
		int64_t begin = bench_now();

		for (int i = 0; i < HOPS; i++)
			memcpy(&at, room + at * LINE, sizeof(at));
		ns[series] = (double)(bench_now() - begin) / HOPS;
	}
	bench_line(name, at == SIZE_MAX ? 0 : bench_percentile(ns, SERIES, 50), "ns");
	munmap(room, size);
}

static uint32_t ball __attribute__((aligned(LINE)));

static void *give_back(void *ctx)
{
	(void)ctx;
	bench_pin(1);
	for (uint32_t turn = 1; turn < 2 * TURNS * SERIES; turn += 2) {
		while (__atomic_load_n(&ball, __ATOMIC_ACQUIRE) != turn)
			;
		__atomic_store_n(&ball, turn + 1, __ATOMIC_RELEASE);
	}
	return NULL;
}

/* A line from one CPU's cache to the other's: half of there and back. */
static void cache_line(void)
{
	static double ns[SERIES];
	pthread_t thread;
	uint32_t turn = 0;

	if (pthread_create(&thread, NULL, give_back, NULL))
		return;
	for (int i = 0; i < SERIES; i++) {
		int64_t begin = bench_now();

		for (int n = 0; n < TURNS; n++, turn += 2) {
			__atomic_store_n(&ball, turn + 1, __ATOMIC_RELEASE);
			while (__atomic_load_n(&ball, __ATOMIC_ACQUIRE) != turn + 2)
				;
		}
		ns[i] = (double)(bench_now() - begin) / TURNS / 2;
	}
	pthread_join(thread, NULL);
	bench_line("limit.cache_line", bench_percentile(ns, SERIES, 50), "ns");
}

static uint32_t bell;
static int64_t awake_ns;

static void *sleep_and_wake(void *ctx)
{
	(void)ctx;
	bench_pin(1);
	for (uint32_t n = 0; n < WAKES; n++) {
		while (__atomic_load_n(&bell, __ATOMIC_ACQUIRE) == n)
			segment_wait(&bell, n, -1);
		__atomic_store_n(&awake_ns, bench_now(), __ATOMIC_RELEASE);
	}
	return NULL;
}

static void wake(void)
{
	static double us[WAKES];
	pthread_t thread;

	if (pthread_create(&thread, NULL, sleep_and_wake, NULL))
		return;
	for (uint32_t n = 0; n < WAKES; n++) {
		int64_t begin, end;

		usleep(500);
		__atomic_store_n(&awake_ns, 0, __ATOMIC_RELAXED);
		begin = bench_now();
		__atomic_store_n(&bell, n + 1, __ATOMIC_RELEASE);
		segment_wake(&bell, 1);
		while (!(end = __atomic_load_n(&awake_ns, __ATOMIC_ACQUIRE)))
			usleep(20);
		us[n] = (double)(end - begin) / 1e3;
	}
	pthread_join(thread, NULL);
	bench_line("limit.wake", bench_percentile(us, WAKES, 50), "us");
}

static bool answer(int fd, int flags)
{
	char data[ASKED];

	return recv(fd, data, ASKED, MSG_WAITALL) == ASKED &&
	       send(fd, data, TOLD, MSG_NOSIGNAL | flags) == TOLD;
}

/* Count connections in turn, without a look at which of them is ready; 0: a new one each. */
static void answer_all(int listener, int count)
{
	int fds[CONNECTIONS], on = 1;

	/* what is accepted inherits it */
	setsockopt(listener, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
	for (int i = 0; i < count; i++)
		fds[i] = accept(listener, NULL, NULL);
	for (int i = 0;; i++) {
		int fd = count ? fds[i % count] : accept(listener, NULL, NULL);

		if (!answer(fd, count ? 0 : MSG_MORE))
			_exit(0);
		if (!count)
			close(fd);
	}
}

static bool ask(int fd)
{
	char data[ASKED] = "";

	return send(fd, data, ASKED, MSG_NOSIGNAL) == ASKED;
}

static bool hear(int fd)
{
	char data[TOLD];

	return recv(fd, data, TOLD, MSG_WAITALL) == TOLD;
}

/*
 * So many requests and answers over count connections with one on its way on each; 0: a new one for
 * each. us: how long each took. Returns the seconds, 0: an error.
 */
static double trips(int port, int count, double *us)
{
	int64_t sent[CONNECTIONS], begun, now;
	int fds[CONNECTIONS], n = 0;
	bool ok = true;

	for (int i = 0; i < count; i++)
		fds[i] = bench_socket(port);
	begun = now = bench_now();
	for (int i = 0; i < count; i++) {
		sent[i] = bench_now();
		ok = ok && ask(fds[i]);
	}
	while (ok && n < TRIPS) {
		int i = count ? n % count : 0;

		if (!count) {
			sent[0] = now;
			fds[0] = bench_socket_once(port);
			ok = ask(fds[0]);
		}
		ok = ok && hear(fds[i]);
		if (!count)
			close(fds[0]);
		now = bench_now();
		us[n++] = (double)(now - sent[i]) / 1e3;
		sent[i] = now;
		if (count)
			ok = ok && ask(fds[i]);
	}
	for (int i = 0; i < count; i++)
		close(fds[i]);
	return ok ? (double)(now - begun) / 1e9 : 0;
}

/* The best of three, as bench_served_reads has it. */
static void loopback(const char *where, int cpu, int count)
{
	static double us[TRIPS];
	struct sockaddr_in a = {.sin_family = AF_INET};
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	socklen_t len = sizeof(a);
	char name[64], many[16] = "";
	double best = 0, p50 = 0;
	pid_t pid;

	a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	if (listener < 0 || bind(listener, (void *)&a, sizeof(a)) ||
	    listen(listener, CONNECTIONS) || getsockname(listener, (void *)&a, &len))
		return;
	for (int round = 0; round < 3; round++) {
		double seconds;

		pid = fork();
		if (pid == 0) {
			prctl(PR_SET_PDEATHSIG, SIGKILL);
			bench_pin(0);
			answer_all(listener, count);
		}
		if (pid < 0)
			break;
		bench_pin(cpu);
		seconds = trips(ntohs(a.sin_port), count, us);
		if (seconds > 0 && TRIPS / seconds > best) {
			best = TRIPS / seconds;
			p50 = bench_percentile(us, TRIPS, 50);
		}
		kill(pid, SIGKILL);
		waitpid(pid, NULL, 0);
	}
	if (count == 0)
		snprintf(many, sizeof(many), ".new");
	else if (count > 1)
		snprintf(many, sizeof(many), ".%d", count);
	snprintf(name, sizeof(name), "limit.loopback.%s%s", where, many);
	bench_line(name, best, "1/s");
	snprintf(name, sizeof(name), "limit.loopback_p50.%s%s", where, many);
	bench_line(name, p50, "us");
	close(listener);
}

int main(void)
{
	static const int counts[] = {0, 1, 16, CONNECTIONS};

	bench_pin(0);
	memory("limit.cache", 16 << 10);
	memory("limit.memory", WORDS);
	if (bench_cpus() > 1) {
		cache_line();
		wake();
	}
	for (unsigned i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
		loopback("pinned", 0, counts[i]);
	/* beside it nobody waits in turn: more connections than one are no limit there */
	if (bench_cpus() > 1)
		loopback("apart", 1, 1);
	return 0;
}
