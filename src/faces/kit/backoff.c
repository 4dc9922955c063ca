/* SPDX-License-Identifier: MIT */
/* Pauses that double up to the longest of their kind, and lie anywhere below it. */
#include <sys/random.h>

#include "hal/base/time.h"
#include "src/faces/kit/backoff.h"
#include "src/public/ows.h"

#define STEP_NS (2 * NS_PER_S)

static const int64_t most_ns[] = {
	[BACKOFF_AWAY] = 12 * NS_PER_S,
	[BACKOFF_REFUSED] = 60 * NS_PER_S,
};

uint64_t backoff_random(void)
{
	uint64_t random = 0;

	if (getrandom(&random, sizeof(random), GRND_NONBLOCK) < 0)
		random = (uint64_t)ows_now();
	return random;
}

int64_t backoff_spread(int64_t step_ns, uint64_t random)
{
	return step_ns / 8 + (int64_t)(random % (uint64_t)step_ns);
}

int64_t backoff_pause(struct backoff *backoff, enum backoff_why why, uint64_t random)
{
	int64_t step_ns = STEP_NS << backoff->failed[why];

	if (step_ns < most_ns[why])
		backoff->failed[why]++;
	else
		step_ns = most_ns[why];
	if (why == BACKOFF_REFUSED)
		backoff_met(backoff);
	return backoff_spread(step_ns, random);
}

void backoff_met(struct backoff *backoff)
{
	backoff->failed[BACKOFF_AWAY] = 0;
}

void backoff_forget(struct backoff *backoff)
{
	*backoff = (struct backoff){0};
}
