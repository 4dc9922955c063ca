/* SPDX-License-Identifier: MIT */
/*
 * Judges what an owserver answers to a READ: its readings come without the chip's bytes, so only
 * their number shows that they are none, and only a search that the chip was there.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Readings that mean a power fault: a thermometer that lost its supply answers 85 (its power-on
 * scratchpad), one whose conversion starved 127.94. The native bus sees it by the scratchpad; of a
 * server's reading there is the number alone. Which properties are such a thermometer's stands in
 * hal/chips (property.measures).
 */
struct guard {
	double last;     /* last reading that was believed */
	int64_t last_ns; /* when; 0: none yet */
};
/*
 * True if a reading means a power fault. 127.9375 always does, in any rounding. 85 does unless the
 * room was near it when last measured (within 5 degrees, no longer ago than 60 s): a boiler passes
 * 85 on its way.
 */
bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns);

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
/*
 * May the server's answer to a READ of path be what the idle wire gives for a chip that is away?
 * Then only a search for the device shows that it was there.
 */
bool proof_is_needed(const char *path);
