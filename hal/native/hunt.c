/* SPDX-License-Identifier: MIT */
/*
 * Searches. In the background each channel is searched for ever, one device a pass, when nothing
 * else is to do and nothing will be before the pass is over; where there always is something, a
 * hundredth of the time or one pass a second. What two searches in a row did not see and no
 * transaction heard is lost.
 *
 * A pass does not ask a known device for the rest of its id again: the pass is cut some bits after
 * those that set the device apart from the others. A new device differs from it before that, or a
 * pass that goes to the end finds it; one pass in sixteen does, of each device in turn. With the
 * option Touch no pass is cut: more passes would make keys wait.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/bridges/i2c.h"
#include "hal/native/answer.h"
#include "hal/native/branches.h"
#include "hal/native/hunt.h"
#include "hal/native/listing.h"
#include "hal/native/locate.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"
#include "hal/native/presence.h"
#include "hal/native/sensors.h"

#define PASS_NS (NS_PER_S * 12 / 100)
#define PASS_TOUCH_NS (NS_PER_S / 10)
#define PASS_SHARE 8                /* passes take one part in so many of the time */
#define PASS_MOST_NS (5 * NS_PER_S) /* one that took longer: the host slept, the adapter hung */
#define OVERDUE_SHARE 40            /* ... or in so many where something else is always to do, */
#define OVERDUE_MIN_NS (NS_PER_S * 6 / 10)
#define OVERDUE_NS NS_PER_S     /* ... but one is made after this time */
#define ROUND_NS (5 * NS_PER_S) /* between two, */
#define BEGIN_NS (9 * NS_PER_S) /* ... or from begin to begin of a wire where that is sooner */
#define AGAIN_NS (NS_PER_S / 2)
#define MISSED_MAX 2
#define TRIES 3
#define TRIES_PASS 8 /* of a search for one device; a search of many goes on from there */
#define FAMILY_BITS 8
#define APART 6 /* bits of a known device that are read after it is alone */
#define WHOLE_EVERY 16
#define FULL_EVERY 16 /* alarm searches in a row: one looks for ids that are not known, too */

/*
 * whole: it was right to its end. A pass that is cut ends without a checksum: so the last round by
 * which a device is lost is one whose passes go to the end. One that was found by its first bits
 * alone may be another: what began as it is no sign of it, until it has answered.
 */
static void end_round(struct native *native, unsigned n, bool whole, int64_t now)
{
	struct channel *channel = &native->channel[n];

	channel->searching = false;
	channel->listed = true;
	channel->search_ns = now + ROUND_NS;
	if (!native->touch && n < NATIVE_CHANNELS &&
	    channel->search_ns > channel->round_ns + BEGIN_NS)
		channel->search_ns = channel->round_ns + BEGIN_NS;
	if (channel->dirty) {
		channel->search_ns = now + AGAIN_NS;
		return;
	}
	if (whole)
		channel->whole_ns = channel->round_ns;
	bool cuts = channel->cuts;
	channel->cuts = !native->touch;
	for (struct device *device = NULL; (device = native_device(native, n, device));) {
		if (!device->likely &&
		    (device->seen == channel->round || device->ok_ns >= channel->round_ns))
			continue;
		if (++device->missed >= MISSED_MAX && !cuts) {
			presence_lost(native, device);
			continue;
		}
		channel->search_ns = now + AGAIN_NS;
		channel->cuts = false;
	}
}

static void told_short(struct native *native, unsigned n, bool is_short)
{
	struct channel *channel = &native->channel[n];
	char name[BUS_EVENT_TEXT - 24], text[BUS_EVENT_TEXT];

	if (channel->is_short == is_short)
		return;
	channel->is_short = is_short;
	branches_name(native, n, name, sizeof(name));
	snprintf(text, sizeof(text), "%s is %sshort%s", name, is_short ? "" : "not ",
	         is_short ? "" : " any more");
	native_event(native, BUS_NOTE, NULL, is_short ? -ECOMM : 0, text);
}

struct whole {
	struct native *native;
	struct job *job;
	unsigned n;
	int err;
};

static int whole_found(void *ctx, const uint8_t rom[8])
{
	struct whole *whole = ctx;
	struct native *native = whole->native;

	presence_found(native, rom, whole->n, native_now(native));
	if (whole->job)
		whole->err = listing_add_device(native, whole->job,
		                                device_find(&native->table, rom));
	return whole->err;
}

/* A link that can only search as a whole does so in one step. */
static bool only_whole(const struct link *link)
{
	return link->ops->search && !link->ops->triplet;
}

static int next_device(struct native *native, unsigned n, struct search *search, struct job *job)
{
	struct link *link = native->channel[n].link;
	struct whole whole = {.native = native, .job = job, .n = n};

	native_count(native, COUNT_SEARCHES);
	native_count(native, COUNT_TRANSACTIONS);
	if (!only_whole(link))
		return search_next(search, link);
	search->last = true;
	bool alarm = search->command == ONEWIRE_ALARM_SEARCH;
	link->whole = job && job->req->whole;
	int err = link->ops->search(link, alarm, search->family, whole_found, &whole);
	return whole.err ? whole.err : err < 0 ? err : 0;
}

/*
 * A bridge that has just got power has no id of its own. It is woken if the table of sensors names
 * bridges of its kind: it gets its id, and the next round finds it. The ids on the wire changed
 * during this round, so the round is void: it calls no device lost. If the round before found such
 * a bridge too, waking had no effect: then this round is not void, or a bridge that cannot be woken
 * would keep every lost device present. Returns whether the id was such a bridge's.
 */
static bool wake_bridge(struct native *native, unsigned n, const uint8_t rom[8])
{
	struct channel *channel = &native->channel[n];
	struct txn txn = {.native = native, .link = channel->link, .channel = n};

	if (!ds28e18_asleep(rom) || !sensors_has(&native->sensors, rom[0]))
		return false;
	native_count(native, COUNT_TRANSACTIONS);
	(void)txn_end(&txn, ds28e18_wake(&txn));
	if (!channel->asleep_round || channel->asleep_round + 1 != channel->round) {
		channel->dirty = true;
		channel->looked_ns = 0; /* whoever looked for its id looks again */
	}
	channel->asleep_round = channel->round;
	return true;
}

void hunt_found(struct native *native, const uint8_t rom[8], unsigned n, int64_t now)
{
	if (!wake_bridge(native, n, rom))
		presence_found(native, rom, n, now);
}

struct known {
	const struct native *native;
	unsigned n;
	struct device *device; /* at which the pass was cut */
};

/* The only device of the channel that begins so; NULL: none or several. */
static struct device *only_device(const struct native *native, unsigned n, const uint8_t prefix[8],
                                  unsigned bits)
{
	struct device *only = NULL;

	for (struct device *device = NULL; (device = native_device(native, n, device));) {
		if (!search_same(device->rom, prefix, bits))
			continue;
		if (only)
			return NULL;
		only = device;
	}
	return only;
}

static bool is_known(void *ctx, const uint8_t prefix[8], unsigned bits, uint8_t rom[8])
{
	struct known *known = ctx;
	const struct native *native = known->native;
	unsigned branch = native->channel[known->n].search.branch;

	/* A pass that went to the end may have found a branch behind many bits. */
	if (bits < APART + (branch > FAMILY_BITS ? branch : FAMILY_BITS))
		return false;
	struct device *only = only_device(native, known->n, prefix, bits - APART);
	/* An astray device has to answer; a restarted bridge has some bits of its id alone. */
	if (!only || only->astray || only->rom[0] == DS28E18_CODE ||
	    !search_same(only->rom, prefix, bits) || locate_wants(native, prefix, bits))
		return false;
	memcpy(rom, only->rom, sizeof(only->rom));
	only->cut = (uint8_t)bits;
	only->seen = native->channel[known->n].round;
	known->device = only;
	return true;
}

static void whole_pass(struct native *native, unsigned n, int64_t now)
{
	const uint8_t *rom = native->channel[n].search.rom;
	struct device *device;

	hunt_found(native, rom, n, now);
	device = device_find(&native->table, rom);
	if (device)
		device->cut = 0;
}

static void hunt_pass(struct native *native, unsigned n, int64_t now)
{
	struct channel *channel = &native->channel[n];
	struct known known = {.native = native, .n = n};

	if (!channel->searching) {
		search_begin(&channel->search, false, 0);
		channel->searching = true;
		channel->dirty = false;
		channel->passes = ++channel->round;
		channel->round_ns = now;
	}
	channel->search.lone = channel->cuts && ++channel->passes % WHOLE_EVERY ? is_known : NULL;
	channel->search.ctx = &known;
	int found = next_device(native, n, &channel->search, NULL);
	now = native_now(native);
	if (found >= 0 || found == -EBADMSG) {
		master_good(native, n);
		told_short(native, n, false);
	}
	if (found == -EBADMSG && !only_whole(channel->link) && ++channel->spoiled < TRIES_PASS) {
		native_count(native, COUNT_CHECKSUMS);
		channel->search_ns = now;
		channel->dirty = true; /* other bits may have been wrong, and hidden a branch */
		return;
	}
	channel->spoiled = 0;
	if (found > 0) {
		if (!known.device)
			whole_pass(native, n, now);
		channel->search_ns = now;
		if (channel->search.last)
			end_round(native, n, true, now);
		return;
	}
	channel->dirty |= found < 0;
	if (found == -EBADMSG)
		native_count(native, COUNT_CHECKSUMS);
	if (found == -ECOMM) {
		native_count(native, COUNT_SHORTS);
		channel->shorts++;
		told_short(native, n, true);
	} else if (found < 0 && found != -EBADMSG && !master_recover(native, n, found)) {
		return;
	}
	end_round(native, n, found == 0, now);
}

static void timed_pass(struct native *native, unsigned n, int64_t now)
{
	int64_t pause;

	native->hunter = n + 1;
	hunt_pass(native, n, now);
	native->pass_ns = earlier_ns(native_now(native) - now, PASS_MOST_NS);
	pause = native->pass_ns * (PASS_SHARE - 1);
	int64_t least = native->touch ? PASS_TOUCH_NS : PASS_NS;
	native->hunt_ns = native_now(native) + (pause > least ? pause : least);
}

/*
 * How long a pass waits where there always is something else to do. To switch a branch on makes the
 * event of a key on another one void: that is not done more often because passes are cut.
 */
static int64_t overdue(const struct native *native, unsigned n)
{
	int64_t share = native->pass_ns * OVERDUE_SHARE;

	if (native->touch || n >= NATIVE_CHANNELS || share > OVERDUE_NS)
		return OVERDUE_NS;
	return share > OVERDUE_MIN_NS ? share : OVERDUE_MIN_NS;
}

bool hunt_step(struct native *native, int64_t now, bool idle, int64_t *next)
{
	bool fits = idle && *next - now > native->pass_ns;
	int64_t first = INT64_MAX;

	for (unsigned i = 0; i < NATIVE_ALL; i++) {
		unsigned n = (native->hunter + i) % NATIVE_ALL;
		struct channel *channel = &native->channel[n];

		if (!native_has(native, n))
			continue;
		int64_t least = native->hunt_ns + (fits ? 0 : overdue(native, n));
		int64_t when = channel->search_ns > least ? channel->search_ns : least;

		if (!channel->listed)
			when = 0;
		if (native_held(native, n, NULL, now))
			when = native->hold_ns[channel->link->chip % NATIVE_CHANNELS];
		if (when <= now) {
			timed_pass(native, n, now);
			return true;
		}
		first = when < first ? when : first;
	}
	*next = earlier_ns(first, *next);
	return false;
}

/*
 * The rest of its id is not read, so it may be one that is not known yet: which its latch tells. A
 * thermometer has none: to be found is its alarm, and its id is read whole, with the checksum.
 */
static bool is_latched(void *ctx, const uint8_t prefix[8], unsigned bits, uint8_t rom[8])
{
	const struct known *known = ctx;
	const struct device *only = bits < FAMILY_BITS
	                                    ? NULL
	                                    : only_device(known->native, known->n, prefix, bits);

	if (!only || !only->family->latches)
		return false;
	memcpy(rom, only->rom, sizeof(only->rom));
	return true;
}

/* On to the next family, the next channel, the end. */
static void scan_on(struct native *native, struct job *job)
{
	job->searching = false;
	job->tries = 0;
	if (job->families[0] && ++job->family_i < sizeof(job->families) &&
	    job->families[job->family_i])
		return;
	job->family_i = 0;
	job->channel = (uint8_t)native_next(native, job->channel + 1u);
	if (job->bus < 0 && job->channel < (job->kind == JOB_SCAN ? native->channels : NATIVE_ALL))
		return;
	if (!job->heard) {
		job_answer(native, job, -ECOMM);
		return;
	}
	/* One that is not known would have been taken for a known one, and go on being found. */
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1))
		if (job->kind == JOB_ALARM && !job->out)
			native->channel[n].alarm_searches = 0;
	native_count(native, COUNT_DIRECTORIES);
	job_answer(native, job, job->kind == JOB_SCAN ? listing_add_rest(native, job) : 0);
}

void hunt_scan(struct native *native, struct job *job, int64_t now)
{
	struct channel *channel = &native->channel[job->channel];
	struct known ctx = {.native = native, .n = job->channel};

	/* Its chip has gone meanwhile. */
	if (!native_has(native, job->channel)) {
		if (job->searching)
			job->out = job->mark;
		scan_on(native, job);
		return;
	}
	if (!job->searching) {
		search_begin(&job->search, job->kind == JOB_ALARM, job->families[job->family_i]);
		job->searching = true;
		job->mark = job->out;
		if (job->kind == JOB_ALARM && !job->req->whole &&
		    ++channel->alarm_searches % FULL_EVERY)
			job->search.lone = is_latched;
	}
	job->search.ctx = &ctx;
	int found = next_device(native, job->channel, &job->search, job);
	job->txn.channel = job->channel;
	if (found >= 0) {
		job->heard = true;
		master_good(native, job->channel);
	}
	if (found == -EBADMSG && !only_whole(channel->link) && ++job->tries < TRIES_PASS) {
		native_count(native, COUNT_CHECKSUMS);
		return;
	}
	if (found > 0) {
		job->tries = 0;
		presence_found(native, job->search.rom, job->channel, now);
		struct device *device = device_find(&native->table, job->search.rom);
		int err = device ? listing_add_device(native, job, device) : 0;
		if (err)
			job_answer(native, job, err);
		else if (job->search.last)
			scan_on(native, job);
		return;
	}
	if (found == 0) {
		scan_on(native, job);
		return;
	}
	job->out = job->mark;
	job->searching = false;
	if (found == -ECOMM && job->bus < 0) {
		native_count(native, COUNT_SHORTS);
		scan_on(native, job);
	} else if (found == -EBADMSG) {
		native_count(native, COUNT_CHECKSUMS);
		if (++job->tries >= TRIES)
			job_answer(native, job, found);
	} else if (found == -EMSGSIZE || found == -EOPNOTSUPP) {
		job_answer(native, job, found);
	} else {
		job->txn.link_error = found;
		job_failed(native, job, found);
	}
}
