/* SPDX-License-Identifier: MIT */
/* Which readings of a thermometer mean that it lacks power. */
#include <math.h>

#include "hal/base/time.h"
#include "hal/owserver/guard.h"

#define NEAR_DEGREES 5.0
#define RECENT_NS (60 * NS_PER_S)

/*
 * 127.9375 in any rounding, from 127.9 to 128: nothing in there comes from a chip that measures
 * up to 125. What is above is no rounding of it: the range of the chip excludes that, and an alias
 * may be that of a chip which measures it.
 */
#define STARVED_LEAST 127.8995
#define STARVED_MOST 128.0005

bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns)
{
	bool near;

	if (degrees > STARVED_LEAST && degrees < STARVED_MOST)
		return true;
	near = guard->last_ns && now_ns - guard->last_ns <= RECENT_NS &&
	       fabs(guard->last - 85.0) <= NEAR_DEGREES;
	if (fabs(degrees - 85.0) < 0.0005 && !near)
		return true;
	guard->last = degrees;
	guard->last_ns = now_ns;
	return false;
}
