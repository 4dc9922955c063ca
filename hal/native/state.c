/* SPDX-License-Identifier: MIT */
/* The state of a native bus: the time, what it reports and counts, whether a channel is held. */
#include <stdio.h>
#include <string.h>

#include "hal/native/state.h"

int64_t native_now(const struct native *native)
{
	return bus_now(native->bus.env);
}

void native_count(struct native *native, enum native_count what)
{
	__atomic_store_n(&native->count[what], native->count[what] + 1, __ATOMIC_RELAXED);
}

void native_event(struct native *native, enum bus_news news, const uint8_t rom[8], int err,
                  const char *text)
{
	struct bus_event event = {.news = (uint8_t)news, .err = err};

	if (rom)
		memcpy(event.rom, rom, sizeof(event.rom));
	snprintf(event.text, sizeof(event.text), "%s", text);
	native->bus.env->event(native->bus.env->ctx, &event);
}

bool native_has(const struct native *native, unsigned channel)
{
	if (channel < NATIVE_CHANNELS)
		return channel < native->channels;
	return channel < NATIVE_ALL && native->channel[channel].link &&
	       !native->channel[channel].gone;
}

void native_open_channel(struct native *native, unsigned channel, struct link *link, unsigned wire)
{
	const struct channel old = native->channel[channel];

	native->channel[channel] = (struct channel){.link = link,
	                                            .trunk = old.trunk,
	                                            .wire = (uint8_t)wire,
	                                            .round = old.round,
	                                            .errors = old.errors,
	                                            .shorts = old.shorts,
	                                            .checksums = old.checksums,
	                                            .transactions = old.transactions};
}

unsigned native_next(const struct native *native, unsigned n)
{
	if (n >= native->channels && n < NATIVE_CHANNELS)
		n = NATIVE_CHANNELS;
	while (n < NATIVE_ALL && !native_has(native, n))
		n++;
	return n;
}

bool native_initial(const struct native *native)
{
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1))
		if (!native->channel[n].listed)
			return true;
	return false;
}

bool native_at_work(const struct native *native, unsigned channel)
{
	for (unsigned i = 0; i < native->table.count; i++)
		if (native->table.devices[i].channel == channel && native->table.devices[i].locked)
			return true;
	return false;
}

int64_t native_held(const struct native *native, unsigned channel, const struct job *job,
                    int64_t now)
{
	unsigned chip = native->channel[channel].link->chip % NATIVE_CHANNELS;
	bool held = native->hold_ns[chip] > now && (!job || native->holder[chip] != job);

	return held ? native->hold_ns[chip] : 0;
}

void native_hold(struct native *native, unsigned channel, struct job *job, int64_t until_ns)
{
	unsigned chip = native->channel[channel].link->chip % NATIVE_CHANNELS;

	native->hold_ns[chip] = until_ns;
	native->holder[chip] = job;
}

struct job *native_job(const struct native *native, const struct job *after)
{
	for (unsigned i = after ? (unsigned)(after - native->jobs) + 1 : 0; i < NATIVE_DEPTH; i++)
		if (native->jobs[i].req)
			return &native->jobs[i];
	return NULL;
}

struct device *native_device(const struct native *native, unsigned channel,
                             const struct device *after)
{
	struct device *device = native->table.devices, *end = device + native->table.count;

	for (device = after ? device + (after - device) + 1 : device; device < end; device++)
		if (device->present && device->channel == channel)
			return device;
	return NULL;
}

struct device *native_thermometer(const struct native *native, unsigned channel,
                                  const struct device *after)
{
	struct device *device = native_device(native, channel, after);

	while (device && !device->family->thermometer)
		device = native_device(native, channel, device);
	return device;
}

struct link *native_abreast(const struct native *native, unsigned channel)
{
	struct link *link = channel < native->channels ? native->channel[channel].link : NULL;

	return link && link->ops->together && !native->channel[channel].trunk ? link : NULL;
}
