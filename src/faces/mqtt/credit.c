/* SPDX-License-Identifier: MIT */
/* Credit for commands, as time: each costs some, and time brings it back. */
#include "src/faces/mqtt/credit.h"

#include "hal/base/time.h"

#define COST_NS (NS_PER_S / CREDIT_A_SECOND)

bool credit_spend(struct credit *credit, int64_t now_ns)
{
	credit->credit_ns += now_ns - credit->counted_ns;
	credit->counted_ns = now_ns;
	if (credit->credit_ns > CREDIT_BURST * COST_NS)
		credit->credit_ns = CREDIT_BURST * COST_NS;
	if (credit->credit_ns < COST_NS)
		return false;
	credit->credit_ns -= COST_NS;
	return true;
}
