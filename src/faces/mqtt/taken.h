/* SPDX-License-Identifier: MIT */
/* Does another client take our id? By what ended the connections. Pure functions. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/time.h"

/* A connection that ends so soon is a brief one. Two clients of one id end those of each other. */
#define TAKEN_BRIEF_NS (10 * NS_PER_S)
#define TAKEN_BRIEF_MOST 3 /* of them in a row look like another client */

enum taken_end {
	TAKEN_TOLD,   /* the broker says that another client took the id */
	TAKEN_CLOSED, /* it closed the connection without a word; one that ends does that, too */
	TAKEN_OTHER,  /* a line that broke, a reason of another kind, or an attempt in vain */
};

/* All zero: nothing has ended yet. */
struct taken {
	bool contested; /* another client took the last connection: proved, not guessed */
	unsigned brief; /* connections in a row that the broker closed soon */
};

/* A connection has ended that lasted so long. True: another client took the id, or looks so. */
bool taken_end(struct taken *taken, enum taken_end end, int64_t lasted_ns);
/* The connection of now shows that another client took the last one. */
void taken_proved(struct taken *taken);
/* Is the connection of now in danger, as another client took the last one, or looks so? */
bool taken_again(const struct taken *taken);
