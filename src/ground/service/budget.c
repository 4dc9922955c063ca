/* SPDX-License-Identifier: MIT */
/* Counts what sending over a connection costs. */
#include <sys/resource.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/ground/service/budget.h"

/* A board with one slow core sends a full buffer over loopback within that. */
#define CALL_NS (NS_PER_MS / 2)
#define BYTE_NS 20
/* A call counts no more: where a hypervisor or the firmware has other work, nothing shows it. */
#define CALL_MOST_NS (BUDGET_CREDIT_NS / 2)

static int64_t preempted(void)
{
	struct rusage usage = {0};

	getrusage(RUSAGE_THREAD, &usage);
	return usage.ru_nivcsw;
}

int64_t budget_allowance(size_t bytes)
{
	return CALL_NS + (int64_t)bytes * BYTE_NS;
}

bool budget_spend(struct budget *b, int64_t now_ns, int64_t took_ns, size_t bytes)
{
	int64_t beyond_ns = took_ns - budget_allowance(bytes);

	b->spent_ns -= (now_ns - b->since_ns) / BUDGET_PACE;
	b->since_ns = now_ns;
	if (b->spent_ns < 0)
		b->spent_ns = 0;
	if (beyond_ns > 0)
		b->spent_ns += beyond_ns < CALL_MOST_NS ? beyond_ns : CALL_MOST_NS;
	b->over |= b->spent_ns > BUDGET_CREDIT_NS;
	return !b->over;
}

void budget_begin(const struct budget *b, struct budget_call *call)
{
	if (b->suspect) {
		call->switches = preempted();
		call->cpu_ns = clock_ns(CLOCK_THREAD_CPUTIME_ID);
	}
	call->begin_ns = clock_ns(CLOCK_MONOTONIC);
}

bool budget_end(struct budget *b, const struct budget_call *call, size_t bytes)
{
	int64_t now_ns = clock_ns(CLOCK_MONOTONIC), took_ns = now_ns - call->begin_ns;

	if (b->over || took_ns <= budget_allowance(bytes))
		return !b->over;
	if (!b->suspect) {
		b->suspect = true;
		return true;
	}
	/* some kernels do not count what an interrupt does in the thread as time of the thread */
	if (preempted() != call->switches)
		took_ns = clock_ns(CLOCK_THREAD_CPUTIME_ID) - call->cpu_ns;
	return budget_spend(b, now_ns, took_ns, bytes);
}
