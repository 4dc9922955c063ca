/* SPDX-License-Identifier: MIT */
/* Which readings jump, and which of these are believed after all. */
#include <math.h>

#include "src/ground/signal/step.h"

static double seconds(int64_t from_ns, int64_t until_ns)
{
	return (double)(until_ns - from_ns) / 1e9;
}

/* Does the reading that is held back, and the time, speak for the value? */
static bool is_confirmed(const struct step *step, double most, double value, int64_t at_ns)
{
	return step->held && at_ns > step->doubt_ns &&
	       fabs(value - step->doubt) <= most * fmax(1, seconds(step->doubt_ns, at_ns)) &&
	       (!step->begun || fabs(value - step->good) <= most * seconds(step->good_ns, at_ns));
}

bool step_passes(struct step *step, double most, double value, int64_t at_ns)
{
	if ((step->begun && fabs(value - step->good) <= most) ||
	    is_confirmed(step, most, value, at_ns)) {
		step_begin(step, value, at_ns);
		return true;
	}
	if (!step->held || at_ns > step->doubt_ns) {
		step->held = true;
		step->doubt = value;
		step->doubt_ns = at_ns;
	}
	return false;
}

void step_begin(struct step *step, double value, int64_t at_ns)
{
	*step = (struct step){.begun = true, .good = value, .good_ns = at_ns};
}
