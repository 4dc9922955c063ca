/* SPDX-License-Identifier: MIT */
/* Convert T for all thermometers of a channel, and what is known of those that were told. */
#include <errno.h>

#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/ending.h"
#include "hal/native/convert/schedule.h"
#include "hal/native/master.h"
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
