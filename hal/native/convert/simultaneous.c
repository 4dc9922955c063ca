/* SPDX-License-Identifier: MIT */
/* Writes to /simultaneous: all chips of a kind on one channel or on all convert. */
#include <errno.h>

#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/simultaneous.h"
#include "hal/native/convert/supply.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"

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
