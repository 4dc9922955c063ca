/* SPDX-License-Identifier: MIT */
/* The first values of thermometers, before the first search of their wire has ended. */
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/supply.h"
#include "hal/native/convert/together.h"
#include "hal/native/first.h"
#include "hal/native/first_asked.h"
#include "hal/native/guess.h"
#include "hal/native/job.h"
#include "hal/native/job_txn.h"
#include "hal/native/presence.h"
#include "hal/native/sensors.h"

#define FRESH_NS (5 * NS_PER_S) /* a result serves a request for so long */
#define READ_SCRATCHPAD 0xbe
#define SCRATCHPAD_SIZE 9
#define TRIES 2

static bool is_on(const struct path *path, unsigned n)
{
	return path->bus < 0 || path->bus == (int)n;
}

/* A result that is read too late serves nobody: all convert again, while the search goes on. */
static bool is_fresh(const struct native *native, unsigned n, int64_t now)
{
	return native->channel[n].first.ready_ns + FRESH_NS > now;
}

/* Have all that waited for the conversions of a wire got their readings, or can get none? */
static bool are_served(const struct native *native, unsigned n, int64_t now)
{
	for (const struct job *job = NULL; (job = native_job(native, job));) {
		struct path path;

		if (job->first != FIRST_TAKES_PART)
			continue;
		if (job->state != JOB_NEW
		            ? job->txn.device && job->txn.device->channel == n
		            : is_fresh(native, n, now) && first_names(native, job, &path) &&
		                      is_on(&path, n))
			return false;
	}
	return true;
}

/* Not yet, or once more, for those that asked since then. */
static bool may_convert(const struct native *native, unsigned n, int64_t now)
{
	const struct channel *channel = &native->channel[n];
	const struct first *first = &channel->first;

	if (!first_fits(native, n) || (!channel->searching && !first->likely))
		return false;
	if (first->tried && (first->refused || !first->ready_ns || first->ready_ns > now ||
	                     !are_served(native, n, now)))
		return false;
	/* All hear the command, also a chip that is at work for a request that went first. */
	return !native_held(native, n, NULL, now) && !native_at_work(native, n);
}

static bool has_thermometer(const struct native *native, unsigned n)
{
	if (native->channel[n].first.likely)
		return true;
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));)
		if (device->seen == native->channel[n].round)
			return true;
	return false;
}

/* What goes wrong here is seen to by the search, and by the conversions after it. */
static void first_convert(struct native *native, unsigned n)
{
	struct channel *channel = &native->channel[n];
	struct path path;

	channel->first.tried = channel->first.refused = true;
	if (supply_look(native, n) <= 0)
		return;
	supply_know(native, n, POWER_EXTERNAL);
	if (broadcast_convert(native, n, false, FIRST_LONGEST_NS) < 0)
		return;
	channel->first.refused = false;
	native->first_left = true;
	channel->first.ready_ns = channel->simultaneous_ns[SIMULTANEOUS_TEMPERATURE];
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (job->first != FIRST_LEFT && first_names(native, job, &path) && is_on(&path, n))
			job->first = FIRST_TAKES_PART;
}

static bool is_asked(const struct native *native, unsigned n)
{
	struct path path;

	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (job->first != FIRST_LEFT && first_names(native, job, &path) && is_on(&path, n))
			return true;
	return false;
}

/* What a table of the program answers waits for no wire. */
static bool needs_no_wire(const struct job *job, struct path *path)
{
	static const char name[] = "structure/";

	return job->state == JOB_NEW && !path_split(job->req->path, strlen(job->req->path), path) &&
	       !path->device.len && path->property.len >= strlen(name) &&
	       memcmp(path->property.text, name, strlen(name)) == 0;
}

/*
 * What came after the start of the conversions, and does not insist on one of its own, takes part
 * in them.
 */
static void take_new(struct native *native, int64_t now)
{
	struct path path;

	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (needs_no_wire(job, &path))
			job_look(native, job, now);
		else if (native->first_left && !job->first && first_names(native, job, &path))
			job->first = job->req->fresh || path.uncached || native->uncached
			                     ? FIRST_NO
			                     : FIRST_TAKES_PART;
	}
}

/* It waits for the result of the conversion that has begun for all, and for no other. */
static void attach(struct native *native, struct job *job, struct device *device)
{
	job->txn.device = device;
	job->begun = true;
	job->first = FIRST_TAKES_PART;
	job_txn(native, job);
	job->state = JOB_CONVERTING;
	job->ready_ns = thermometer_last(device).ends_ns;
}

/*
 * Read an id that no search has found yet. The answer proves the id, and is the request's reading.
 * A chip that does not answer is left to the search.
 */
static void read_unknown(struct native *native, struct job *job, unsigned n, int64_t now)
{
	_Alignas(max_align_t) uint8_t own[DEVICE_OWN] = {0};
	const uint8_t command = READ_SCRATCHPAD;
	struct device stranger = {.own = own, .channel = (uint8_t)n};
	struct txn txn = {.native = native,
	                  .link = native->channel[n].link,
	                  .channel = n,
	                  .device = &stranger};
	uint8_t out[TXN_SELECT + 1], in[SCRATCHPAD_SIZE];

	memcpy(stranger.rom, job->path.rom, sizeof(stranger.rom));
	stranger.family = sensors_family(&native->sensors, stranger.rom);
	native_count(native, COUNT_TRANSACTIONS);
	int err = txn_command(&txn, &command, 1);

	if (!err)
		err = txn_read_crc8(&txn, in, sizeof(in));
	if (!err)
		err = thermometer_saw(&txn, 0, in, sizeof(in));
	int64_t ended_ns = native_now(native);

	if (err) {
		if (txn.silent || ++job->tries == TRIES) {
			/* It was another one that begins so: the search may still find it. */
			job->first = job->likely ? FIRST_TAKES_PART : FIRST_LEFT;
			job->likely &= ~(UINT64_C(1) << n);
			job->tries = 0;
		}
		return;
	}
	presence_found(native, stranger.rom, n, now);
	struct device *device = device_find(&native->table, stranger.rom);
	if (!device || !first_took_part(native, device)) {
		job->first = FIRST_LEFT;
		return;
	}
	job->tries = 0;
	attach(native, job, device);
	const struct link_run run = {.part = {.reset = true,
	                                      .out = out,
	                                      .out_n = txn_select(&stranger, &command, 1, out),
	                                      .in = in,
	                                      .in_n = sizeof(in)},
	                             .ended_ns = ended_ns};
	txn_done(&job->txn, &run);
	job_step(native, job, native_now(native));
	/* After its step the slot may be another request's. */
	txn_done(&job->txn, NULL);
}

/* Whether a request that waits for the first conversions can be read now, and on which wire. */
static bool is_ready(struct native *native, struct job *job, int64_t now, int64_t *next,
                     unsigned *n)
{
	struct path path;

	if (job->first != FIRST_TAKES_PART)
		return false;
	if (job->state != JOB_NEW) {
		*n = job->txn.device ? job->txn.device->channel : 0;
		return (job->state == JOB_CONVERTING || job->state == JOB_RUN) &&
		       job_ready(native, job, now, next);
	}
	*n = 0;
	/* An unknown id can only be on the wire that is the only one. */
	bool only = native_next(native, 1) == NATIVE_ALL;
	if (!first_names(native, job, &path))
		return false;
	const struct device *device = device_find(&native->table, path.rom);
	bool known = device && device->present && !device->astray;
	if (known)
		*n = device->channel;
	else if (job->likely)
		*n = (unsigned)__builtin_ctzll(job->likely);
	else if (!only)
		return false;
	int64_t ready_ns = native->channel[*n].first.ready_ns;

	if (ready_ns > now)
		*next = earlier_ns(ready_ns, *next);
	return ready_ns && ready_ns <= now && is_fresh(native, *n, now) && is_on(&path, *n) &&
	       (!known ||
	        (first_took_part(native, device) && !thermometer_last(device).was_read)) &&
	       !native_held(native, *n, NULL, now);
}

static void first_read(struct native *native, struct job *job, unsigned n, int64_t now)
{
	if (job->state == JOB_NEW) {
		job_look(native, job, now);
		if (!job->req)
			return;
		struct device *device = job->txn.device;

		if (!device || !device->present) {
			/* The search has not found the device yet: resolve its path again. */
			job->state = JOB_NEW;
			read_unknown(native, job, n, now);
			return;
		}
		attach(native, job, device);
	}
	native->schedule.doing = SCHEDULE_READ;
	together_step(native, job, now);
}

/*
 * Some request waits for the end of the search. One for a temperature waits for the next
 * conversions.
 */
static bool others_wait(const struct native *native)
{
	struct path path;

	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (!job->first && !first_names(native, job, &path) && !first_asks(native, job))
			return true;
	return false;
}

static bool first_read_next(struct native *native, int64_t now, int64_t *next)
{
	struct job *best = NULL;
	unsigned n = 0, best_n = 0;

	take_new(native, now);
	native->first_turn = !native->first_turn;
	if (first_hurries(native) || (native->first_turn && others_wait(native)))
		return false;
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (is_ready(native, job, now, next, &n) && job_goes_first(native, job, best)) {
			best = job;
			best_n = n;
		}
	}
	if (!best)
		return guess_step(native, now);
	first_read(native, best, best_n, now);
	return true;
}

/* All searches have ended: requests for devices that were found wait for the first conversions. */
static void attach_all(struct native *native, int64_t now)
{
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (job->first != FIRST_TAKES_PART || job->state != JOB_NEW)
			continue;
		job->first = FIRST_NO;
		job_look(native, job, now);
		struct device *device = job->req ? job->txn.device : NULL;
		if (device && first_took_part(native, device) &&
		    thermometer_last(device).ends_ns + FRESH_NS > now)
			attach(native, job, device);
	}
}

/* A device that was found meanwhile was not asked for its supply. */
static bool first_end(struct native *native, int64_t now)
{
	take_new(native, now);
	attach_all(native, now);
	for (unsigned n = 0; n < native->channels; n++) {
		struct channel *channel = &native->channel[n];

		if (!channel->first.ready_ns)
			continue;
		channel->first.ready_ns = 0;
		bool external = !native_at_work(native, n) && supply_look(native, n) > 0;
		if (!external)
			supply_know(native, n, POWER_UNKNOWN);
		channel->power_asked = channel->all_external = external;
		return true;
	}
	native->first_left = false;
	return false;
}

bool first_step(struct native *native, int64_t now, int64_t *next)
{
	if (!native_initial(native))
		return native->first_left && first_end(native, now);
	for (unsigned n = 0; n < native->channels; n++) {
		if (!may_convert(native, n, now) || !has_thermometer(native, n) ||
		    !is_asked(native, n))
			continue;
		first_convert(native, n);
		return true;
	}
	return first_read_next(native, now, next);
}
