/* SPDX-License-Identifier: MIT */
/* Credit as time: what is asked for costs some, and time brings it back. */
#include "src/faces/mqtt/credit.h"

#include "hal/base/time.h"

bool credit_spend(struct credit *credit, const struct credit_rate *rate, int64_t now_ns)
{
	int64_t most_ns = rate->burst * rate->cost_ns,
		more_ns = credit->counted_ns ? now_ns - credit->counted_ns : most_ns;

	credit->credit_ns = earlier_ns(credit->credit_ns + more_ns, most_ns);
	credit->counted_ns = now_ns;
	if (credit->credit_ns < rate->cost_ns)
		return false;
	credit->credit_ns -= rate->cost_ns;
	return true;
}
