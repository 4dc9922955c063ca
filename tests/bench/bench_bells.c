/* SPDX-License-Identifier: MIT */
/*
 * What it takes to wake the engine's thread while 1, 8 and 100 programs are connected, each with a
 * bell of its own: from the ring to the thread's next step, on the other CPU and on the same one,
 * and the CPU time of the thread. Beside it one futex word, which is all that version 0.9 had.
 */
#include <pthread.h>
#include <stdio.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "src/daemon/host/bells.h"
#include "src/memory/shm/futex.h"
#include "src/public/ows.h"
#include "tests/bench/aid.h"

#define WAKES 2000
#define BELLS 100
#define LONG_NS 1000000000

static struct bells bells;
static int rings[BELLS];
static uint32_t word;    /* the futex */
static uint32_t wanted;  /* wakes that were asked for */
static int64_t awake_ns; /* when the thread went on; 0: it has not yet */
static double cpu_ns;    /* of the thread, for a wake */
static int sleeper_cpu;
static bool by_futex;

static int64_t cpu_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void sleep_once(uint32_t n)
{
	if (by_futex) {
		segment_wait(&word, n, LONG_NS);
		return;
	}
	bells_look(&bells);
	if (!bells_close_eyes(&bells) && __atomic_load_n(&wanted, __ATOMIC_SEQ_CST) == n)
		bells_sleep(&bells, ows_now() + LONG_NS);
	bells_open_eyes(&bells);
}

static void *sleep_and_wake(void *ctx)
{
	int64_t begin;

	(void)ctx;
	bench_pin(sleeper_cpu);
	begin = cpu_now();
	for (uint32_t n = 0; n < WAKES; n++) {
		while (__atomic_load_n(&wanted, __ATOMIC_ACQUIRE) == n)
			sleep_once(n);
		__atomic_store_n(&awake_ns, bench_now(), __ATOMIC_RELEASE);
	}
	cpu_ns = (double)(cpu_now() - begin) / WAKES;
	return NULL;
}

static void wake(uint32_t n, int count)
{
	const uint64_t one = 1;

	__atomic_store_n(&wanted, n + 1, __ATOMIC_SEQ_CST);
	if (by_futex) {
		__atomic_store_n(&word, n + 1, __ATOMIC_SEQ_CST);
		segment_wake(&word, 1);
	} else if (write(rings[(int)n % count], &one, sizeof(one)) != sizeof(one)) {
		fprintf(stderr, "bells: a bell cannot be rung\n");
	}
}

static void measure(const char *name, int count, int cpu)
{
	static double us[WAKES];
	pthread_t thread;
	char line[64];

	word = wanted = 0;
	by_futex = count == 0;
	sleeper_cpu = cpu;
	if (pthread_create(&thread, NULL, sleep_and_wake, NULL))
		return;
	for (uint32_t n = 0; n < WAKES; n++) {
		int64_t begin, end;

		usleep(1000);
		__atomic_store_n(&awake_ns, 0, __ATOMIC_RELAXED);
		begin = bench_now();
		wake(n, count);
		while (!(end = __atomic_load_n(&awake_ns, __ATOMIC_ACQUIRE)))
			usleep(20);
		us[n] = (double)(end - begin) / 1e3;
	}
	pthread_join(thread, NULL);
	snprintf(line, sizeof(line), "bells.%s", name);
	bench_line(line, bench_percentile(us, WAKES, 50), "us");
	snprintf(line, sizeof(line), "bells.%s.cpu", name);
	bench_line(line, cpu_ns / 1e3, "us");
}

static void measure_both(const char *name, int count)
{
	char line[48];

	measure(name, count, bench_cpus() > 1);
	snprintf(line, sizeof(line), "%s.one_cpu", name);
	measure(line, count, 0);
}

int main(void)
{
	static const int counts[] = {1, 8, BELLS};
	int added = 0;
	char name[16];

	bench_pin(0);
	if (bells_open(&bells))
		return 1;
	measure_both("futex", 0);
	for (unsigned i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
		for (; added < counts[i]; added++) {
			rings[added] = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
			if (rings[added] < 0)
				return 1;
			bells_add(&bells, (unsigned)added, rings[added]);
		}
		snprintf(name, sizeof(name), "%d", counts[i]);
		measure_both(name, counts[i]);
	}
	bells_close(&bells);
	return bells.mutes != 0;
}
