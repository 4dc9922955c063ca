/* SPDX-License-Identifier: MIT */
/* Looks for devices that did not answer, and for those that no search has found. */
#include <errno.h>
#include <string.h>

#include "hal/chips/bridges/i2c.h"
#include "hal/native/answer.h"
#include "hal/native/locate.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"
#include "hal/native/presence.h"
#include "hal/native/touch.h"

#define SHARE 10 /* looks take one part in so many of the time */
#define IDLE_SHARE 4
#define LOOK_MOST_NS NS_PER_S /* one that took longer: the host slept, or the adapter hung */
#define SAVED_NS NS_PER_S
#define TOUCH_NS (2 * NS_PER_S)
#define TRIES 3
#define MANY_MISSED 3
#define FOUND_IN_ROW 8
#define TRIES_LINK 6
#define FAMILY_BITS 8
#define ALL_BITS 64
#define APART 6 /* bits that are read after its id differs from all others */

/* While a chip of the master does not answer, any device may be behind it. */
static int not_found(const struct native *native)
{
	return native->grow_told ? -ENXIO : -ENODEV;
}

/* A search has found the job's device meanwhile. */
static bool is_found(struct native *native, struct job *job)
{
	struct device *device = device_find(&native->table, job->path.rom);

	if (!device || !device->present || device->astray ||
	    (job->bus >= 0 && device->channel != job->bus))
		return false;
	job->txn.device = device;
	job->state = JOB_QUEUED;
	return true;
}

/*
 * A branch of the wire was unplugged: of one after the other no try found anything. Then of the
 * next one that does not answer one try is enough. On a disturbed wire some try finds something.
 */
static unsigned tries_of(const struct channel *channel, int64_t now)
{
	return channel->missed == MANY_MISSED && now - channel->missed_ns < NS_PER_S ? 1 : TRIES;
}

static void count_missed(struct channel *channel, int64_t now)
{
	if (now - channel->missed_ns >= NS_PER_S)
		channel->missed = 0;
	channel->missed += channel->missed < MANY_MISSED;
	channel->missed_ns = now;
}

static void missing_end(struct native *native, struct job *job)
{
	int64_t now = native_now(native);

	count_missed(&native->channel[job->channel], now);
	/* A search may have met it on another wire since then. */
	bool moved = job->txn.device->channel != job->channel;

	if (moved && is_found(native, job))
		return;
	/*
	 * After the adapter was lost it may have been plugged in elsewhere. What was found by its
	 * first bits alone may be another one, and it on a wire that was not looked at.
	 */
	if (native_initial(native) || job->txn.device->likely) {
		job->txn.device->astray |= !moved;
		job->verified = false;
		locate_wait(native, job, now);
		return;
	}
	if (!moved)
		presence_lost(native, job->txn.device);
	job_answer(native, job, not_found(native));
}

void locate_missing(struct native *native, struct job *job, int64_t now)
{
	native_count(native, COUNT_TRANSACTIONS);
	int there = search_verify(native->channel[job->channel].link, job->path.rom, false);

	if (there == -EBADMSG)
		there = 0;
	if (there < 0) {
		job->txn.channel = job->channel;
		job->txn.link_error = there;
		job_failed(native, job, there);
		return;
	}
	master_good(native, job->channel);
	if (there) {
		native->channel[job->channel].missed = 0;
		presence_found(native, job->path.rom, job->channel, now);
		job->state = JOB_QUEUED;
	} else if (++job->tries >= tries_of(&native->channel[job->channel], now)) {
		missing_end(native, job);
	}
}

static bool is_waiting(const struct job *job)
{
	return job->req && job->state == JOB_LOCATE && !job->verified;
}

bool locate_wants(const struct native *native, const uint8_t prefix[8], unsigned bits)
{
	for (unsigned i = 0; native->locate.waits && i < NATIVE_DEPTH; i++)
		if (is_waiting(&native->jobs[i]) &&
		    search_same(native->jobs[i].path.rom, prefix, bits))
			return true;
	return false;
}

static bool is_for(const struct job *job, unsigned n)
{
	return job->bus < 0 || (unsigned)job->bus == n;
}

/* It takes part in looks from then on. Keys that are searched for all the time need none first. */
static int64_t looked_from(const struct native *native, const struct job *job)
{
	return job->locate_ns + (touch_seeks(native, job->path.rom) ? TOUCH_NS : 0);
}

/* Has a background search that began since then shown whether the id is there? */
static bool has_shown(const struct native *native, unsigned n, const uint8_t rom[8],
                      int64_t since_ns)
{
	if (native->channel[n].whole_ns < since_ns)
		return false;
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (device->channel == n && device->cut &&
		    search_same(device->rom, rom, device->cut) &&
		    memcmp(device->rom, rom, ROM_LEN) != 0)
			return false;
	}
	return true;
}

/* Was the channel searched as a whole, or for all keys, since the request came? */
static bool is_searched(const struct native *native, const struct job *job, unsigned n)
{
	const struct channel *channel = &native->channel[n];

	return has_shown(native, n, job->path.rom, job->since_ns) ||
	       (touch_seeks(native, job->path.rom) && channel->touch.whole_ns >= job->since_ns);
}

/* Has this channel still to be looked at for the job? */
static bool lacks_look(const struct native *native, const struct job *job, unsigned n)
{
	return is_for(job, n) && !is_searched(native, job, n) &&
	       native->channel[n].looked_ns < looked_from(native, job);
}

static bool lacks_any(const struct native *native, const struct job *job)
{
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1))
		if (lacks_look(native, job, n))
			return true;
	return false;
}

/* The device is nowhere. Until all is searched it may be behind a coupler not found yet. */
static bool is_decided(const struct native *native, const struct job *job)
{
	return !native_initial(native) && !lacks_any(native, job);
}

/* Every channel that it could be on has been looked at, or was found to be short. */
static void answer_away(struct native *native, struct job *job)
{
	struct device *device = device_find(&native->table, job->path.rom);
	bool heard = job->heard;

	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1))
		heard |= is_for(job, n) && is_searched(native, job, n);
	if (heard && device && device->astray)
		presence_lost(native, device);
	job_answer(native, job, heard ? not_found(native) : -ECOMM);
}

int locate_expired(const struct native *native, const struct job *job)
{
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1))
		if (is_for(job, n) && !native->channel[n].whole_ns)
			return -ETIME;
	return not_found(native);
}

void locate_wait(struct native *native, struct job *job, int64_t now)
{
	job->state = JOB_LOCATE;
	job->sought = job->heard = false;
	job->locate_ns = now;
	if (is_decided(native, job))
		answer_away(native, job);
}

/* The requests that need no look any more go on. Returns whether there are any. */
static bool let_decided_go(struct native *native)
{
	bool found = native->locate.found != native->count[COUNT_FOUND], any = false;

	native->locate.found = native->count[COUNT_FOUND];
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (!is_waiting(job))
			continue;
		/* A device that went astray may have answered another job where it was. */
		bool decided = is_decided(native, job);
		if (!((found || decided) && is_found(native, job)) && decided)
			answer_away(native, job);
		any |= !is_waiting(job);
	}
	return any;
}

/* Those that wait for this channel. Returns whether there are any. */
static bool gather_jobs(struct native *native, unsigned n, int64_t now, bool begin)
{
	bool any = false;

	for (struct job *job = NULL; (job = native_job(native, job));) {
		bool wanted = is_waiting(job) && lacks_look(native, job, n) &&
		              looked_from(native, job) <= now;

		any |= wanted;
		if (begin)
			job->sought = wanted;
	}
	return any;
}

/* A strong pull-up feeds a chip: no search may cut it. */
static bool is_held(const struct native *native, unsigned n, int64_t now, int64_t *next)
{
	int64_t until = native_held(native, n, NULL, now);

	if (until)
		*next = earlier_ns(until, *next);
	return until;
}

/* A channel to look at, the next in turn; false: there is none now. */
static bool locate_begin(struct native *native, int64_t now, int64_t *next)
{
	struct locate *locate = &native->locate;

	for (unsigned i = 1; i <= NATIVE_ALL; i++) {
		unsigned n = (locate->channel + i) % NATIVE_ALL;

		if (!native_has(native, n) || !gather_jobs(native, n, now, false) ||
		    is_held(native, n, now, next))
			continue;
		gather_jobs(native, n, now, true);
		locate->looking = true;
		locate->channel = n;
		locate->tries = 0;
		locate->begun_ns = now;
		return true;
	}
	return false;
}

/* heard: the channel is not short. */
static void locate_end(struct native *native, bool heard)
{
	struct locate *locate = &native->locate;

	for (struct job *job = NULL; (job = native_job(native, job));)
		if (is_waiting(job) && looked_from(native, job) <= locate->begun_ns &&
		    lacks_look(native, job, locate->channel))
			job->heard |= heard;
	locate->looking = false;
	native->channel[locate->channel].looked_ns = locate->begun_ns;
	let_decided_go(native);
}

/* The look failed for good. */
static void give_up(struct native *native, int err)
{
	native->locate.looking = false;
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (is_waiting(job) && job->sought)
			job_answer(native, job, err);
}

static void locate_failed(struct native *native, int err)
{
	struct locate *locate = &native->locate;

	locate->tries++;
	if (err == -ECOMM) {
		native_count(native, COUNT_SHORTS);
		native->channel[locate->channel].shorts++;
		locate_end(native, false);
	} else if (err == -EBADMSG) {
		native_count(native, COUNT_CHECKSUMS);
		if (locate->tries >= TRIES)
			locate_end(native, true);
	} else if (master_recover(native, locate->channel, err) && locate->tries >= TRIES_LINK) {
		give_up(native, -EIO);
	}
}

/*
 * So many bits of the id of the job are searched for. The answer of the chip will prove which one
 * it is: so bits that set the id apart from all others that are known, or asked for, and some more
 * are enough, once. All, if it did not answer after that, if nothing is to be read of the chip, and
 * for a bridge, which has some of these bits alone before it was woken.
 */
static unsigned bits_to_read(struct native *native, const struct job *job,
                             const uint8_t *const roms[], unsigned n)
{
	const uint8_t *rom = job->path.rom;
	const struct device *device = device_find(&native->table, rom);
	unsigned common = FAMILY_BITS;

	if (!device || device->likely || rom[0] == DS28E18_CODE || job->kind != JOB_PROPERTY ||
	    job->req->op != BUS_READ || job->property->offline)
		return ALL_BITS;
	for (unsigned i = 0; i < native->table.count + n; i++) {
		const uint8_t *other = i < n ? roms[i] : native->table.devices[i - n].rom;
		unsigned same = search_common(rom, other);

		if (same < ALL_BITS && same > common)
			common = same;
	}
	return common + 1 + APART < ALL_BITS ? common + 1 + APART : ALL_BITS;
}

/* One search, for all that are not decided yet. True: it found one. */
static bool locate_look(struct native *native, int64_t now)
{
	struct locate *locate = &native->locate;
	const uint8_t *roms[NATIVE_DEPTH];
	struct job *jobs[NATIVE_DEPTH];
	bool away[NATIVE_DEPTH] = {false};
	unsigned n = 0, left = 0;

	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (!is_waiting(job) || !job->sought)
			continue;
		jobs[n] = job;
		roms[n++] = job->path.rom;
	}
	if (!n) {
		locate_end(native, true);
		return false;
	}
	native_count(native, COUNT_TRANSACTIONS);
	unsigned bits = bits_to_read(native, jobs[0], roms, n);
	int there = search_among(native->channel[locate->channel].link, roms, away, n, bits);
	if (there < 0) {
		locate_failed(native, there);
		return false;
	}
	locate->tries = 0;
	master_good(native, locate->channel);
	if (there)
		presence_found(native, roms[0], locate->channel, now);
	if (there && bits < ALL_BITS) {
		device_find(&native->table, roms[0])->likely = true;
		/* what came back waits no whole turn of the others for its first value */
		jobs[0]->soon = true;
	}
	for (unsigned i = 0; i < n; i++) {
		if (there && memcmp(roms[i], roms[0], ROM_LEN) == 0 && !is_found(native, jobs[i]))
			job_answer(native, jobs[i], -ENODEV); /* the table is full */
		jobs[i]->sought &= !away[i];
		left += is_waiting(jobs[i]) && jobs[i]->sought;
	}
	if (!left)
		locate_end(native, true);
	return there;
}

static void save_credit(struct locate *locate, int64_t now)
{
	int64_t saved = locate->credit_ns + (now - locate->counted_ns) / SHARE;

	locate->credit_ns = saved < SAVED_NS ? saved : SAVED_NS;
	locate->counted_ns = now;
}

/* When the next search may be made. */
static int64_t when_due(const struct locate *locate, int64_t now, bool idle)
{
	int64_t least = locate->urgent ? -SAVED_NS : 0;
	int64_t when = locate->credit_ns >= least ? now : now + (least - locate->credit_ns) * SHARE;

	return idle && locate->idle_ns < when ? locate->idle_ns : when;
}

bool locate_step(struct native *native, int64_t now, bool idle, int64_t *next)
{
	struct locate *locate = &native->locate;

	locate->looking &= locate->waits && native_has(native, locate->channel);
	if (!locate->waits)
		return false;
	save_credit(locate, now);
	/* Others may have found devices, or searched a channel as a whole. */
	if (let_decided_go(native))
		return true;
	int64_t when = when_due(locate, now, idle && *next - now > locate->took_ns);
	if (when > now) {
		*next = earlier_ns(when, *next);
		return false;
	}
	/* Between two searches others have had the wire. */
	if (locate->looking ? is_held(native, locate->channel, now, next)
	                    : !locate_begin(native, now, next))
		return false;
	bool found = locate_look(native, now);
	locate->took_ns = earlier_ns(native_now(native) - now, LOOK_MOST_NS);
	/* A whole wire that comes back is not to wait. */
	if (!found) {
		locate->credit_ns -= locate->took_ns;
		locate->idle_ns = now + IDLE_SHARE * locate->took_ns;
	}
	/* Of a branch that comes back several are found before others have a turn. */
	locate->in_row = found ? (uint8_t)((locate->in_row + 1) % FOUND_IN_ROW) : 0;
	native->touched = !locate->in_row;
	return true;
}
