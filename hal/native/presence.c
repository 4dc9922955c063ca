/* SPDX-License-Identifier: MIT */
/* Devices found, seen, lost and restarted. */
#include <errno.h>
#include <stdio.h>

#include "hal/native/branches.h"
#include "hal/native/first_asked.h"
#include "hal/native/presence.h"
#include "hal/native/sensors.h"

/* More than the time between two searches of idle wires. A plug is seldom moved so often. */
#define RETURN_NS (60 * NS_PER_S)
/* Busy wires are searched less often: but a plug is not moved while its device answers. */
#define ANSWERED_NS (5 * NS_PER_S)
#define RETURNS 3

void presence_seen(struct device *device, int64_t now)
{
	device->ok_ns = now;
	device->missed = 0;
	device->astray = device->likely = false;
}

/* A device that is found here and there in turn, round after round, is two with one id. */
static void look_for_twin(struct native *native, struct device *device, unsigned n, int64_t now)
{
	char id[ROM_TEXT_MAX], here[40], there[40], text[BUS_EVENT_TEXT];
	bool back = device->before == n && device->moved_ns &&
	            (now - device->moved_ns < RETURN_NS || now - device->ok_ns < ANSWERED_NS);

	device->returns = (uint8_t)(!back ? 0 : device->returns + (device->returns < RETURNS + 1));
	device->before = device->channel;
	device->moved_ns = now;
	if (device->returns != RETURNS)
		return;
	rom_print(device->rom, ROM_F_I, id);
	branches_name(native, n, here, sizeof(here));
	branches_name(native, device->channel, there, sizeof(there));
	snprintf(
		text, sizeof(text),
		"%s answers on %s and on %s: of two chips with one id only one is served at a time",
		id, here, there);
	native_event(native, BUS_NOTE, device->rom, 0, text);
}

/* Requests that wait have the place of their device, and not its id. */
static void note_named(struct native *native)
{
	for (unsigned i = 0; i < native->table.count; i++)
		native->table.devices[i].named = false;
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (job->txn.device)
			job->txn.device->named = true;
}

void presence_found(struct native *native, const uint8_t rom[8], unsigned n, int64_t now)
{
	struct device *device = device_find(&native->table, rom);
	bool known = device && device->present && device->channel == n;

	if (device && device->present && device->channel != n)
		look_for_twin(native, device, n, now);
	if (!known) {
		note_named(native);
		device = device_add(&native->table, rom, sensors_family(&native->sensors, rom), n);
		if (!device) {
			native_event(native, BUS_NOTE, NULL, -ENOSPC,
			             "more devices than the table holds: one is left out");
			return;
		}
		family_forget(device);
		device->present = true;
		device->settled = false;
		device->failures = 0;
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
	device->moved_ns = 0;
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
