/* SPDX-License-Identifier: MIT */
/* Which readings of a thermometer mean that it lacks power. */
#include "guard.h"

#include <math.h>

#define NEAR_DEGREES 5.0
#define RECENT_NS    60000000000LL

bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns)
{
	bool near;

	/* owserver prints six digits: 127.9375 comes as 127.938 */
	if (fabs(degrees - 127.9375) < 0.001)
		return true;
	near = guard->last_ns && now_ns - guard->last_ns <= RECENT_NS &&
	       fabs(guard->last - 85.0) <= NEAR_DEGREES;
	if (fabs(degrees - 85.0) < 0.0005 && !near)
		return true;
	guard->last = degrees;
	guard->last_ns = now_ns;
	return false;
}
