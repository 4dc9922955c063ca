/* SPDX-License-Identifier: MIT */
/*
 * What a connection may cost in the calls that send over it and receive from it. A local peer can
 * have its end watched as often as it likes (epoll on copies of the descriptor), and the kernel
 * walks along all of these watches in the thread that sends, also over loopback TCP. So each call
 * has an allowance, what it takes beyond that counts, and is forgiven at a slow pace: a connection
 * that has used its credit up is to be closed.
 *
 * A clock that goes on while the thread is preempted would close honest connections of a busy
 * machine. The clock of the thread is a system call. So that is asked only for a connection that
 * had a slow call before, which is not counted. Other pauses of the machine show nowhere: no call
 * uses up the credit alone.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BUDGET_CREDIT_NS 10000000
#define BUDGET_PACE 200 /* a two-hundredth of the time that passes is forgiven */

/* Of a connection; zeroed at its begin. */
struct budget {
	int64_t spent_ns, since_ns;
	bool suspect, over; /* over: it is to be closed */
};

struct budget_call {
	int64_t begin_ns, cpu_ns;
	int64_t switches; /* how often the thread was preempted */
};

/* What a call that moves so many bytes may take. */
int64_t budget_allowance(size_t bytes);
/* Count a call that took so long. False: the credit is used up. */
bool budget_spend(struct budget *budget, int64_t now_ns, int64_t took_ns, size_t bytes);

/* Before and after a call, in the same thread. False: the credit is used up. */
void budget_begin(const struct budget *budget, struct budget_call *call);
bool budget_end(struct budget *budget, const struct budget_call *call, size_t bytes);
