/* SPDX-License-Identifier: MIT */
/*
 * Judges what an owserver answers to a READ: its readings come without the chip's bytes, so only
 * their number shows that they are none.
 */
#pragma once

#include <stddef.h>

#include "hal/owserver/guard.h"

/* So many thermometers of one server; of one that has lost its place to others, 85 is refused. */
#define JUDGE_ROWS 256
#define JUDGE_PLACES 4

/* All zero: nothing is known yet. */
struct judge {
	struct judge_place {
		uint64_t device;
		struct guard guard;
	} place[JUDGE_ROWS][JUDGE_PLACES];
};

/*
 * Are all numbers of the answer (a list has commas) ones that the chip of the path can have
 * measured? -EDOM: *number cannot be, which is not asked of a simulated device. -ERANGE: a reading
 * that means power fault. Else 0, also of what is no number or no measurement.
 */
int judge_reading(struct judge *judge, const char *path, const char *text, size_t len,
                  bool simulated, int64_t now_ns, double *number);
