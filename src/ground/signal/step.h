/* SPDX-License-Identifier: MIT */
/*
 * A limit for jumps: a reading that is far from the last good value is believed when a second one
 * is near it, and the value has had the time to get there.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* All zero: no value is good yet, so the first one needs a second one too. */
struct step {
	bool begun, held;          /* has it a good value, and one that is held back? */
	double good, doubt;        /* the last good value; the newest that is held back */
	int64_t good_ns, doubt_ns; /* when they were measured */
};

/*
 * Is a value that was measured at that time good, if it changes by at most most in a second? Off
 * the last good value by no more than most, it is. Else it is held back, until a newer measurement
 * is as near to it as the time between them allows, and as near to the last good value as the time
 * since that allows. The same measurement, given again by a cache, confirms nothing.
 */
bool step_passes(struct step *step, double most, double value, int64_t at_ns);

/* The value is known to be true, as one that was written: the next one is compared with it. */
void step_begin(struct step *step, double value, int64_t at_ns);
