/* SPDX-License-Identifier: MIT */
/* The state of a native bus: the time, what it reports and counts, its cost, held channels. */
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

	return link && link->ops->run_many && !native->channel[channel].trunk ? link : NULL;
}

/* What a wire has done since it was looked at last, ns of its slots. */
static uint64_t take_wire(struct native *native, unsigned wire)
{
	struct link_cost cost = link_cost_of(native->channel[wire].link);
	uint64_t grown;

	/* The master may open with fewer channels than before, or begin anew to count. */
	grown = cost.wire_ns -
	        (cost.wire_ns < native->wire_seen_ns[wire] ? 0 : native->wire_seen_ns[wire]);
	native->wire_ns += grown;
	native->wire_each_ns[wire] += grown;
	native->wire_seen_ns[wire] = cost.wire_ns;
	return grown;
}

void cost_of_job(struct native *native, struct job *job)
{
	job->wire_ns += take_wire(native, native->channel[job->txn.channel].wire);
}

static void count_wire(struct native *native, unsigned wire)
{
	const struct channel *channel = &native->channel[wire];
	uint64_t *counts = &native->count[COUNT_WIRE_0_US + 2 * wire];

	__atomic_store_n(&counts[0], native->wire_each_ns[wire] / 1000, __ATOMIC_RELAXED);
	__atomic_store_n(&counts[1], channel->errors + channel->shorts + channel->checksums,
	                 __ATOMIC_RELAXED);
}

void cost_take(struct native *native)
{
	struct link_master_cost shared = {0};

	for (unsigned i = 0; i < native->channels; i++) {
		take_wire(native, i);
		if (i < NATIVE_COUNTED)
			count_wire(native, i);
	}
	/* the most that there were: a chip that is away comes back */
	if (native->channels > native->count[COUNT_WIRES])
		__atomic_store_n(&native->count[COUNT_WIRES], native->channels, __ATOMIC_RELAXED);
	if (native->master->ops->cost)
		native->master->ops->cost(native->master, &shared);
	__atomic_store_n(&native->count[COUNT_WIRE_US], native->wire_ns / 1000, __ATOMIC_RELAXED);
	__atomic_store_n(&native->count[COUNT_I2C_TRANSFERS], shared.transfers, __ATOMIC_RELAXED);
	__atomic_store_n(&native->count[COUNT_SYSCALLS], shared.syscalls, __ATOMIC_RELAXED);
}
