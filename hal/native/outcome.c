/* SPDX-License-Identifier: MIT */
/* How a transaction of a job ended: what that shows of link and device, and what follows. */
#include <errno.h>

#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/answer.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"
#include "hal/native/presence.h"

#define TRIES_CHECKSUM 3
#define TRIES_SHORT 2
#define TRIES_DEVICE 2
#define TRIES_LINK 6

void job_saw(struct native *native, struct job *job, int err, int64_t now)
{
	struct txn *txn = &job->txn;

	if (!txn->on_wire)
		return;
	txn->on_wire = false;
	native_count(native, COUNT_TRANSACTIONS);
	native->channel[txn->channel].transactions++;
	cost_of_job(native, job);
	if (!txn->link_error)
		master_good(native, txn->channel);
	if (txn->restarted && txn->device)
		presence_restarted(native, txn->device);
	txn->restarted = false;
	if (txn->heard && err != -EBADMSG && txn->device)
		presence_seen(txn->device, now);
	txn->heard = false;
}

static void failed_on_link(struct native *native, struct job *job, int err)
{
	unsigned channel = job->txn.channel;

	job->txn.link_error = 0;
	if (err == -ECOMM) {
		native_count(native, COUNT_SHORTS);
		native->channel[channel].shorts++;
		if (++job->tries >= TRIES_SHORT)
			job_answer(native, job, -ECOMM);
		else
			job_again(native, job);
		return;
	}
	if (!master_recover(native, channel, err))
		return;
	if (++job->tries >= TRIES_LINK)
		job_answer(native, job, -EIO);
	else
		job_again(native, job);
}

/* All ones, or no presence: is the device away? It is looked for once, on all channels. */
void job_missing(struct native *native, struct job *job, int err)
{
	if (job->verified) {
		job_answer(native, job, err == -ENODEV ? -EIO : err);
		return;
	}
	job_again(native, job);
	job->verified = true;
	job->tries = 0;
	job->channel = job->txn.device->channel;
	job->state = JOB_LOCATE;
}

/*
 * What was read wrong is read again: the conversion behind it was right. Not one that is over for
 * long, or that nothing is known of any more, as after the wire was opened again.
 */
static void begin_again(struct native *native, struct job *job)
{
	bool reads = job->state == JOB_RUN && schedule_asks(job) && job->req->op == BUS_READ;
	int64_t ends_ns = reads ? thermometer_last(job->txn.device).ends_ns : 0;

	if (ends_ns && ends_ns + NATIVE_UNREAD_NS > native_now(native))
		job_reread(native, job);
	else
		job_again(native, job);
}

/* What was converted is still there: the next request for it reads it, and converts nothing. */
static void give_up_reading(struct native *native, struct job *job, int err)
{
	if (schedule_asks(job))
		thermometer_unread(job->txn.device, true);
	job_answer(native, job, err);
}

/*
 * Is it tried again? A device that has failed request after request, which each tried it again,
 * gets one try of each: so it takes no more of the wire than one that answers. While many fail at
 * once, so does one that has failed, unless it is to be written.
 */
static bool is_tried_again(const struct native *native, struct job *job, unsigned tries)
{
	const struct device *device = job->txn.device;

	if (device &&
	    (device->failures > NATIVE_DOUBTS || (native->failed_jobs >= NATIVE_MANY &&
	                                          device->failures && job->req->prio > BUS_OUTPUT)))
		tries = 1;
	return ++job->tries < tries;
}

/* The adapter was lost; since then the device has not answered, nor was all searched. */
static bool may_have_moved(const struct native *native, const struct device *device)
{
	return device && native_initial(native) && device->ok_ns < native->up_ns;
}

void job_failed(struct native *native, struct job *job, int err)
{
	if (job->failures < UINT8_MAX)
		job->failures++;
	if (job->txn.link_error) {
		failed_on_link(native, job, job->txn.link_error);
		return;
	}
	switch (err) {
	case -EBADMSG:
		native_count(native, COUNT_CHECKSUMS);
		native->channel[job->txn.channel].checksums++;
		/* No answer at all: is it away? The looks for it are enough to tell. */
		if (!job->verified && ((job->txn.silent && job->txn.device) ||
		                       may_have_moved(native, job->txn.device))) {
			job_missing(native, job, err);
			return;
		}
		if (is_tried_again(native, job, TRIES_CHECKSUM)) {
			begin_again(native, job);
			return;
		}
		/* Perhaps another chip has taken its place: it is told anew. */
		if (job->txn.device && job->txn.device->family->doubted)
			family_forget(job->txn.device);
		if (job->txn.silent && job->txn.device)
			job_missing(native, job, err);
		else
			give_up_reading(native, job, err);
		return;
	case -ENODEV:
		if (job->txn.device)
			job_missing(native, job, err);
		else
			job_answer(native, job, err);
		return;
	case -ERANGE:
		native_count(native, COUNT_POWER_FAULTS);
		if (++job->faults >= 2) {
			job_answer(native, job, err);
			return;
		}
		if (job->property->convert)
			thermometer_void(job->txn.device);
		else if (job->txn.device)
			txn_void(&job->txn);
		job->fresh = true;
		job_again(native, job);
		return;
	case -EIO:
		if (is_tried_again(native, job, TRIES_DEVICE))
			job_again(native, job);
		else if (job->txn.blank && job->txn.device && !job->verified)
			job_missing(native, job, err);
		else
			job_answer(native, job, err);
		return;
	default:
		job_answer(native, job, err);
	}
}
