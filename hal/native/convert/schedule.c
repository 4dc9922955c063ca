/* SPDX-License-Identifier: MIT */
/* Which thermometers are asked for, what that costs, and which way is faster. */
#include "hal/native/convert/schedule.h"
#include "hal/base/time.h"
#include "hal/chips/thermometers/thermometer_proof.h"

/*
 * Before anything was measured: the slots by the data sheets of the DS2482. A reading is a reset,
 * Match ROM, a command and nine bytes; a start a reset, Match ROM, a command and a byte of slots
 * that show the chip busy.
 */
#define RESET_NS 1184000
#define SLOT_NS 69300
#define READ_NS (RESET_NS + 19 * 8 * SLOT_NS)
#define START_NS (RESET_NS + 11 * 8 * SLOT_NS)
#define MEAN_OF 8
#define OUTLIER 4 /* the thread did not run: no cost of the wire */
#define GAIN 20   /* in turn takes more of the wire, and has to gain one part in so many */
#define WINDOW_NS (4 * NS_PER_S)   /* some rounds: the share differs between reading and waiting */
#define FINE 1000                  /* in such parts of it */
#define LEAST_NS (WINDOW_NS / 100) /* with less nothing is gained */

bool schedule_asks(const struct job *job)
{
	return job->txn.device && job->property && job->property->convert &&
	       job->kind == JOB_PROPERTY;
}

static void look_at_job(struct schedule_plan *plan, const struct job *job, bool feeds)
{
	const struct device *device = job->txn.device;
	int64_t ns = thermometer_convert_ns(device);

	if (job->state != JOB_DUE && job->state != JOB_CONVERTING && job->state != JOB_RUN)
		return;
	plan->silent |= thermometer_last(device).missed >= THERMOMETER_SILENT;
	plan->longest_ns = ns > plan->longest_ns ? ns : plan->longest_ns;
	if (job->state != JOB_DUE) {
		plan->reading++;
		if (job->state == JOB_CONVERTING && job->ready_ns > plan->ready_ns)
			plan->ready_ns = job->ready_ns;
		return;
	}
	plan->due++;
	if (!feeds && device_is_fed(device->power)) {
		plan->parasitic_due = true;
		plan->fed = job;
	} else {
		plan->others_due = true;
	}
	plan->due_ns = ns > plan->due_ns ? ns : plan->due_ns;
}

/* The thermometers that are asked for, by the chip of the master; and those that are read alone. */
struct load {
	unsigned alone, together, most, width, chip[NATIVE_CHANNELS];
};

static void add_load(struct load *load, const struct native *native, unsigned channel)
{
	const struct link *link = native_abreast(native, channel);
	unsigned width = link ? link->ops->many(link) : 1, *chip;

	if (!link || width < 2) {
		load->alone++;
		return;
	}
	load->together++;
	load->width = load->width && load->width < width ? load->width : width;
	chip = &load->chip[link->chip % NATIVE_CHANNELS];
	load->most = ++*chip > load->most ? *chip : load->most;
}

/* In each group there is one of a chip at most. */
static unsigned rounds(const struct load *load)
{
	unsigned groups = load->width ? (load->together + load->width - 1) / load->width : 0;

	return load->alone + (groups > load->most ? groups : load->most);
}

static void look_at_jobs(struct schedule_plan *plan, const struct native *native, unsigned channel,
                         bool feeds)
{
	unsigned coming = UINT8_MAX, urgent = BUS_GUEST;
	struct load load = {0};

	for (const struct job *job = NULL; (job = native_job(native, job));) {
		if (!schedule_asks(job))
			continue;
		if (job->state == JOB_DUE || job->state == JOB_CONVERTING || job->state == JOB_RUN)
			add_load(&load, native, job->txn.device->channel);
		if (job->txn.device->channel != channel)
			continue;
		look_at_job(plan, job, feeds);
		if (job->state == JOB_PREPARE || job->state == JOB_QUEUED)
			coming = job->waits || job->req->prio > coming ? coming : job->req->prio;
		/* Whatever its rank: with each conversion of all it would wait anew. */
		if (job->state == JOB_PREPARE && job->rests)
			coming = 0;
		if (job->state == JOB_DUE)
			urgent = job->req->prio < urgent ? job->req->prio : urgent;
	}
	plan->preparing = coming <= urgent;
	plan->rounds = rounds(&load);
}

struct schedule_plan schedule_look(const struct native *native, unsigned channel)
{
	/* A driver sees to those that are fed by the wire. */
	bool feeds = native->channel[channel].link->driver;
	struct schedule_plan plan = {.driven = feeds};

	look_at_jobs(&plan, native, channel, feeds);
	if (!plan.due)
		return plan;
	plan.locked = native_at_work(native, channel);
	unsigned fed = 0;

	for (const struct device *device = NULL;
	     (device = native_thermometer(native, channel, device));) {
		int64_t ns = thermometer_convert_ns(device);
		plan.parasitic |= !feeds && device->power != POWER_EXTERNAL;
		fed += device->power != POWER_EXTERNAL;
		plan.all_ns = ns > plan.all_ns ? ns : plan.all_ns;
	}
	if (fed != 1)
		plan.fed = NULL;
	return plan;
}

/* Of a reading, or the start of one chip. */
static int64_t mean_cost(const struct schedule *schedule, enum schedule_work what)
{
	if (schedule->took_ns[what])
		return schedule->took_ns[what];
	return what == SCHEDULE_READ ? READ_NS : START_NS;
}

/* Of WINDOW_NS. */
static int64_t left_by_others(const struct schedule *schedule)
{
	int64_t others = later_ns(schedule->others_ns, schedule->last_ns);

	return others < WINDOW_NS ? WINDOW_NS - others : 0;
}

bool schedule_early(const struct native *native)
{
	return left_by_others(&native->schedule) > WINDOW_NS / 4 * 3;
}

/*
 * n thermometers of this channel and N of all are asked for without pause; a reading takes r, a
 * start s, a conversion c, and others have the share u of the time. Then each value is new
 *   all at once every c + n r: others, and other channels, have the time while the chips convert;
 *   in turn     every c + s + r;
 * but not more often than the thread comes round: N r / (1 - u), or N (r + s) / (1 - u). Where
 * chips of the master are read together, N is the number of those rounds. Of one
 * channel at 12 bits, in turn is faster up to some 80 thermometers. Where several channels
 * convert while others are read, all at once is, as soon as the thread has enough to do.
 *
 * If several became due together, they may convert sooner when the last results are read and one
 * Convert T serves them all.
 */
bool schedule_in_turn(const struct native *native, const struct schedule_plan *plan, int64_t now)
{
	const struct schedule *schedule = &native->schedule;
	int64_t read = mean_cost(schedule, SCHEDULE_READ),
		start = mean_cost(schedule, SCHEDULE_START);
	int64_t left = left_by_others(schedule);
	int64_t wait = plan->reading * read;

	/* A driver waits for the end of a conversion, and the thread for the driver. */
	if (!plan->reading || plan->driven || plan->parasitic || plan->silent || left < LEAST_NS)
		return false;
	int64_t at_once = later_ns(plan->longest_ns + (plan->due + plan->reading) * read,
	                           plan->rounds * read * FINE / (left / (WINDOW_NS / FINE)));
	int64_t round = plan->rounds * (read + start) * FINE / (left / (WINDOW_NS / FINE));
	int64_t in_turn = later_ns(plan->longest_ns + start + read, round + round / GAIN);
	return in_turn < at_once && plan->due * start <= later_ns(plan->ready_ns - now, wait);
}

bool schedule_reads(const struct job *job)
{
	return job->property && job->property->convert &&
	       (job->state == JOB_CONVERTING || job->state == JOB_RUN);
}

void schedule_took(struct schedule *schedule, int64_t began, int64_t now)
{
	int64_t took = now - began, *mean;

	if (now - schedule->window_ns >= WINDOW_NS) {
		schedule->last_ns = now - schedule->window_ns < 2 * WINDOW_NS ? schedule->others_ns
		                                                              : 0;
		schedule->others_ns = 0;
		schedule->window_ns = now;
	}
	if (took <= 0 || schedule->doing == SCHEDULE_FREE)
		return;
	if (schedule->doing == SCHEDULE_OTHER) {
		schedule->others_ns += took;
		return;
	}
	mean = &schedule->took_ns[schedule->doing];
	*mean = mean_cost(schedule, schedule->doing);
	if (took > OUTLIER * *mean)
		took = OUTLIER * *mean;
	*mean += (took - *mean) / MEAN_OF;
}
