/* SPDX-License-Identifier: MIT */
/* Transactions of several thermometers at the same time, each on another chip of the master. */
#include "hal/native/convert/together.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/convert.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/job.h"

#define READ_SCRATCHPAD 0xbe
#define SCRATCHPAD_SIZE 9

struct group {
	unsigned n;
	struct job *job[LINK_MANY];
	struct device *device[LINK_MANY];
	const struct bus_req *req[LINK_MANY]; /* the request of the job */
	uint8_t state[LINK_MANY];             /* ... and its state */
	struct link_run run[LINK_MANY];
	uint8_t out[LINK_MANY][TXN_SELECT + 1], in[LINK_MANY][SCRATCHPAD_SIZE];
};

static void together_add(const struct native *native, struct group *group, struct job *job)
{
	unsigned i = group->n++;
	bool starts = job->state == JOB_DUE;
	uint8_t command = starts ? THERMOMETER_CONVERT : READ_SCRATCHPAD;

	group->job[i] = job;
	group->device[i] = job->txn.device;
	group->req[i] = job->req;
	group->state[i] = job->state;
	group->run[i] = (struct link_run){
		.link = native_abreast(native, job->txn.device->channel),
		.part = {.reset = true,
	                 .out = group->out[i],
	                 .out_n = txn_select(job->txn.device, &command, 1, group->out[i]),
	                 .in = group->in[i],
	                 .in_n = starts ? 1 : SCRATCHPAD_SIZE},
	};
}

/* A group with this job. false: there is none. */
static bool together_begin(const struct native *native, struct group *group, struct job *job)
{
	group->n = 0;
	if (!native_abreast(native, job->txn.device->channel) || job->alone)
		return false;
	together_add(native, group, job);
	return true;
}

/* Is there room for a job on this channel? */
static bool fits_group(const struct native *native, const struct group *group, unsigned channel)
{
	const struct link *link = native_abreast(native, channel), *first = group->run[0].link;

	if (!link || link->ops->run_many != first->ops->run_many || group->n == LINK_MANY ||
	    group->n >= first->ops->many(first) || group->n >= link->ops->many(link))
		return false;
	for (unsigned i = 0; i < group->n; i++)
		if (group->run[i].link->chip == link->chip)
			return false;
	return true;
}

/*
 * Does the i-th job find its transaction done now? What befell a job before it may have answered
 * it, or made it begin again.
 */
static bool take_run(const struct native *native, struct group *group, unsigned i)
{
	struct job *job = group->job[i];

	if (!native->up || job->req != group->req[i] || job->state != group->state[i] ||
	    group->run[i].err)
		return false;
	txn_done(&job->txn, &group->run[i]);
	return true;
}

/* After its step the slot may be another request's: the run is no longer its. */
static void drop_run(struct group *group, unsigned i)
{
	txn_done(&group->job[i]->txn, NULL);
}

static bool reads_scratchpad(const struct job *job)
{
	return schedule_reads(job) && job->txn.device && job->txn.device->family->thermometer &&
	       job->txn.phase == 0 && job->req->op == BUS_READ;
}

/* Of those that are ready on chips that are not in the group yet, the one that goes first. */
static struct job *next_reading(struct native *native, const struct group *group, int64_t now)
{
	struct job *best = NULL;
	int64_t next = INT64_MAX;

	for (struct job *job = NULL; (job = native_job(native, job));)
		if (!job->alone && reads_scratchpad(job) &&
		    fits_group(native, group, job->txn.device->channel) &&
		    job_ready(native, job, now, &next) && job_goes_first(native, job, best))
			best = job;
	return best;
}

/* The starts first: until then a chip waits, and until a reading its result does. */
static void gather_group(struct native *native, struct group *group, int64_t now)
{
	struct job *job;

	for (unsigned n = 0; n < native->channels && n < NATIVE_CHANNELS; n++) {
		job = fits_group(native, group, n) ? convert_next_in_turn(native, n, now) : NULL;
		if (job && !job->alone)
			together_add(native, group, job);
	}
	while ((job = next_reading(native, group, now)))
		together_add(native, group, job);
}

static void step_alone(struct native *native, struct job *job, int64_t now)
{
	job->alone = false;
	if (job->state == JOB_DUE)
		convert_in_turn(native, job);
	else
		job_step(native, job, now);
}

void together_step(struct native *native, struct job *job, int64_t now)
{
	struct group group;
	bool reads = false;

	if ((job->state != JOB_DUE && !reads_scratchpad(job)) ||
	    !together_begin(native, &group, job)) {
		step_alone(native, job, now);
		return;
	}
	/* Not with others: an alarm or an output, which would wait for them. */
	if (job->req->prio > BUS_OUTPUT)
		gather_group(native, &group, now);
	if (group.n == 1) {
		step_alone(native, job, now);
		return;
	}
	group.run[0].link->ops->run_many(group.run, group.n);
	for (unsigned i = 0; i < group.n; i++) {
		group.job[i]->alone = group.run[i].err != 0;
		if (!group.run[i].err)
			continue;
		job_count_retry(group.job[i]);
		cost_of_job(native, group.job[i]);
		native_count(native, COUNT_TRANSACTIONS);
		native->channel[group.device[i]->channel].transactions++;
	}
	for (unsigned i = 0; i < group.n; i++) {
		reads |= group.state[i] != JOB_DUE;
		if (!take_run(native, &group, i)) {
			if (group.state[i] == JOB_DUE)
				broadcast_told(native, group.device[i], group.run[i].ended_ns);
			continue;
		}
		step_alone(native, group.job[i], native_now(native));
		drop_run(&group, i);
	}
	native->schedule.doing = reads ? SCHEDULE_READ : SCHEDULE_START;
}
