/* SPDX-License-Identifier: MIT */
/* What the work of a bus has cost, as its links and its master count it. */
#include "hal/native/cost.h"

/* What a wire has done since it was looked at last, ns of its slots. */
static uint64_t take_wire(struct native *native, unsigned wire)
{
	struct link *link = native->channel[wire].link;
	struct link_cost cost = {0};
	uint64_t grown;

	if (link->ops->cost)
		link->ops->cost(link, &cost);
	/* The master may open with fewer channels than before, or begin anew to count. */
	grown = cost.wire_ns -
	        (cost.wire_ns < native->wire_seen_ns[wire] ? 0 : native->wire_seen_ns[wire]);
	native->wire_ns += grown;
	native->wire_seen_ns[wire] = cost.wire_ns;
	return grown;
}

void cost_of_job(struct native *native, struct job *job)
{
	job->wire_ns += take_wire(native, native->channel[job->txn.channel].wire);
}

void cost_take(struct native *native)
{
	struct link_master_cost shared = {0};

	for (unsigned i = 0; i < native->channels; i++)
		take_wire(native, i);
	if (native->master->ops->cost)
		native->master->ops->cost(native->master, &shared);
	__atomic_store_n(&native->count[COUNT_WIRE_US], native->wire_ns / 1000, __ATOMIC_RELAXED);
	__atomic_store_n(&native->count[COUNT_I2C_TRANSFERS], shared.transfers, __ATOMIC_RELAXED);
	__atomic_store_n(&native->count[COUNT_SYSCALLS], shared.syscalls, __ATOMIC_RELAXED);
}
