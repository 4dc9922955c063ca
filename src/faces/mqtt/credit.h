/* SPDX-License-Identifier: MIT */
/* How many commands of a topic may come: a flood of one starves no other. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define CREDIT_A_SECOND 50
#define CREDIT_BURST 100

/* Of one topic; all zero: nothing has come yet. */
struct credit {
	int64_t counted_ns, credit_ns;
	int64_t given_ns; /* when the last command was taken */
};

/* Is there credit for one more? Then it is spent. It grows with time, up to that of a burst. */
bool credit_spend(struct credit *credit, int64_t now_ns);
