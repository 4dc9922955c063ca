/* SPDX-License-Identifier: MIT */
/* Convert T for all thermometers of a channel, and what is known of those that were told. */
#include <errno.h>

#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/ending.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/convert/supply.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"
#include "hal/wire/driver.h"

#define SKIP_ROM 0xcc
#define TRIES 3

/*
 * Chips with a supply hold the line low while they convert: if none does, none heard. One that
 * alone did not hear is hidden by the others; the rounds one by one find it. Under the strong
 * pull-up no chip can show it: thermometer_proof.c looks at what each chip latched.
 */
static int send_convert_all(struct native *native, unsigned n, bool strong)
{
	struct txn txn = {.native = native, .link = native->channel[n].link, .channel = n};

	if (txn.link->driver)
		return txn.link->driver->convert(txn.link, NULL, "temperature");
	int err = txn_raw_then(&txn, TXN_BYTES(SKIP_ROM, THERMOMETER_CONVERT),
	                       strong ? LINK_STRONG : LINK_IDLE);

	if (!err && !strong)
		err = txn_started(&txn);
	return txn_end(&txn, err);
}

/* How long after the command: a driver waits for the end itself. */
static int64_t convert_ns(const struct link *link, const struct device *device)
{
	return link->driver ? 0 : thermometer_convert_ns(device);
}

/* A chip that did not show that it heard may have heard. */
void broadcast_told(const struct native *native, struct device *device, int64_t now)
{
	thermometer_told(device, now, convert_ns(native->channel[device->channel].link, device));
}

static void told_all(struct native *native, unsigned n)
{
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));)
		broadcast_told(native, device, native_now(native));
}

/* Jobs that waited for a conversion that this one cut off wait for this one. NULL: of all. */
static void wait_for_end(struct native *native, unsigned n, const struct device *device)
{
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if ((job->state != JOB_DUE && job->state != JOB_CONVERTING) ||
		    (device ? job->txn.device != device : job->txn.channel != n))
			continue;
		job->state = JOB_CONVERTING;
		job->ready_ns = thermometer_last(job->txn.device).ends_ns;
	}
}

void broadcast_started(struct native *native, struct device *device, int64_t now, bool shown)
{
	const struct link *link = native->channel[device->channel].link;

	if (shown)
		thermometer_showed(device, false);
	thermometer_converts(device, now, convert_ns(link, device), !shown);
	wait_for_end(native, device->channel, device);
}

static void all_convert(struct native *native, unsigned n, bool unseen, int64_t now,
                        int64_t longest)
{
	struct channel *channel = &native->channel[n];
	struct device *only = NULL;
	unsigned count = 0;

	channel->due_ns = 0;
	channel->simultaneous_ns[SIMULTANEOUS_TEMPERATURE] = now + longest;
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));) {
		only = count++ ? NULL : device;
		thermometer_converts(device, now, convert_ns(channel->link, device), unseen);
	}
	if (only && !unseen)
		thermometer_showed(only, true);
	wait_for_end(native, n, NULL);
}

int broadcast_convert(struct native *native, unsigned n, bool strong, int64_t longest)
{
	struct link *link = native->channel[n].link;
	int err = -EBADMSG;

	for (int try = 0; try < TRIES && err == -EBADMSG; try++) {
		err = send_convert_all(native, n, strong);
		native_count(native, COUNT_TRANSACTIONS);
		if (err == -EBADMSG)
			native_count(native, COUNT_CHECKSUMS);
		if (err < 0)
			told_all(native, n);
	}
	if (err < 0)
		return err;
	int64_t now = native_now(native);
	master_good(native, n);
	native_count(native, COUNT_CONVERSIONS);
	if (link->driver)
		longest = 0;
	if (strong && longest) {
		native_hold(native, n, NULL, now + longest);
		schedule_owe(&native->schedule, OWES_OTHER);
	}
	all_convert(native, n, strong && !link->driver, now, longest);
	if (!strong && !link->driver)
		ending_begin(native, n, longest);
	return 0;
}

/*
 * A chip whose supply is not known would get the strong pull-up, and could not show that it
 * converts. TXN_MORE: one of them, or all, were asked now.
 */
static int ask_supply(struct native *native, struct job *job)
{
	unsigned n = job->channel;
	struct device *device = NULL;

	while ((device = native_thermometer(native, n, device)))
		if (device->power == POWER_UNKNOWN)
			break;
	if (!device)
		return 0;
	if (!native->channel[n].power_asked)
		return supply_ask_all(native, job);
	return supply_ask_one(native, n) ? TXN_MORE : 0;
}

/* Without a thermometer on the channel no chip shows that it converts. */
static int convert_temperature(struct native *native, unsigned n)
{
	bool parasitic = false, any = false;

	for (struct device *device = NULL; (device = native_thermometer(native, n, device));) {
		any = true;
		parasitic |= device->power != POWER_EXTERNAL;
	}
	if (any)
		return broadcast_convert(native, n, parasitic, 750 * TXN_MS);
	native->channel[n].simultaneous_ns[SIMULTANEOUS_TEMPERATURE] = native_now(native) +
	                                                               750 * TXN_MS;
	return 0;
}

/* What was read before is not of this conversion. A DS2450 converts when it is read next. */
static void forget_kept(struct native *native, unsigned n)
{
	for (struct device *device = NULL; (device = native_device(native, n, device));)
		device->changes++;
}

void convert_all(struct native *native, struct job *job)
{
	bool temperature = job->property->arg == SIMULTANEOUS_TEMPERATURE;
	unsigned n = job->channel;

	job->txn.channel = n;
	int err = temperature ? ask_supply(native, job) : 0;

	if (err == TXN_MORE)
		return;
	if (!temperature)
		native->channel[n].simultaneous_ns[SIMULTANEOUS_VOLTAGE] = native_now(native);
	else if (!err)
		err = convert_temperature(native, n);
	forget_kept(native, n);
	if (err < 0 && err != -ENODEV) {
		job->txn.link_error = err == -EBADMSG || err == -EOPNOTSUPP ? 0 : err;
		job_failed(native, job, err);
		return;
	}
	job->channel = (uint8_t)native_next(native, job->channel + 1u);
	if (job->bus < 0 && job->channel < NATIVE_ALL)
		return;
	job->taken = job->req->len;
	job_answer(native, job, 0);
}
