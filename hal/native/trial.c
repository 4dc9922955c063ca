/* SPDX-License-Identifier: MIT */
/* The trial of one thermometer after the other: what its scratchpad shows while it converts. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/thermometer.h"
#include "hal/chips/thermometer_proof.h"
#include "hal/native/master.h"
#include "hal/native/presence.h"
#include "hal/native/trial.h"

#define POINTS 8
#define MEASURES 2 /* parts that find the shortest time */
#define PARTS (MEASURES + 4)
#define LONGEST_NS (750 * TXN_MS)
#define LEAST_NS (150 * TXN_MS) /* with a shorter time nothing is gained */
#define READ_NS (15 * TXN_MS)
#define PAUSE_NS (200 * TXN_MS)
#define LATER_NS (60 * NATIVE_S) /* after parts that showed nothing */
#define PART_NS (5 * NATIVE_S)   /* no part takes longer */
#define ASKED_NS (60 * NATIVE_S) /* what was not read for so long is not asked for */
#define INCONCLUSIVE 6
#define US INT64_C(1000)

#define TRIES 3 /* of a write that is read back */
#define RESTORES 8

enum { SUPPLY, BEGIN, NINE, CONVERT_9, READ_9, TWELVE, HELD, CONVERT_12, LOOK, READ_12, RESTORE };

bool trial_fits(const struct native *native, unsigned n)
{
	const struct link *link = native->channel[n].link;

	return native->double_buffer && n < native->channels && !native->channel[n].trunk &&
	       !link->driven && !link->passive && !link->ops->flush;
}

bool trial_alone(const struct native *native, unsigned n)
{
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (device->channel != n && native_thermometer(device, device->channel))
			return false;
	}
	return true;
}

static bool is_busy(const struct native *native, const struct device *device, int64_t now)
{
	if (device->locked || thermometer_of(device)->converted_ns > now ||
	    thermometer_of(device)->busy_ns > now)
		return true;
	for (unsigned i = 0; i < NATIVE_DEPTH; i++) {
		const struct job *job = &native->jobs[i];

		if (job->req && job->txn.device == device &&
		    (job->state == JOB_CONVERTING || job->state == JOB_RUN ||
		     job->state == JOB_PREPARE))
			return true;
	}
	return false;
}

/* Of the families whose data sheet is that of the DS18B20. */
static bool is_candidate(const struct native *native, const struct device *device, int64_t now)
{
	if (!device->present || !native_thermometer(device, device->channel) ||
	    (device->rom[0] != 0x28 && device->rom[0] != 0x22) ||
	    !trial_fits(native, device->channel))
		return false;
	const struct thermometer *chip = thermometer_of(device);

	return chip->ahead == AHEAD_UNTRIED && chip->make == MAKE_GENUINE && chip->shows &&
	       !chip->unheard && !chip->ignores && !chip->slow && chip->resolution == 12 &&
	       device->power == POWER_EXTERNAL && chip->raw_ns && now - chip->raw_ns < ASKED_NS;
}

/* One with a pause after parts that showed nothing does not hold up the others. */
static bool is_paused(const struct thermometer *chip, int64_t now)
{
	return chip->inconclusive >= INCONCLUSIVE && now < chip->ended_ns;
}

bool trial_waits(const struct native *native, unsigned n, int64_t now)
{
	if (native->trial.device && native->trial.device->channel == n)
		return true;
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (device->channel == n && is_candidate(native, device, now) &&
		    !is_paused(thermometer_of(device), now))
			return true;
	}
	return false;
}

void trial_doubt(struct native *native, struct device *device, const char *why)
{
	struct thermometer *chip = thermometer_of(device);
	char text[BUS_EVENT_TEXT];

	chip->ahead = AHEAD_REFUSED;
	chip->held_until_ns = 0;
	native_count(native, COUNT_DOUBTS);
	snprintf(text, sizeof(text), "DoubleBuffer: not of %02X.%02X%02X%02X%02X%02X%02X: %s",
	         device->rom[0], device->rom[1], device->rom[2], device->rom[3], device->rom[4],
	         device->rom[5], device->rom[6], why);
	native_event(native, BUS_NOTE, device->rom, 0, text);
}

static void release(struct native *native, int64_t pause)
{
	struct trial *trial = &native->trial;
	struct thermometer *chip = thermometer_of(trial->device);

	trial->device->locked = false;
	/* What it holds is of no request's conversion. */
	chip->converted_ns = 0;
	chip->strict = false;
	chip->tried = true;
	chip->held_until_ns = 0;
	trial->device->changes++;
	trial->device = NULL;
	trial->next_ns = native_now(native) + pause;
}

static void showed_nothing(struct native *native)
{
	struct thermometer *chip = thermometer_of(native->trial.device);

	if (++chip->inconclusive >= INCONCLUSIVE)
		chip->ended_ns = native_now(native) + LATER_NS;
	release(native, PAUSE_NS);
}

static void refuse(struct native *native, const char *why)
{
	trial_doubt(native, native->trial.device, why);
	release(native, PAUSE_NS);
}

/* After Convert T at 12 bits: where the points lie. */
static void place_points(struct trial *trial, const struct thermometer *chip)
{
	int64_t shortest = (int64_t)chip->shortest_us * US;

	trial->until_ns = shortest / 5 * 4;
	trial->from_ns = trial->until_ns / POINTS;
	if (chip->trials == 0) {
		trial->from_ns = LONGEST_NS / (POINTS + 1);
		trial->until_ns = trial->from_ns * POINTS;
	} else if (chip->trials < MEASURES) {
		trial->from_ns = shortest;
		trial->until_ns = shortest + LONGEST_NS / (POINTS + 1);
	}
}

static int64_t point_ns(const struct trial *trial)
{
	int64_t span = trial->until_ns - trial->from_ns;

	return trial->started_ns + trial->from_ns + span * trial->point / (POINTS - 1);
}

static void passed(struct native *native, const uint8_t bytes[9])
{
	struct trial *trial = &native->trial;
	struct thermometer *chip = thermometer_of(trial->device);

	if (bytes[SP_REMAIN] != 16 - (bytes[SP_LSB] & 0xf)) {
		refuse(native, "byte 6 does not follow the temperature");
		return;
	}
	if (bytes[SP_LSB] == trial->held[SP_LSB] && bytes[SP_MSB] == trial->held[SP_MSB]) {
		showed_nothing(native);
		return;
	}
	bool measures = chip->trials < MEASURES;
	if (trial->late) {
		showed_nothing(native);
		return;
	}
	if (measures ? trial->changed > 1 && memcmp(trial->other, bytes, 8) != 0 : trial->changed) {
		refuse(native, "its scratchpad is disturbed while it converts");
		return;
	}
	if (chip->trials == 0 || (measures && trial->old))
		chip->shortest_us = (uint32_t)(trial->last_old_ns / US);
	if ((int64_t)chip->shortest_us * US < LEAST_NS) {
		refuse(native, "it converts too quickly");
		return;
	}
	if (!measures && trial->old < POINTS) {
		showed_nothing(native);
		return;
	}
	chip->inconclusive = 0;
	if (++chip->trials == PARTS)
		chip->ahead = AHEAD_TRUSTED;
	native_count(native, COUNT_TRIALS);
	release(native, PAUSE_NS);
}

/*
 * Once it shows something else it has to be the new result, and to stay; where the end is looked
 * for, the first look may have met it. A look so late that it might meet it shows nothing.
 */
static void look_at_point(struct trial *trial, const struct thermometer *chip,
                          const uint8_t bytes[9], int64_t began)
{
	bool old = memcmp(bytes, trial->held, 8) == 0, measures = chip->trials < MEASURES;
	int64_t after = began - trial->started_ns, shortest = (int64_t)chip->shortest_us * US;

	trial->late |= measures ? trial->point == 0 && chip->trials == 0 && after > LEAST_NS
	                        : after > shortest / 10 * 9;
	trial->point++;
	if (old && !trial->changed) {
		trial->old++;
		trial->last_old_ns = after;
		return;
	}
	if (trial->changed < (measures ? 2 : 1))
		memcpy(trial->other, bytes, 8);
	else if (memcmp(bytes, trial->other, 8) != 0)
		memset(trial->other, 0xff, 8); /* no result is all ones */
	trial->changed++;
}

/*
 * With the limits that were there at the beginning. A write that was lost looks like a chip that
 * has one resolution: that takes some.
 */
static int set_resolution(struct trial *trial, unsigned resolution)
{
	struct thermometer *chip = thermometer_of(trial->device);
	uint8_t want[9], bytes[9];

	memcpy(want, trial->begin, sizeof(want));
	want[SP_CONFIG] = (uint8_t)((want[SP_CONFIG] & ~0x60) | (resolution - 9) << 5);
	chip->resolution = 0;
	if (trial->txn.phase++ == 0) {
		int err = thermometer_write_settings(&trial->txn, want);
		return err ? err : TXN_MORE;
	}
	int err = thermometer_scratchpad(&trial->txn, bytes);
	if (err || memcmp(bytes + SP_HIGH, want + SP_HIGH, 3) == 0)
		return err;
	if (++trial->misses >= TRIES)
		return trial->step == RESTORE ? -EBADMSG : -ENOTTY;
	trial->txn.phase = 0;
	return TXN_MORE;
}

static int start(struct trial *trial)
{
	int err = thermometer_start(&trial->txn);

	thermometer_told(trial->device, txn_now(&trial->txn),
	                 thermometer_convert_ns(trial->device));
	return err;
}

/* A transaction of the present step. 0: the next step; TXN_MORE: again; or an error. */
static int run_step(struct native *native, int64_t now)
{
	struct trial *trial = &native->trial;
	struct txn *txn = &trial->txn;
	const struct device *device = trial->device;
	uint8_t bytes[9];
	int err;

	switch (trial->step) {
	case SUPPLY:
		err = thermometer_ask_power(txn);
		return err < 0 ? err : err ? 0 : -ENOTSUP;
	case BEGIN:
		err = thermometer_scratchpad(txn, trial->begin);
		return err || thermometer_of(device)->resolution == 12 ? err : -EBADMSG;
	case NINE:
		return set_resolution(trial, 9);
	case CONVERT_9:
		err = start(trial);
		trial->next_ns = native_now(native) + thermometer_convert_ns(device);
		return err;
	case READ_9:
		return thermometer_scratchpad(txn, bytes);
	case TWELVE:
		return set_resolution(trial, 12);
	case HELD:
		err = thermometer_scratchpad(txn, bytes);
		memcpy(trial->held, bytes, 8);
		return err;
	case CONVERT_12:
		err = start(trial);
		trial->started_ns = native_now(native);
		place_points(trial, thermometer_of(device));
		trial->next_ns = point_ns(trial);
		return err;
	case LOOK:
		err = thermometer_scratchpad(txn, bytes);
		if (!err)
			look_at_point(trial, thermometer_of(device), bytes, now);
		trial->next_ns = point_ns(trial);
		if (trial->point == POINTS)
			trial->next_ns = trial->started_ns + LONGEST_NS + READ_NS;
		return err ? err : trial->point < POINTS ? TXN_MORE : 0;
	case RESTORE:
		return set_resolution(trial, 12);
	default:
		err = thermometer_scratchpad(txn, bytes);
		if (!err)
			passed(native, bytes);
		return err;
	}
}

static void go_to(struct trial *trial, unsigned step)
{
	trial->step = (uint8_t)step;
	trial->tries = trial->misses = 0;
	trial->txn.phase = 0;
	memset(trial->txn.own, 0, sizeof(trial->txn.own));
}

/* The step failed. A chip that may have another resolution now gets its own back. */
static void fail(struct native *native, int err)
{
	struct trial *trial = &native->trial;

	if (trial->step == RESTORE && ++trial->tries < RESTORES) {
		trial->txn.phase = trial->misses = 0;
		trial->next_ns = native_now(native) + PAUSE_NS;
		return;
	}
	trial->refused = err == -ENOTSUP  ? "it has no supply of its own"
	                 : err == -ENOTTY ? "it has one resolution"
	                                  : trial->refused;
	if (trial->step >= NINE && trial->step <= TWELVE)
		go_to(trial, RESTORE);
	else if (trial->refused)
		refuse(native, trial->refused);
	else
		showed_nothing(native);
}

static void do_transaction(struct native *native, int64_t now)
{
	struct trial *trial = &native->trial;
	struct txn *txn = &trial->txn;
	struct device *device = trial->device;
	unsigned n = device->channel;
	int err = txn_end(txn, run_step(native, now));
	int link_error = txn->link_error;
	bool restarted = txn->restarted;

	native_count(native, COUNT_TRANSACTIONS);
	txn->link_error = 0;
	if (!link_error)
		master_good(native, n);
	if (!trial->device) {
		/* The part has ended. */
	} else if (restarted) {
		release(native, PAUSE_NS);
		presence_restarted(native, device);
	} else if (err == TXN_MORE && txn->wake_ns > native_now(native)) {
		trial->next_ns = txn->wake_ns;
	} else if (err < 0) {
		fail(native, err);
	} else if (err == 0 && trial->step == RESTORE) {
		trial->refused ? refuse(native, trial->refused) : showed_nothing(native);
	} else if (err == 0) {
		go_to(trial, trial->step + 1u);
	}
	if (link_error && link_error != -ECOMM)
		master_recover(native, n, link_error);
}

static void begin_part(struct native *native, struct device *device, int64_t now)
{
	unsigned n = device->channel;

	native->trial = (struct trial){.device = device,
	                               .begun_ns = now,
	                               .conversion = thermometer_of(device)->conversion,
	                               .cursor = native->trial.cursor,
	                               .txn = {.native = native,
	                                       .link = native->channel[n].link,
	                                       .channel = n,
	                                       .device = device,
	                                       .since_ns = INT64_MAX,
	                                       .oldest_ns = INT64_MAX}};
	device->locked = true;
}

/* True: none can be begun, not even when what goes on with it is over. */
static bool begin_next(struct native *native, int64_t now)
{
	bool none = true;

	for (unsigned i = 0; i < native->table.count; i++) {
		unsigned at = (native->trial.cursor + i) % native->table.count;
		struct device *device = &native->table.devices[at];

		if (!is_candidate(native, device, now) || is_paused(thermometer_of(device), now) ||
		    !trial_alone(native, device->channel))
			continue;
		none = false;
		if (is_busy(native, device, now) || native_held(native, device->channel, NULL, now))
			continue;
		native->trial.cursor = at + 1;
		begin_part(native, device, now);
		return false;
	}
	return none;
}

/* The wire was away, others had all the time, or a Convert T for all went out. */
static bool is_spoilt(const struct native *native, int64_t now)
{
	const struct trial *trial = &native->trial;

	return !trial->device->present || native->up_ns > trial->begun_ns ||
	       now - trial->begun_ns > PART_NS ||
	       thermometer_of(trial->device)->conversion != trial->conversion;
}

bool trial_step(struct native *native, int64_t now, int64_t *next)
{
	struct trial *trial = &native->trial;

	if (!native->double_buffer)
		return false;
	if (trial->device && is_spoilt(native, now)) {
		showed_nothing(native);
		return false;
	}
	if (now >= trial->next_ns && !trial->device && begin_next(native, now))
		trial->next_ns = now + PAUSE_NS;
	if (trial->device && now >= trial->next_ns &&
	    !native_held(native, trial->device->channel, NULL, now)) {
		do_transaction(native, now);
		return true;
	}
	*next = trial->next_ns > now && trial->next_ns < *next ? trial->next_ns : *next;
	return false;
}
