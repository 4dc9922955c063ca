/* SPDX-License-Identifier: MIT */
/* How often something may be asked for: a flood of one starves no other. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* So many at once, and then one in each cost_ns. */
struct credit_rate {
	int64_t cost_ns;
	int burst;
};

/* Of one topic; all zero: nothing has come yet. */
struct credit {
	int64_t counted_ns, credit_ns;
	int64_t given_ns; /* when the last command was taken */
};

/* Is there credit for one more? Then it is spent. It grows with time, up to that of a burst. */
bool credit_spend(struct credit *credit, const struct credit_rate *rate, int64_t now_ns);
