/* SPDX-License-Identifier: MIT */
/* One request on its way: what it waits for, its next step, what follows a failure. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/convert.h"
#include "hal/native/exchange.h"
#include "hal/native/hunt.h"
#include "hal/native/job.h"
#include "hal/native/job_txn.h"
#include "hal/native/listing.h"
#include "hal/native/locate.h"
#include "hal/native/outcome.h"
#include "hal/native/resolve.h"
#include "hal/native/tables.h"

static bool is_away(const struct native *native, const struct device *device)
{
	return !device || !device->present || device->astray ||
	       !native_has(native, device->channel);
}

static void look_read(struct native *native, struct job *job, int64_t now)
{
	const struct cache_entry *entry;

	native_count(native, COUNT_READS);
	if (job->fresh || job->property->offline || is_away(native, job->txn.device))
		return;
	entry = cache_find(&native->cache, job->txn.device, job->property, job->extension, now);
	if (entry)
		job_answer_cached(native, job, entry);
}

static void look_structure(struct native *native, struct job *job)
{
	int n = structure_print(job->property, job->extension, (char *)job->req->data,
	                        job->req->len);

	if (n > 0)
		job->out = (size_t)n;
	job_answer(native, job, n < 0 ? n : 0);
}

/* A zero to /simultaneous/temperature is taken, and nothing converts. */
static void look_convert(struct native *native, struct job *job)
{
	int err = job_take_value(job);

	job->taken = job->req->len;
	if (err || job->txn.number[0] == 0)
		job_answer(native, job, err);
}

/*
 * What needs no wire is answered at once; the rest waits in the state that this leaves. The order:
 * what the bus answers of itself; the path resolved; then by kind. A listing or a reading of a
 * device that is lost waits for the search of that device (locate_wait) before anything is answered
 * from what was known of it. A probe is answered from what was seen within presence_ns. A reading
 * is answered from the cache, or joins a conversion; a property without a wire is run to its end.
 */
void job_look(struct native *native, struct job *job, int64_t now)
{
	int err;

	if (job_answer_own(native, job))
		return;
	err = resolve(native, job);
	job->state = JOB_QUEUED;
	if (err) {
		job_answer(native, job, err);
		return;
	}
	bool lost = job->path.device.len && is_away(native, job->txn.device);
	job->soon = job->txn.device && job->txn.device->failures &&
	            job->txn.device->failures <= NATIVE_DOUBTS;
	switch ((enum job_kind)job->kind) {
	case JOB_NONE:
		return;
	case JOB_CONVERT:
		look_convert(native, job);
		/* fallthrough */
	case JOB_ALARM:
	case JOB_SCAN:
		job->channel = job->bus >= 0 ? (uint8_t)job->bus : 0;
		return;
	case JOB_STRUCTURE:
		look_structure(native, job);
		return;
	case JOB_LISTING:
		if (lost)
			break;
		native_count(native, COUNT_DIRECTORIES);
		if (job_asks_first(job, now))
			return;
		job_answer(native, job, job->req->op == BUS_DIR ? listing(native, job) : 0);
		return;
	case JOB_PROBE:
		if (job->path.device.len == 0 ||
		    (!job->fresh && !lost && !job->txn.device->likely &&
		     job->txn.device->ok_ns + native->presence_ns > now && job->txn.device->ok_ns))
			job_answer(native, job, 0);
		break;
	case JOB_PROPERTY:
		if (job->req->op == BUS_READ)
			look_read(native, job, now);
		else
			native_count(native, COUNT_WRITES);
		if (!job->req || lost)
			break;
		if (job->property->convert && job->req->op == BUS_READ && job->txn.device)
			convert_early(native, job, now);
		if (!job->property->offline || job_asks_first(job, now))
			return;
		while (job->req) {
			job_txn(native, job);
			job_run_property(native, job, now);
		}
	}
	if (job->req && lost)
		locate_wait(native, job, now);
}

static unsigned channel_of(const struct job *job)
{
	if (job->state == JOB_LOCATE || job->kind == JOB_SCAN || job->kind == JOB_ALARM ||
	    job->kind == JOB_CONVERT)
		return job->channel;
	return job->txn.device ? job->txn.device->channel : job->bus >= 0 ? (unsigned)job->bus : 0;
}

/*
 * A request for all to convert waits until no chip of its channel is at work. So those that came
 * later do not put another one to work before that, but for alarms and outputs.
 */
static bool waits_for_all(const struct native *native, const struct job *job, unsigned channel)
{
	const struct job *all = native->all;

	return all && all->req && all->kind == JOB_CONVERT && all->state == JOB_QUEUED &&
	       channel_of(all) == channel && job->req->prio > BUS_OUTPUT && !job->locks &&
	       (int32_t)(all->order - job->order) < 0 && native_at_work(native, channel);
}

bool job_ready(const struct native *native, const struct job *job, int64_t now, int64_t *next)
{
	const struct device *device = job->txn.device;
	unsigned channel = channel_of(job);
	int64_t when = 0;

	switch ((enum job_state)job->state) {
	case JOB_NEW:
	case JOB_DUE:
		return false;
	case JOB_QUEUED:
		if ((device && device->locked) ||
		    (job->kind == JOB_CONVERT && native_at_work(native, channel)) ||
		    waits_for_all(native, job, channel))
			return false;
		break;
	case JOB_LOCATE:
		if (!job->verified)
			return false;
		break;
	case JOB_CONVERTING:
		when = job->ready_ns;
		if (when <= now && device && device->locked)
			return false;
		break;
	case JOB_PREPARE:
	case JOB_RUN:
		when = job->txn.wake_ns;
		if ((device && device->locked && !job->locks) ||
		    (job->state == JOB_RUN && waits_for_all(native, job, channel)))
			return false;
		break;
	}
	int64_t held = native_has(native, channel) ? native_held(native, channel, job, now) : 0;

	when = later_ns(when, held);
	if (when > now) {
		*next = earlier_ns(*next, when);
		return false;
	}
	return true;
}

/* Of what goes soon every other one: the others have half of the steps. Many go at once. */
bool job_goes_first(const struct native *native, const struct job *a, const struct job *b)
{
	if (!b || a->req->prio != b->req->prio)
		return !b || a->req->prio < b->req->prio;
	if (a->soon != b->soon && (!native->soon_ran || native->failed_jobs >= NATIVE_MANY))
		return a->soon;
	return (int32_t)(a->order - b->order) < 0;
}

/* A probe is a search for the id: it shows presence, whatever the chip can be asked for. */
static void run_probe(struct native *native, struct job *job, int64_t now)
{
	job_txn(native, job);
	int there = txn_verify(&job->txn, false);

	job_saw(native, job, there > 0 ? 0 : -ENODEV, now);
	if (job->txn.link_error)
		job_failed(native, job, there);
	else if (there > 0)
		job_answer(native, job, 0);
	else
		job_missing(native, job, -ENODEV);
}

/* had_begun: before the step that this is */
static void begin_property(struct native *native, struct job *job, bool had_begun, int64_t now)
{
	if (job->path.device.len && is_away(native, job->txn.device)) {
		job->begun = had_begun;
		locate_wait(native, job, now);
		return;
	}
	bool asks = job_asks_first(job, now);
	if (job->kind == JOB_LISTING && !asks) {
		job_answer(native, job, listing(native, job));
		return;
	}
	if (job->kind == JOB_PROBE) {
		run_probe(native, job, now);
		return;
	}
	job_txn(native, job);
	if (asks) {
		job->state = JOB_RUN;
		job_run_asking(native, job, now);
		return;
	}
	if (job->property->convert && job->req->op == BUS_READ) {
		convert_begin(native, job, now);
		return;
	}
	job->state = JOB_RUN;
	job_run_property(native, job, now);
}

void job_step(struct native *native, struct job *job, int64_t now)
{
	bool had_begun = job->begun;

	job->begun = true;
	switch ((enum job_state)job->state) {
	case JOB_NEW:
	case JOB_DUE:
		return;
	case JOB_QUEUED:
		if (job->kind == JOB_SCAN || job->kind == JOB_ALARM)
			hunt_scan(native, job, now);
		else if (job->kind == JOB_CONVERT)
			convert_all(native, job);
		else
			begin_property(native, job, had_begun, now);
		return;
	case JOB_LOCATE:
		locate_missing(native, job, now);
		return;
	case JOB_PREPARE:
		convert_prepare(native, job, now);
		return;
	case JOB_CONVERTING:
		job->state = JOB_RUN;
		job_run_property(native, job, now);
		return;
	case JOB_RUN:
		if (job->kind == JOB_LISTING || job->property->offline)
			job_run_asking(native, job, now);
		else
			job_run_property(native, job, now);
	}
}
