/* SPDX-License-Identifier: MIT */
/* What the first conversions are to devices that are found later. */
#include "hal/native/first_wire.h"
#include "hal/chips/thermometers/thermometer_proof.h"

void first_found(struct native *native, struct device *device)
{
	const struct channel *channel = &native->channel[device->channel];

	if (channel->listed || !channel->first.ready_ns || !device->family->thermometer)
		return;
	device->power = POWER_EXTERNAL;
	thermometer_converts(device, channel->first.ready_ns - FIRST_LONGEST_NS, FIRST_LONGEST_NS,
	                     false);
}

bool first_took_part(const struct native *native, const struct device *device)
{
	const struct first *first = &native->channel[device->channel].first;

	return device->present && first->ready_ns &&
	       thermometer_last(device).ends_ns == first->ready_ns;
}

void first_void(struct native *native)
{
	for (unsigned n = 0; n < NATIVE_ALL; n++)
		native->channel[n].first.ready_ns = 0;
}
