/* SPDX-License-Identifier: MIT */
/* Writes to /simultaneous: all chips of a kind on one channel or on all convert. */
#include <errno.h>

#include "hal/chips/switches/ds2450.h"
#include "hal/native/answer.h"
#include "hal/native/broadcast.h"
#include "hal/native/master.h"
#include "hal/native/outcome.h"
#include "hal/native/simultaneous.h"
#include "hal/native/state.h"

#define SKIP_ROM 0xcc

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
		err = channel->link->ops->bit(channel->link, true, LINK_STRONG);
	native_count(native, COUNT_TRANSACTIONS);
	if (err < 0)
		return txn.link_error ? txn.link_error : err;
	master_good(native, n);
	for (unsigned i = 0; i < native->table.count; i++) {
		struct device *device = &native->table.devices[i];

		if (device->present && device->channel == n && device->family == &family_20)
			ds2450_of(device)->measured_ns = begun;
	}
	int64_t end = native_now(native) + conversion->ns;
	channel->simultaneous_ns[SIMULTANEOUS_VOLTAGE] = end;
	native->hold_ns[channel->link->chip % NATIVE_CHANNELS] = end;
	native->holder[channel->link->chip % NATIVE_CHANNELS] = NULL;
	return 0;
}

/* Where there is no thermometer, nobody says that it converts. */
static int convert_temperature(struct native *native, unsigned n)
{
	bool parasitic = false, any = false;

	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (!device->present || device->channel != n || !device->family->thermometer)
			continue;
		any = true;
		parasitic |= device->power != POWER_EXTERNAL;
	}
	if (any)
		return broadcast_convert(native, n, parasitic, 750 * TXN_MS);
	native->channel[n].simultaneous_ns[SIMULTANEOUS_TEMPERATURE] = native_now(native) +
	                                                               750 * TXN_MS;
	return 0;
}

static bool has_family(const struct native *native, unsigned n, const struct family *family)
{
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (device->present && device->channel == n && device->family == family)
			return true;
	}
	return false;
}

/* What was read before is not of this conversion. */
static void forget_kept(struct native *native, unsigned n, bool temperature)
{
	for (unsigned i = 0; i < native->table.count; i++) {
		struct device *device = &native->table.devices[i];

		if (device->channel == n &&
		    (temperature ? device->family->thermometer : device->family == &family_20))
			device->changes++;
	}
}

void convert_all(struct native *native, struct job *job, int64_t now)
{
	unsigned n = job->channel;
	int err;

	(void)now;
	if (job->property->arg == SIMULTANEOUS_TEMPERATURE)
		err = convert_temperature(native, n);
	else
		err = has_family(native, n, &family_20) ? convert_voltage(native, n) : 0;
	job->txn.channel = n;
	forget_kept(native, n, job->property->arg == SIMULTANEOUS_TEMPERATURE);
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
