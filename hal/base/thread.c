/* SPDX-License-Identifier: MIT */
/* A new thread has the signals blocked that its maker has blocked. */
#include <errno.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/thread.h"
#include "hal/base/time.h"

#define YIELD_LONG_NS (NS_PER_MS / 2)
#define REST 32 /* after a long one there is none for so many times its time, */
#define REST_MOST_NS (10 * NS_PER_S) /* ... but not for longer: the process may have been stopped */

/* On the maker's stack, until the thread has taken it. */
struct start {
	const char *name;
	void *(*run)(void *ctx);
	void *ctx;
	sem_t taken;
};

/* A thread names itself: with its first line in run it has its name. */
static void *begin_thread(void *arg)
{
	struct start *start = arg;
	void *(*run)(void *ctx) = start->run;
	void *ctx = start->ctx;

	pthread_setname_np(pthread_self(), start->name);
	sem_post(&start->taken);
	return run(ctx);
}

int thread_start(pthread_t *thread, const char *name, size_t stack, void *(*run)(void *ctx),
                 void *ctx)
{
	struct start start = {.name = name, .run = run, .ctx = ctx};
	sigset_t all, before;
	pthread_attr_t attr;
	long least;
	int err = pthread_attr_init(&attr);

	if (err)
		return -err;
	/* 128 KiB on arm64, where x86-64 has 16 */
	least = sysconf(_SC_THREAD_STACK_MIN);
	if (least > 0 && stack < (size_t)least)
		stack = (size_t)least;
	err = pthread_attr_setstacksize(&attr, stack);
	sigfillset(&all);
	sigdelset(&all, SIGBUS);
	if (!err)
		err = pthread_sigmask(SIG_SETMASK, &all, &before);
	if (!err) {
		sem_init(&start.taken, 0, 0);
		err = pthread_create(thread, &attr, begin_thread, &start);
		pthread_sigmask(SIG_SETMASK, &before, NULL);
		while (!err && sem_wait(&start.taken) && errno == EINTR)
			;
		sem_destroy(&start.taken);
	}
	pthread_attr_destroy(&attr);
	return -err;
}

bool thread_yield(int64_t *rest_ns)
{
	int64_t begun_ns = clock_ns(CLOCK_MONOTONIC), ended_ns;

	if (begun_ns < *rest_ns)
		return false;
	sched_yield();
	ended_ns = clock_ns(CLOCK_MONOTONIC);
	if (ended_ns - begun_ns > YIELD_LONG_NS)
		*rest_ns = ended_ns + earlier_ns(REST * (ended_ns - begun_ns), REST_MOST_NS);
	return true;
}
