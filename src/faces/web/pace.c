/* SPDX-License-Identifier: MIT */
/* When changes of values go out to the streams. */
#include "src/faces/web/pace.h"

#include "hal/base/time.h"

#define LEAST_NS (20 * NS_PER_MS)
#define MOST_NS (100 * NS_PER_MS)
#define TIMES 20 /* what they cost, so long they rest */

static int64_t rest(const struct pace *pace)
{
	if (pace->spent_ns >= MOST_NS / TIMES)
		return MOST_NS;
	return pace->spent_ns * TIMES > LEAST_NS ? pace->spent_ns * TIMES : LEAST_NS;
}

void pace_spent(struct pace *pace, int64_t cpu_ns)
{
	pace->spent_ns += cpu_ns;
}

int64_t pace_due(const struct pace *pace)
{
	if (!pace->waits)
		return INT64_MAX;
	return pace->sent_ns ? pace->sent_ns + rest(pace) : 0;
}

bool pace_send(struct pace *pace, int64_t now_ns, uint64_t newest)
{
	if (now_ns < pace_due(pace))
		return false;
	*pace = (struct pace){.sent_ns = now_ns, .sent = newest};
	return true;
}
