/* SPDX-License-Identifier: MIT */
/* Writes to /simultaneous: all chips of a kind on one channel or on all convert. */
#include <errno.h>

#include "hal/chips/switches/ds2450.h"
#include "hal/native/answer.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/convert/simultaneous.h"
#include "hal/native/convert/supply.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"

#define SKIP_ROM 0xcc

/* The first DS2450 of a channel, or the next one. */
static struct device *next_ds2450(const struct native *native, unsigned n,
                                  const struct device *after)
{
	struct device *device = native_device(native, n, after);

	while (device && device->family != &family_20)
		device = native_device(native, n, device);
	return device;
}

/* All DS2450 of a channel at once. Their checksum is one: they were told the same. */
static int convert_voltage(struct native *native, unsigned n)
{
	static const uint8_t skip = SKIP_ROM;
	const struct conversion *conversion = &ds2450_conversion;
	struct channel *channel = &native->channel[n];
	struct txn txn = {.native = native, .link = channel->link, .channel = n};
	uint8_t none;
	int64_t begun = native_now(native);
	int err = txn_raw(&txn, &skip, 1);

	if (!err)
		err = txn_write(&txn, conversion->command, conversion->n);
	if (!err)
		err = txn_read_crc16(&txn, conversion->command, conversion->n, &none, 0);
	/* One more slot arms the pull-up, for those without a supply. */
	if (!err)
		err = channel->link->ops->bit(link_wire(channel->link), true, LINK_STRONG);
	native_count(native, COUNT_TRANSACTIONS);
	if (err < 0)
		return txn.link_error ? txn.link_error : err;
	master_good(native, n);
	for (struct device *device = NULL; (device = next_ds2450(native, n, device));)
		ds2450_of(device)->measured_ns = begun;
	channel->simultaneous_ns[SIMULTANEOUS_VOLTAGE] = native_now(native) + conversion->ns;
	native_hold(native, n, NULL, channel->simultaneous_ns[SIMULTANEOUS_VOLTAGE]);
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

/* What was read before is not of this conversion. */
static void forget_kept(struct native *native, unsigned n, bool temperature)
{
	for (struct device *device = NULL;
	     (device = temperature ? native_thermometer(native, n, device)
	                           : next_ds2450(native, n, device));)
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
	if (!err)
		err = temperature                    ? convert_temperature(native, n)
		      : next_ds2450(native, n, NULL) ? convert_voltage(native, n)
		                                     : 0;
	forget_kept(native, n, temperature);
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
