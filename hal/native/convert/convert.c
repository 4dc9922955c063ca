/* SPDX-License-Identifier: MIT */
/*
 * When thermometers convert. Those that are due on a channel are gathered and get one Convert T
 * with Skip ROM; the next waits until the results of the last have been read, as it would overwrite
 * them. Where it is faster each gets its own as soon as it was read (schedule.h). A parasitic one
 * needs the strong pull-up for as long as it converts, which holds the channel; on a channel that
 * has such a one, others are asked to convert one by one. A single one converts after all others
 * were started, and while they convert. Several convert with all others, under one pull-up.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/convert.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/convert/supply.h"
#include "hal/native/job_txn.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"

#define GATHER_NS (3 * TXN_MS)
#define GATHER_MAX_NS (3 * NS_PER_S)
#define ASKED_AGAIN_NS (150 * TXN_MS)
#define FED_MOST_NS (2 * NS_PER_S)
#define SIMULTANEOUS_NS (2 * NS_PER_S)
#define SINGLE_NS (60 * NS_PER_S)
/* Conversions in a row that a chip did not make, as what it holds shows. */
#define TRIES_UNHEARD 3

static unsigned wanted_bits(const struct job *job)
{
	return job->again == AGAIN_MARK ? THERMOMETER_MARK
	                                : thermometer_bits(job->txn.device, job->property->convert);
}

static bool is_right(const struct job *job)
{
	return thermometer_has_bits(job->txn.device, wanted_bits(job));
}

/* The result of another job's conversion has not been read yet: the next would overwrite it. */
static bool is_measuring(const struct native *native, const struct device *device)
{
	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (schedule_reads(job) && job->txn.device == device)
			return true;
	return false;
}

/* Another job has this device between its preparation and its reading, at its resolution. */
static bool is_taken(const struct native *native, const struct job *job)
{
	for (const struct job *other = NULL; (other = native_job(native, other));)
		if (other != job && other->txn.device == job->txn.device && schedule_asks(other) &&
		    (other->state == JOB_DUE || schedule_reads(other)))
			return true;
	return false;
}

/* One that came earlier waits to have the device at its resolution. */
static bool is_overtaking(const struct native *native, const struct job *job)
{
	for (const struct job *other = NULL; (other = native_job(native, other));)
		if (other->state == JOB_PREPARE && (other->waits || other->rests) &&
		    other->txn.device == job->txn.device &&
		    (int32_t)(other->order - job->order) < 0)
			return true;
	return false;
}

/*
 * A conversion that is under way or just over serves a job that does not insist on one of its own;
 * and a job that insists, if no other could read the result.
 */
static bool is_served(const struct native *native, const struct job *job, int64_t now)
{
	struct thermometer_last last = thermometer_last(job->txn.device);
	int64_t life = property_life_ns(native, job->property);
	int64_t cached = life < SIMULTANEOUS_NS ? life : SIMULTANEOUS_NS;
	int64_t fresh = job->req->prio == BUS_GUEST ? NS_PER_S : NATIVE_UNREAD_NS;

	return last.ends_ns && (!job->fresh || last.unread) && !job->again &&
	       last.ends_ns + (job->fresh ? fresh : cached) > now && is_right(job);
}

/*
 * While results are read a new request would wait behind them to be taken up at all. If nothing has
 * to be asked of the chip first, it is due at once.
 */
void convert_early(struct native *native, struct job *job, int64_t now)
{
	const struct device *device = job->txn.device;

	if (!schedule_early(native) || !device_power_known(device->power) || device->locked ||
	    !is_right(job) || native_held(native, device->channel, job, now) ||
	    is_overtaking(native, job))
		return;
	job->begun = true;
	job_txn(native, job);
	convert_begin(native, job, now);
}

void convert_begin(struct native *native, struct job *job, int64_t now)
{
	if (is_served(native, job, now)) {
		job->ready_ns = thermometer_last(job->txn.device).ends_ns;
		job->state = JOB_CONVERTING;
		return;
	}
	job->state = JOB_PREPARE;
	job->txn.phase = 0;
	convert_prepare(native, job, now);
}

static int prepare_chip(struct native *native, struct job *job)
{
	struct device *device = job->txn.device;

	if (job->txn.phase == 0 && !device_power_known(device->power)) {
		/* To a battery monitor that command is Convert V. */
		if (!native->channel[job->txn.channel].power_asked &&
		    !native_at_work(native, job->txn.channel))
			return supply_ask_all(native, job);
		int err = thermometer_ask_power(&job->txn);
		return err < 0 ? err : TXN_MORE;
	}
	if (job->txn.phase == 0 && thermometer_forgot(device))
		return thermometer_recall(&job->txn);
	if (job->txn.phase == 0 && is_right(job))
		return 0;
	int err = thermometer_prepare(&job->txn, wanted_bits(job));
	if (err == 0)
		job->txn.phase = 0;
	return err;
}

void convert_prepare(struct native *native, struct job *job, int64_t now)
{
	struct channel *channel = &native->channel[job->txn.channel];
	struct device *device = job->txn.device;

	if (job->txn.phase == 0 &&
	    ((!is_right(job) && is_taken(native, job)) || is_overtaking(native, job))) {
		/* Its turn comes when the other resolution has been read. */
		job->txn.wake_ns = now + GATHER_NS;
		job->waits = true;
		return;
	}
	job->waits = false;
	/* Others may use the chip meanwhile. */
	int64_t busy_ns = thermometer_last(device).busy_ns;
	job->rests = job->txn.phase == 0 && !is_right(job) && busy_ns > now;
	if (job->rests) {
		job->txn.wake_ns = busy_ns;
		return;
	}
	int err = txn_end(&job->txn, prepare_chip(native, job));

	job_saw(native, job, err, now);
	if (err < 0) {
		job_failed(native, job, err);
		return;
	}
	job->locks = err == TXN_MORE && job->txn.phase;
	device->locked = job->locks;
	if (err)
		return;
	job->state = JOB_DUE;
	if (!channel->due_ns)
		channel->due_ns = now;
}

/* All jobs that are due on the channel end with err, as if it had been theirs. */
static void fail_due(struct native *native, unsigned channel, int err)
{
	bool recovered = false;

	for (struct job *job = NULL; native->up && (job = native_job(native, job));) {
		if (job->state != JOB_DUE || job->txn.channel != channel)
			continue;
		if (err == -ENODEV || err == -EBADMSG || err == -ECOMM || !recovered) {
			job->txn.link_error = err == -ENODEV || err == -EBADMSG ? 0 : err;
			job->txn.silent = err == -EBADMSG;
			job_failed(native, job, err);
		} else {
			job_restart(native, job);
		}
		recovered = true;
	}
}

/* Of those that are due and free, but for fed: the most urgent, and of these the oldest. */
static struct job *next_due(struct native *native, unsigned n, const struct job *fed)
{
	struct job *first = NULL;

	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (job == fed || job->state != JOB_DUE || job->txn.channel != n ||
		    job->txn.device->locked || is_measuring(native, job->txn.device))
			continue;
		if (!first || job->req->prio < first->req->prio ||
		    (job->req->prio == first->req->prio &&
		     (int32_t)(job->order - first->order) < 0))
			first = job;
	}
	return first;
}

/* A job has told its chip to convert, at now at the latest. shown: the chip has shown it. */
static void told_one(struct native *native, struct job *job, int err, int64_t now, bool shown)
{
	struct device *device = job->txn.device;

	if (err < 0) {
		broadcast_told(native, device, now);
		job_failed(native, job, err);
		return;
	}
	native_count(native, COUNT_CONVERSIONS);
	broadcast_started(native, device, now, shown);
}

/* One by one: the first that is due and free. False: there is none. */
static bool convert_one(struct native *native, unsigned n, const struct job *fed)
{
	struct job *first = next_due(native, n, fed);

	if (!first)
		return false;
	struct device *device = first->txn.device;
	if (!first->txn.link->facts->strong && device->power != POWER_EXTERNAL) {
		job_failed(native, first, -EOPNOTSUPP);
		return true;
	}
	int err = txn_end(&first->txn, thermometer_start(&first->txn));
	int64_t now = native_now(native);

	job_saw(native, first, err, now);
	told_one(native, first, err, now, true);
	return true;
}

/*
 * Do all others of the channel convert, and long yet? While the pull-up of the one that the wire
 * feeds holds it, none can be started or read. Programs ask for a value again when they have the
 * last one. Where others are asked for without end, it has its turn after FED_MOST_NS.
 */
static bool may_hold(const struct native *native, unsigned n, const struct job *fed, int64_t now,
                     int64_t *next)
{
	if (now - fed->since_ns >= FED_MOST_NS)
		return true;
	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (job->txn.device != fed->txn.device && schedule_asks(job) &&
		    job->txn.device->channel == n &&
		    (job->state != JOB_CONVERTING || job->ready_ns <= now))
			return false;
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));) {
		int64_t again_ns = device->ok_ns + ASKED_AGAIN_NS;

		if (device == fed->txn.device || again_ns <= now || is_measuring(native, device))
			continue;
		*next = earlier_ns(again_ns, *next);
		return false;
	}
	return true;
}

/* The only one of the channel that the wire feeds is due. False: it waits, and no other starts. */
static bool convert_fed(struct native *native, unsigned n, const struct schedule_plan *plan,
                        int64_t now, int64_t *next)
{
	struct job *job = &native->jobs[plan->fed - native->jobs];
	struct device *device = job->txn.device;
	int64_t ns = thermometer_convert_ns(device);

	if (plan->others_due && convert_one(native, n, job))
		return true;
	if (plan->others_due || device->locked || is_measuring(native, device) ||
	    !may_hold(native, n, job, now, next))
		return false;
	int err = txn_end(&job->txn, thermometer_start_fed(&job->txn, ns));

	job->txn.strong = false;
	job->txn.wake_ns = 0;
	job_saw(native, job, err < 0 ? err : 0, now);
	now = native_now(native);
	if (err >= 0) {
		native_hold(native, n, NULL, now + ns);
		schedule_owe(&native->schedule, OWES_OTHER);
	}
	told_one(native, job, err, now, false);
	return true;
}

/* What it was known to have is true until it says otherwise: noise may hide the answer, too. */
static bool ask_silent(struct native *native, struct job *job)
{
	int bit = txn_end(&job->txn, thermometer_ask_power(&job->txn));

	job_saw(native, job, bit, native_now(native));
	if (bit < 0)
		job_failed(native, job, bit);
	return bit >= 0;
}

/*
 * In turn, as schedule.c has found it faster. A chip that does not show that it converts is tried
 * again. If it never does, it may have lost its supply, and is asked for that; or it is a clone
 * that shows nothing, and converts with all.
 */
void convert_in_turn(struct native *native, struct job *job)
{
	struct device *device = job->txn.device;
	int err = txn_end(&job->txn, thermometer_start(&job->txn));

	native->schedule.doing = SCHEDULE_START;
	schedule_owe(&native->schedule, err < 0 ? OWES_ANY : OWES_OTHER);
	job_saw(native, job, err, native_now(native));
	if (err < 0)
		broadcast_told(native, device, txn_ended(&job->txn));
	if (err == -EBADMSG && !job->txn.link_error) {
		native_count(native, COUNT_CHECKSUMS);
		native->channel[device->channel].checksums++;
		if (thermometer_last(device).missed + 1 != THERMOMETER_SILENT ||
		    ask_silent(native, job))
			thermometer_missed(device);
	} else if (err < 0) {
		job_failed(native, job, err);
	} else {
		native_count(native, COUNT_CONVERSIONS);
		broadcast_started(native, device, txn_ended(&job->txn), true);
	}
}

/*
 * Now and then all that are due start one by one, so that what each holds is no older than that
 * even if it is deaf to the broadcast. It costs the wire's time while they convert. Not with the
 * strong pull-up, nor where a driver sees to it.
 */
static bool starts_single(struct native *native, unsigned n, const struct schedule_plan *plan,
                          int64_t now)
{
	struct channel *channel = &native->channel[n];

	if (plan->parasitic || channel->link->driver)
		return false;
	if (!channel->single_ns)
		channel->single_ns = now + SINGLE_NS;
	return now >= channel->single_ns;
}

struct job *convert_next_in_turn(struct native *native, unsigned n, int64_t now)
{
	struct channel *channel = &native->channel[n];

	if (!channel->due_ns || native_held(native, n, NULL, now))
		return NULL;
	struct schedule_plan plan = schedule_look(native, n);

	return plan.due && !starts_single(native, n, &plan, now) &&
	                       schedule_in_turn(native, &plan, now)
	               ? next_due(native, n, NULL)
	               : NULL;
}

bool convert_step(struct native *native, int64_t now, int64_t *next, struct job **in_turn)
{
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1)) {
		struct channel *channel = &native->channel[n];

		if (!channel->due_ns || native_held(native, n, NULL, now))
			continue;
		struct schedule_plan plan = schedule_look(native, n);
		if (!plan.due) {
			channel->due_ns = 0;
			continue;
		}
		*in_turn = convert_next_in_turn(native, n, now);
		if (*in_turn)
			return true;
		if (plan.preparing && channel->due_ns + GATHER_MAX_NS > now)
			continue;
		if (channel->due_ns + GATHER_NS > now) {
			*next = earlier_ns(channel->due_ns + GATHER_NS, *next);
			continue;
		}
		if (plan.parasitic && supply_ask_one(native, n))
			return true;
		if (plan.fed && channel->link->facts->strong) {
			if (convert_fed(native, n, &plan, now, next))
				return true;
			continue;
		}
		if (plan.parasitic ? !plan.parasitic_due || !channel->link->facts->strong
		                   : starts_single(native, n, &plan, now)) {
			if (!convert_one(native, n, NULL))
				continue;
			if (plan.due == 1)
				channel->single_ns = now + SINGLE_NS;
			return true;
		}
		if (plan.reading || plan.locked)
			continue;
		native->schedule.doing = SCHEDULE_FREE;
		int err = broadcast_convert(native, n, plan.parasitic_due,
		                            plan.parasitic_due ? plan.all_ns : plan.due_ns);
		if (err < 0)
			fail_due(native, n, err);
		return true;
	}
	return false;
}

/* False: at another resolution than was thought, or the chip restarted since it began. */
static bool is_of_conversion(const struct job *job)
{
	if (!is_right(job))
		thermometer_void(job->txn.device);
	return thermometer_last(job->txn.device).ends_ns != 0;
}

/* It may be of an older conversion than was asked for: it is made once more. */
static bool is_doubtful(struct job *job)
{
	const struct txn *txn = &job->txn;

	switch ((enum job_again)job->again) {
	case AGAIN_NO:
		if (thermometer_doubtful(txn, job->fresh))
			job->again = thermometer_marks(txn->device) ? AGAIN_MARK : AGAIN_LAST;
		else if (thermometer_last(txn->device).cut && txn->measured_ns < job->since_ns &&
		         job->fresh)
			job->again = AGAIN_LAST;
		return job->again != AGAIN_NO;
	case AGAIN_MARK:
		/* What it shows now is to be told from the next result alone. */
		job->again = AGAIN_MARKED;
		return true;
	case AGAIN_MARKED:
		job->again = AGAIN_LAST;
		return txn->unproven;
	case AGAIN_LAST:
		break;
	}
	return false;
}

bool convert_instead(struct job *job, int err)
{
	static const char name[] = "temperature";
	const struct device *device = job->txn.device;

	if (err != -EIO || !job->txn.unproven || job->property->convert ||
	    !thermometer_last(device).ends_ns)
		return false;
	job->property = family_property(device->family, device, name, strlen(name));
	return true;
}

int convert_judge(struct job *job)
{
	const struct txn *txn = &job->txn;

	if (!job->property->convert || !txn->device)
		return 0;
	if (txn->unheard && ++job->tries >= TRIES_UNHEARD)
		return -EBADMSG;
	if (!is_of_conversion(job) || txn->unheard || is_doubtful(job))
		return TXN_MORE;
	/* Nothing proves it, and no conversion is known: it would be stated as of now. */
	return job->req->op == BUS_READ && txn->unproven && !txn->measured_ns ? -EBADMSG : 0;
}
