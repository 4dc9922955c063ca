/* SPDX-License-Identifier: MIT */
/* A new thread has the signals blocked that its maker has blocked. */
#include <signal.h>
#include <unistd.h>

#include "hal/bus/thread.h"

int thread_start(pthread_t *thread, const char *name, size_t stack, void *(*run)(void *ctx),
                 void *ctx)
{
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
		err = pthread_create(thread, &attr, run, ctx);
		pthread_sigmask(SIG_SETMASK, &before, NULL);
	}
	pthread_attr_destroy(&attr);
	if (!err)
		pthread_setname_np(*thread, name);
	return -err;
}
