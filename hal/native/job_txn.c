/* SPDX-License-Identifier: MIT */
/* The transactions of a job: what they are to do, and which older readings serve it. */
#include <string.h>

#include "hal/chips/format.h"
#include "hal/native/job_txn.h"
#include "hal/wire/driver.h"

#define VISIT_NS (2 * TXN_MS)

int64_t property_life_ns(const struct native *native, const struct property *property)
{
	switch ((enum property_life)property->life) {
	case LIFE_STATIC:
	case LIFE_STABLE:
		return native->stable_ns;
	case LIFE_VOLATILE:
		return native->volatile_ns;
	case LIFE_SECOND:
		return NS_PER_S;
	}
	return 0;
}

bool job_wants_all(const struct job *job)
{
	return job->extension == EXTENSION_ALL && !job->property->array.aggregate &&
	       job->property->type != PROPERTY_BITS;
}

static bool is_offered(const struct job *job)
{
	const struct txn *txn = &job->txn;

	return !job->property || job->property->offline || !txn->device || !txn->link ||
	       driver_offers(txn->link, txn->device->rom, job->property->name,
	                     job_wants_all(job) ? txn->element : job->extension);
}

/*
 * What of that which is kept serves the request: read after it came; or within the value's life,
 * if a cached one will do. A try that failed takes nothing from before. The flags that the alarm
 * machine asks for one after the other are read once: no write fits in between, as it would take
 * longer.
 */
static void take_limits(const struct native *native, struct job *job)
{
	struct txn *txn = &job->txn;
	int64_t now = native_now(native);

	txn->asked = job->prove == PROVE_READ || job->req->op != BUS_READ;
	txn->since_ns = job->failures || txn->asked ? INT64_MAX : job->since_ns;
	txn->oldest_ns = INT64_MAX;
	if (txn->since_ns == INT64_MAX || !job->property)
		return;
	if (!job->fresh)
		txn->oldest_ns = now - property_life_ns(native, job->property);
	txn->once = job->fresh && job->req->prio == BUS_ALARM && job->property->flag;
	if (txn->once)
		txn->oldest_ns = now - VISIT_NS;
}

void job_txn(struct native *native, struct job *job)
{
	struct txn *txn = &job->txn;
	struct device *device = txn->device;
	unsigned n = device ? device->channel : job->bus >= 0 ? (unsigned)job->bus : 0;

	/* All elements, and all chunks, are as old as the oldest. */
	int64_t shared_ns = job->out ? txn->shared_ns : 0;
	int64_t part_ns = job->out ? txn_measured(txn) : 0;
	memset(txn, 0, sizeof(*txn));
	txn->shared_ns = shared_ns;
	txn->part_ns = part_ns;
	txn->native = native;
	txn->device = device;
	txn->channel = n;
	txn->link = native->channel[n].link;
	txn->property = job->property;
	txn->one = job->extension >= 0;
	txn->element = job_wants_all(job)    ? (int)job->element
	               : job->extension >= 0 ? extension_element(job->extension)
	                                     : 0;
	if (job->req->op == BUS_READ) {
		txn->data = job->req->data + job->out;
		txn->room = job->req->len - job->out;
		if (job->property && job->property->type == PROPERTY_BINARY && !job_wants_all(job))
			txn->at = job->out;
	}
	take_limits(native, job);
	job->offered = is_offered(job);
}
