/* SPDX-License-Identifier: MIT */
/*
 * How long to leave a broker or a server alone before the next attempt. Different on each machine:
 * a thousand clients of a peer that restarts do not come together.
 */
#pragma once

#include <stdint.h>

enum backoff_why {
	BACKOFF_AWAY,    /* nobody answers: to ask again costs nobody anything; 13.5 s at most */
	BACKOFF_REFUSED, /* it answers and does not let us in, or throws us out; 67.5 s at most */
};
struct backoff {
	unsigned failed[BACKOFF_REFUSED + 1]; /* pauses of each kind, one after the other */
};

/* A random number. */
uint64_t backoff_random(void);
/* A time from an eighth of the step to nine of them. Pure. */
int64_t backoff_spread(int64_t step_ns, uint64_t random);
/* The pause after a failure of that kind; the next one is longer. Pure. */
int64_t backoff_pause(struct backoff *backoff, enum backoff_why why, uint64_t random);
/* The peer answers: if it is away again, the pauses begin anew. Those of a refusal go on. */
void backoff_met(struct backoff *backoff);
/* All is well for so long that all pauses begin anew. */
void backoff_forget(struct backoff *backoff);
