/* SPDX-License-Identifier: MIT */
/* The native bus as a backend of the bus contract: create, submit, step, suspend, counters. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridges/sensor_table.h"
#include "hal/native/answer.h"
#include "hal/native/convert/convert.h"
#include "hal/native/convert/ending.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/convert/together.h"
#include "hal/native/first.h"
#include "hal/native/first_asked.h"
#include "hal/native/hunt.h"
#include "hal/native/job.h"
#include "hal/native/locate.h"
#include "hal/native/master.h"
#include "hal/native/native.h"
#include "hal/native/sensors.h"
#include "hal/native/state.h"
#include "hal/native/tables.h"
#include "hal/native/touch.h"

#define VOLATILE_NS (2 * NS_PER_S)
#define STABLE_NS (300 * NS_PER_S)
#define PRESENCE_NS (2 * NS_PER_S)
#define REST_NS (NS_PER_S / 2) /* after an error */
/* What a step may take of its own: the wire's slots and all between them. */
#define STEP_SLOTS 4
#define LATE_LEAST_NS (20 * TXN_MS)
#define LATE_MOST_NS (60 * NS_PER_S)

static const char *const count_names[COUNTS] = {
#define X(count, name) name,
	NATIVE_COUNTS(X)
#undef X
};

int native_create(const struct bus_ops *ops, const struct link_master_ops *master,
                  const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size)
{
	struct native *native = calloc(1, sizeof(*native));
	int err = -ENOMEM;

	if (!native)
		return err;
	native->jobs = calloc(NATIVE_DEPTH, sizeof(*native->jobs));
	if (!native->jobs || device_table_create(&native->table) || cache_create(&native->cache) ||
	    bus_init(&native->bus, ops, env))
		goto out;
	err = master->create(where, env, &native->master, why, why_size);
	if (err)
		goto out;
	native->volatile_ns = VOLATILE_NS;
	native->stable_ns = STABLE_NS;
	native->presence_ns = PRESENCE_NS;
	snprintf(native->where, sizeof(native->where), "%s:%s", ops->scheme, where);
	native_settings(native);
	for (int i = 0; i < COUNTS; i++)
		native->counters[i].name = count_names[i];
	*bus = &native->bus;
	return 0;
out:
	native_destroy(&native->bus);
	return err;
}

void native_destroy(struct bus *bus)
{
	struct native *native = (struct native *)bus;

	if (native->master) {
		if (native->up)
			native->master->ops->close(native->master);
		native->master->ops->destroy(native->master);
	}
	device_table_destroy(&native->table);
	sensor_table_free(&native->sensors);
	cache_destroy(&native->cache);
	free(native->jobs);
	free(native);
}

static int take_switch(bool *flag, const char *text, char *why, size_t why_size)
{
	*flag = strcmp(text, "on") == 0;
	if (*flag || strcmp(text, "off") == 0)
		return 0;
	snprintf(why, why_size, "expected on or off");
	return -EINVAL;
}

int native_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size)
{
	struct native *native = (struct native *)bus;
	struct link_master *master = native->master;

	if (strcmp(key, "Touch") == 0 && !master->ops->slow)
		return take_switch(&native->touch, text, why, why_size);
	if (strcmp(key, "Sensors") == 0)
		return sensors_read(&native->sensors, text, why, why_size);
	return master->ops->option ? master->ops->option(master, key, text, why, why_size)
	                           : -ENOENT;
}

/* The reader gets copies of whole words: the names stay, the values are taken anew each time. */
const struct bus_counter *native_counters(struct bus *bus, size_t *n)
{
	struct native *native = (struct native *)bus;

	for (int i = 0; i < COUNTS; i++)
		__atomic_store_n(&native->counters[i].value,
		                 __atomic_load_n(&native->count[i], __ATOMIC_RELAXED),
		                 __ATOMIC_RELAXED);
	*n = COUNTS;
	return native->counters;
}

int native_submit(struct bus *bus, struct bus_req *req)
{
	struct native *native = (struct native *)bus;

	for (unsigned i = 0; native->lent < NATIVE_DEPTH && i < NATIVE_DEPTH; i++) {
		struct job *job = &native->jobs[i];

		if (job->req)
			continue;
		memset(job, 0, sizeof(*job));
		job->req = req;
		job->order = native->order++;
		job->late_ns = native->late_ns;
		job->bus = -1;
		native->lent++;
		job->since_ns = native_now(native);
		return 0;
	}
	return -EAGAIN;
}

static int see_master(struct native *native, uint64_t *mark)
{
	*mark = 0;
	return native->master->ops->visible ? native->master->ops->visible(native->master, mark)
	                                    : 1;
}

static void refuse_all(struct native *native)
{
	for (unsigned i = 0; i < NATIVE_DEPTH; i++)
		if (native->jobs[i].req)
			job_answer(native, &native->jobs[i], -ENOTCONN);
}

/*
 * A master may be visible while the chip behind it is gone: then only a change of what is visible
 * is a reason to try again.
 */
void native_suspend(struct bus *bus, bool yes)
{
	struct native *native = (struct native *)bus;

	if (yes && native->up)
		master_down(native, 0, "suspended");
	if (yes) {
		refuse_all(native);
		native->failed = native->down_err && see_master(native, &native->failed_mark) > 0;
	}
	native->loss = (struct bus_loss){0};
	native->open_ns = native->pause_ns = 0;
}

int native_visible(struct bus *bus)
{
	struct native *native = (struct native *)bus;
	uint64_t mark;
	int visible = see_master(native, &mark);

	if (visible <= 0 || mark != native->failed_mark)
		native->failed = false;
	return visible > 0 && !native->failed;
}

/* It is looked for, and no part of it was written before. */
static bool is_looked_for(const struct job *job)
{
	return job->state == JOB_LOCATE && !job->verified &&
	       (!job->begun || job->req->op != BUS_WRITE);
}

struct link_master *native_master(struct bus *bus)
{
	struct native *native = (struct native *)bus;

	return native->up ? native->master : NULL;
}

void native_look(struct bus *bus, int64_t now)
{
	struct native *native = (struct native *)bus;

	for (unsigned n = 0; n < native->channels; n++)
		native->channel[n].search_ns = now;
	if (native->grow_ns != INT64_MAX)
		native->grow_ns = now;
}

/*
 * The time in which the host kept the thread from the processor does not count for a reading that
 * has begun: what was measured is late then, and not lost.
 */
static int64_t deadline_of(const struct native *native, const struct job *job)
{
	int64_t late = native->late_ns - job->late_ns;

	if (!job->begun || job->req->op != BUS_READ || is_looked_for(job))
		return job->req->deadline_ns;
	return job->req->deadline_ns + (late < LATE_MOST_NS ? late : LATE_MOST_NS);
}

static void note_late(struct native *native, int64_t since_ns, int64_t now)
{
	if (since_ns && now - since_ns > LATE_LEAST_NS)
		native->late_ns += now - since_ns;
}

static void expire_jobs(struct native *native, int64_t now, int64_t *next)
{
	for (unsigned i = 0; i < NATIVE_DEPTH; i++) {
		struct job *job = &native->jobs[i];

		if (!job->req)
			continue;
		int64_t deadline = deadline_of(native, job);
		if (bus_req_unwanted(job->req))
			job_answer(native, job, -ECANCELED);
		else if (deadline <= now)
			job_answer(native, job,
			           is_looked_for(job) ? locate_expired(native, job)
			           : job->begun       ? -EINPROGRESS
			                              : -ETIME);
		else
			*next = earlier_ns(deadline, *next);
	}
}

/*
 * *other: of those that read no thermometer the one that waits longest, whatever its rank. Before
 * all wires were searched, of those that need not wait for that.
 */
static struct job *pick_job(struct native *native, int64_t now, int64_t *next, struct job **other)
{
	struct job *best = NULL, *all = NULL;
	bool initial = native_initial(native);
	unsigned failed = 0;

	native->locate.waits = native->locate.urgent = false;
	for (unsigned i = 0; i < NATIVE_DEPTH; i++) {
		struct job *job = &native->jobs[i];

		if (initial && !first_asks(native, job))
			continue;
		if (job->req && job->state == JOB_NEW)
			job_look(native, job, now);
		if (job->req && job->state == JOB_LOCATE && !job->verified) {
			native->locate.waits = true;
			native->locate.urgent |= job->req->prio <= BUS_OUTPUT;
		}
		failed += job->req && job->txn.device && job->txn.device->failures;
		if (job->req && job->kind == JOB_CONVERT &&
		    (!all || (int32_t)(job->order - all->order) < 0))
			all = job;
		if (!job->req || !job_ready(native, job, now, next))
			continue;
		if (job_goes_first(native, job, best))
			best = job;
		if (!schedule_reads(job) &&
		    (!*other || (int32_t)(job->order - (*other)->order) < 0))
			*other = job;
	}
	native->all = all;
	native->failed_jobs = failed;
	return best;
}

/*
 * The engine sends its next request of an alarm at once, but its thread has to wake first. A
 * transaction begun meanwhile would make each step of the alarm wait for it.
 */
static bool awaits_alarm(struct native *native, const struct job *job, int64_t now)
{
	if (now >= native->follow_ns || (job && job->req->prio == BUS_ALARM))
		native->follow_ns = 0;
	return native->follow_ns;
}

/*
 * No request uses the branches of couplers now: switch them off, so that a short of one does not
 * short the wire. True: a branch was switched off.
 */
static bool rest_branches(struct native *native, int64_t now, int64_t *next)
{
	for (unsigned n = 0; n < native->channels; n++) {
		struct trunk *trunk = native->channel[n].trunk;

		if (!trunk || !trunk->on || native_held(native, n, NULL, now))
			continue;
		if (now < native->rest_ns) {
			*next = earlier_ns(native->rest_ns, *next);
			continue;
		}
		native_count(native, COUNT_TRANSACTIONS);
		int err = trunk_rest(trunk);
		if (err)
			native->rest_ns = native_now(native) + REST_NS;
		if (err && err != -ECOMM && err != -EBADMSG)
			master_recover(native, n, err);
		return true;
	}
	return false;
}

static void native_run(struct native *native, struct job *job, int64_t now)
{
	bool reads = schedule_reads(job);

	native->soon_ran = job->soon;
	native->schedule.doing = reads ? SCHEDULE_READ : SCHEDULE_OTHER;
	if (reads)
		together_step(native, job, now);
	else
		job_step(native, job, now);
}

/*
 * Before all wires were searched: outputs first, then others and the search in turn. Each device is
 * looked for when it is asked for. What an alarm, or an output, waits for comes before inputs: it
 * tells which chips have restarted, so that no input reads an output that has yet to be written
 * again. *yields: it is the search's turn, and a request could have it as well.
 */
static bool ask_early(struct native *native, int64_t now, int64_t *next, bool *yields)
{
	struct job *other = NULL, *job = pick_job(native, now, next, &other);

	if (native->locate.urgent && locate_step(native, now, false, next))
		return true;
	if (!job || job->req->prio > BUS_OUTPUT) {
		native->early = !native->early;
		if (first_hurries(native) || awaits_alarm(native, job, now))
			return false;
		*yields = native->early && (job || native->locate.waits);
		if (native->early)
			return false;
		if (native->locate.waits && locate_step(native, now, false, next))
			return true;
	}
	if (job)
		native_run(native, job, now);
	return job;
}

/*
 * One step of the wire at most, of what goes first. The order is the rule:
 *
 *   1. the master's trouble, its channels, requests that are too old
 *   2. until the first search has ended: what can be read early; then a step of that search, with
 *      which requests that came meanwhile take turns
 *   3. an alarm list that is awaited holds the wire
 *   4. outputs and alarms
 *   5. the request of a client for a device that was just touched
 *   6. what the schedule owes: a request that long work has kept waiting
 *   7. devices that are looked for urgently, and looks for devices
 *   8. a step of the periodic search
 *   9. conversions that are due
 *   10. devices that are looked for
 *   11. the other requests
 *   12. idle: the ends of conversions, branches that are switched off
 *
 * Each of these returns when the next step is due: now, as long as there is work.
 */
static int64_t step_once(struct native *native, int64_t now)
{
	int64_t next = INT64_MAX;
	struct job *other = NULL, *in_turn = NULL;
	bool yields = false;

	master_trouble(native, now, &next);
	master_grow(native, now, &next);
	if (!native->up)
		return now;
	expire_jobs(native, now, &next);
	if (native_initial(native) && ask_early(native, now, &next, &yields))
		return now;
	if (first_step(native, now, &next))
		return now;
	struct job *job = native_initial(native) ? NULL : pick_job(native, now, &next, &other);
	/* Others have waited for the search: they and the first readings take turns. */
	if (job && job->first == FIRST_TAKES_PART && other &&
	    (native->first_turn = !native->first_turn))
		job = other;

	if (awaits_alarm(native, job, now))
		return native->follow_ns;
	if (job && job->req->prio <= BUS_OUTPUT) {
		native_run(native, job, now);
		return now;
	}
	if (job && native->touched) {
		native->touched = false;
		native_run(native, job, now);
		return now;
	}
	struct job *owed = native->schedule.owes == OWES_ANY ? job : other;
	if (owed && native->schedule.owes) {
		/* A thermometer's new request becomes due by that, without the wire */
		if (owed->state != JOB_QUEUED || !schedule_asks(owed))
			native->schedule.owes = OWES_NOTHING;
		native_run(native, owed, now);
		return now;
	}
	if (!native_initial(native) &&
	    ((native->locate.urgent && locate_step(native, now, !job, &next)) ||
	     touch_step(native, now, &next)))
		return now;
	if (hunt_step(native, now, !job, &next))
		return now;
	if (convert_step(native, now, &next, &in_turn)) {
		if (in_turn)
			together_step(native, in_turn, now);
		return now;
	}
	if (!native_initial(native) && locate_step(native, now, !job, &next))
		return now;
	if (job) {
		native_run(native, job, now);
		return now;
	}
	if (ending_step(native, now, &next) || rest_branches(native, now, &next))
		return now;
	/* The search has nothing to do on a wire that is held: the request has the next turn. */
	return next > now && !yields ? next : now;
}

int64_t native_step(struct bus *bus, int64_t now)
{
	struct native *native = (struct native *)bus;
	int64_t next, due = native->due_ns;

	native->due_ns = 0;
	if (bus->suspended) {
		refuse_all(native);
		return INT64_MAX;
	}
	if (!native->up) {
		next = master_step(native, now);
		if (!native->up)
			refuse_all(native);
		return next;
	}
	int64_t began = native_now(native);
	uint64_t wire_ns = native->wire_ns;
	note_late(native, due, began);
	native->schedule.doing = SCHEDULE_FREE;
	next = step_once(native, now);
	int64_t ended = native_now(native);
	schedule_took(&native->schedule, began, ended);
	if (native->up)
		cost_take(native);
	if (native->wire_ns != wire_ns)
		note_late(native, began + STEP_SLOTS * (int64_t)(native->wire_ns - wire_ns), ended);
	native->due_ns = next > ended ? next : ended;
	return next;
}
