/* SPDX-License-Identifier: MIT */
/* Devices found, seen, lost and restarted. */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/native/branches.h"
#include "hal/native/first_wire.h"
#include "hal/native/presence.h"
#include "hal/native/sensors.h"
#include "hal/native/state.h"

void presence_seen(struct device *device, int64_t now)
{
	device->ok_ns = now;
	device->missed = 0;
}

void presence_found(struct native *native, const uint8_t rom[8], unsigned n, int64_t now)
{
	struct device *device = device_find(&native->table, rom);
	bool known = device && device->present && device->channel == n;

	if (!known) {
		device = device_add(&native->table, rom, sensors_family(&native->sensors, rom), n);
		if (!device) {
			native_event(native, BUS_NOTE, NULL, -ENOSPC,
			             "more devices than the table holds: one is left out");
			return;
		}
		family_forget(device);
		device->present = true;
		device->settled = false;
		native->channel[n].power_asked = false;
		native_count(native, COUNT_FOUND);
		native_event(native, BUS_FOUND, rom, 0, "");
		if (rom[0] == COUPLER_FAMILY)
			branches_found(native, device);
		first_found(native, device);
	}
	device->seen = native->channel[n].round;
	presence_seen(device, now);
}

void presence_lost(struct native *native, struct device *device)
{
	if (!device->present)
		return;
	device->present = false;
	family_forget(device);
	native_count(native, COUNT_LOST);
	native_event(native, BUS_LOST, device->rom, 0, "");
	if (device->rom[0] != COUPLER_FAMILY || !branches_lost(native, device))
		return;
	for (unsigned i = 0; i < native->table.count; i++)
		if (native->channel[native->table.devices[i].channel].gone)
			presence_lost(native, &native->table.devices[i]);
}

void presence_restarted(struct native *native, struct device *device)
{
	bool settled = device->settled;

	family_forget(device);
	device->settled = false;
	if (native_has(native, device->channel))
		native->channel[device->channel].power_asked = false;
	if (!settled)
		return;
	native_count(native, COUNT_RESTARTED);
	native_event(native, BUS_POR, device->rom, 0, "");
}
