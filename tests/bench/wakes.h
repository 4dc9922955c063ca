/* SPDX-License-Identifier: MIT */
/*
 * What it costs on this machine to wake the threads that a command passes: one in another process,
 * another there, and one here. The last hop is an eventfd too, or a TCP connection over loopback.
 */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct bench_wakes {
	int fd[3]; /* what each thread waits on */
	int last;  /* where the second thread writes */
	pid_t pid;
	pthread_t thread;
	int64_t awake_ns; /* when the third thread went on; 0: not yet */
};

/* False: the machine does not let us; nothing is left then. */
bool bench_wakes_start(struct bench_wakes *wakes, bool loopback);
/* Time from the first write until the third thread goes on, us; less than 0: it never did. */
double bench_wakes_once(struct bench_wakes *wakes);
void bench_wakes_end(struct bench_wakes *wakes);
