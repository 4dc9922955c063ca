/* SPDX-License-Identifier: MIT */
/* Read Power Supply: of all thermometers of a channel at once, or of one. */
#include <errno.h>

#include "hal/chips/thermometers/thermometer.h"
#include "hal/native/convert/supply.h"
#include "hal/native/master.h"

#define SKIP_ROM 0xcc
#define LOOKS 3
#define TRIES 3

/* Read Power Supply of all at once: ones mean that no chip is parasitic, or that none heard. */
static int look_at_supply(struct native *native, unsigned n)
{
	struct txn txn = {.native = native, .link = native->channel[n].link, .channel = n};
	uint8_t slots;

	/* A driver sees to those that are fed by the wire. */
	if (txn.link->driver)
		return 1;
	int err = txn_raw(&txn, TXN_BYTES(SKIP_ROM, THERMOMETER_READ_POWER));

	if (!err)
		err = txn_read(&txn, &slots, 1);
	return err ? err : slots == 0xff;
}

int supply_look(struct native *native, unsigned n)
{
	int external = 1;

	for (int look = 0; look < LOOKS && external > 0; look++)
		external = look_at_supply(native, n);
	return external;
}

void supply_know(struct native *native, unsigned n, enum device_power power)
{
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));)
		device->power = power;
}

int supply_ask_all(struct native *native, struct job *job)
{
	struct channel *channel = &native->channel[job->txn.channel];

	job->txn.on_wire = true;
	int external = supply_look(native, job->txn.channel);
	if (external < 0) {
		job->txn.link_error = external == -ENODEV ? 0 : external;
		return external;
	}
	channel->power_asked = true;
	channel->all_external = external;
	if (external)
		supply_know(native, job->txn.channel, POWER_EXTERNAL);
	return TXN_MORE;
}

bool supply_ask_one(struct native *native, unsigned n)
{
	for (struct device *device = NULL; (device = native_thermometer(native, n, device));) {
		struct txn txn = {.native = native,
		                  .link = native->channel[n].link,
		                  .channel = n,
		                  .device = device};

		if (device->power != POWER_UNKNOWN)
			continue;
		int bit = -EBADMSG;
		for (int try = 0; try < TRIES && bit == -EBADMSG; try++) {
			bit = thermometer_ask_power(&txn);
			native_count(native, COUNT_TRANSACTIONS);
			if (bit == -EBADMSG)
				native_count(native, COUNT_CHECKSUMS);
		}
		if (bit < 0)
			device->power = POWER_ASSUMED;
		if (bit >= 0 || txn.link_error == 0)
			master_good(native, n);
		else if (txn.link_error != -ECOMM)
			master_recover(native, n, txn.link_error);
		return true;
	}
	return false;
}
