/* SPDX-License-Identifier: MIT */
/* How a request ends: its answer, what the cache keeps of it, what it lets go of. */
#include <errno.h>
#include <string.h>

#include "hal/chips/format.h"
#include "hal/native/answer.h"
#include "hal/native/job_txn.h"

#define FOLLOW_NS 500000

void job_unlock(struct native *native, struct job *job)
{
	for (unsigned chip = 0; chip < NATIVE_CHANNELS; chip++)
		if (native->holder[chip] == job)
			native->holder[chip] = NULL;
	if (job->locks && job->txn.device)
		job->txn.device->locked = false;
	job->locks = false;
}

/* A driver sees to the supply itself: owsd has not asked the chip for it. */
static uint8_t supply_of(const struct native *native, const struct device *device)
{
	const struct link *link = native->channel[device->channel].link;

	switch ((enum device_power)device->power) {
	case POWER_UNKNOWN:
	case POWER_ASSUMED:
		break;
	case POWER_PARASITE:
		return BUS_SUPPLY_PARASITE;
	case POWER_EXTERNAL:
		return link && link->driver ? BUS_SUPPLY_UNKNOWN : BUS_SUPPLY_EXTERNAL;
	}
	return BUS_SUPPLY_UNKNOWN;
}

static void answer_give(struct native *native, struct job *job, struct bus_answer *answer)
{
	const struct device *device = job->txn.device;
	uint64_t us = job->wire_ns / 1000;

	if (native->master->ops->simulated)
		answer->detail |= BUS_DETAIL_SIMULATED;
	answer->retries = job->retries;
	answer->wire_us = us < UINT32_MAX ? (uint32_t)us : UINT32_MAX;
	if (device) {
		answer->supply = supply_of(native, device);
		answer->identity = family_identity(device);
		if (device->channel != NATIVE_ALL)
			answer->wire = (uint8_t)(native->channel[device->channel].wire + 1);
	}
	job->req = NULL;
	native->lent--;
	native->bus.env->answer(native->bus.env->ctx, answer);
}

/* Of a request that asked the chip: does it fail again and again? */
static void note_failure(struct job *job, int err)
{
	struct device *device = job->txn.device;

	if (!device || job->kind != JOB_PROPERTY || job->property->offline)
		return;
	if (!err || err == -ENODATA || err == -EDOM)
		device->failures = 0;
	else if ((err == -EBADMSG || err == -EIO) && device->failures < UINT8_MAX)
		device->failures++;
}

/* What a request is answered that has failed for want of a true answer: why there was none. */
static int disturbed(const struct txn *txn)
{
	bool nothing = txn->misread ? txn->silent : txn->blank;

	return nothing ? -ENOMSG : txn->misread ? -EBADMSG : -EBADE;
}

void job_answer(struct native *native, struct job *job, int err)
{
	struct bus_answer answer = {.id = job->req->id,
	                            .err = err,
	                            .kind = BUS_TEXT,
	                            .measured_ns = native_now(native),
	                            .number = err == -EDOM ? job->txn.number[0] : 0};

	job_unlock(native, job);
	note_failure(job, err);
	if (err == -EBADMSG)
		answer.err = disturbed(&job->txn);
	if (!err && job->req->op == BUS_WRITE)
		answer.len = (uint32_t)job->taken;
	else if (!err)
		answer.len = (uint32_t)job->out;
	if (!err && job->req->op == BUS_READ) {
		const struct property *property = job->property;

		if (job->txn.link)
			answer.measured_ns = txn_measured(&job->txn);
		if (job->txn.shared_ns && !job->fresh)
			answer.detail |= BUS_DETAIL_CACHED;
		if (property && property->type == PROPERTY_BINARY)
			answer.kind = BUS_BYTES;
		if (property && format_is_number(property, job->extension)) {
			answer.kind = BUS_NUMBER;
			answer.number = format_as_number(property, job->extension, &job->txn);
		}
	}
	/* After an empty list the engine sends no next request. */
	if (job->req->prio == BUS_ALARM && (job->req->op != BUS_DIR || job->out))
		native->follow_ns = native_now(native) + FOLLOW_NS;
	answer_give(native, job, &answer);
}

void job_answer_cached(struct native *native, struct job *job, const struct cache_entry *entry)
{
	struct bus_answer answer = {.id = job->req->id,
	                            .kind = entry->kind,
	                            .len = entry->len,
	                            .detail = BUS_DETAIL_CACHED,
	                            .measured_ns = entry->measured_ns,
	                            .number = entry->number};

	if (entry->len > job->req->len) {
		job_answer(native, job, -EMSGSIZE);
		return;
	}
	memcpy(job->req->data, entry->text, entry->len);
	if (entry->kind == BUS_NUMBER && !entry->len && !job->req->number) {
		int n = format_alone(entry->property, entry->extension, entry->number,
		                     (char *)job->req->data, job->req->len);
		if (n < 0) {
			job_answer(native, job, n);
			return;
		}
		answer.len = (uint32_t)n;
	}
	native_count(native, COUNT_CACHE_HITS);
	answer_give(native, job, &answer);
}

bool job_answer_own(struct native *native, struct job *job)
{
	struct bus_answer answer = {
		.id = job->req->id, .kind = BUS_TEXT, .measured_ns = native_now(native)};

	if (!native->master->ops->own ||
	    !native->master->ops->own(native->master, job->req, &answer))
		return false;
	answer_give(native, job, &answer);
	return true;
}

/* Keep the answer for reads that need not be fresh, for as long as the property says. */
void job_keep(struct native *native, struct job *job)
{
	const struct property *property = job->property;
	int64_t measured = txn_measured(&job->txn);

	/* a list whose chip was written between two elements may be partly old */
	if (!job->txn.device || property->offline || job->out > CACHE_TEXT_MAX ||
	    job->changes != job->txn.device->changes)
		return;
	struct cache_entry *entry = cache_add(&native->cache, job->txn.device, property,
	                                      job->extension);
	entry->measured_ns = measured;
	entry->until_ns = measured + property_life_ns(native, property);
	entry->kind = property->type == PROPERTY_BINARY ? BUS_BYTES : BUS_TEXT;
	if (format_is_number(property, job->extension)) {
		entry->kind = BUS_NUMBER;
		entry->number = format_as_number(property, job->extension, &job->txn);
	}
	entry->len = (uint8_t)job->out;
	memcpy(entry->text, job->req->data, job->out);
}

/* The job begins anew, with the same request and what its tries have counted. */
void job_restart(struct native *native, struct job *job)
{
	job_unlock(native, job);
	job->state = JOB_QUEUED;
	job->merged = false;
	job->prove = PROVE_NOT;
	job->txn.wake_ns = 0;
}

void job_count_retry(struct job *job)
{
	if (job->retries < UINT8_MAX)
		job->retries++;
}

void job_again(struct native *native, struct job *job)
{
	job_count_retry(job);
	job_restart(native, job);
}

void job_reread(struct native *native, struct job *job)
{
	job_count_retry(job);
	job_unlock(native, job);
	job->prove = PROVE_NOT;
	job_txn(native, job);
	job->state = JOB_CONVERTING;
	job->ready_ns = native_now(native);
}
