/* SPDX-License-Identifier: MIT */
/*
 * The branches of couplers as channels behind those of the master: found, lost, called by a path,
 * and switched off when no request uses them: a short of a branch then does not short the wire.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/native/branches.h"

static const char *const words[COUPLER_BRANCHES] = {
	[COUPLER_MAIN] = "main",
	[COUPLER_AUX] = "aux",
};

static unsigned channel_of(unsigned coupler, unsigned number)
{
	return NATIVE_CHANNELS + coupler * COUPLER_BRANCHES + number;
}

/* Of a channel that is no wire. */
static struct branch *branch_of(struct coupler *couplers, unsigned channel)
{
	unsigned n = channel - NATIVE_CHANNELS;

	return &couplers[n / COUPLER_BRANCHES].branch[n % COUPLER_BRANCHES];
}

/* What a device of that channel is behind; NULL: it is at a wire. */
static struct branch *parent_of(struct coupler *couplers, unsigned channel)
{
	return channel < NATIVE_CHANNELS ? NULL : branch_of(couplers, channel);
}

/* The slot of a coupler; NATIVE_COUPLERS: it has none. */
static unsigned coupler_slot(const struct native *native, const uint8_t rom[8])
{
	unsigned n = 0;

	while (n < NATIVE_COUPLERS && memcmp(native->coupler[n].rom, rom, 8) != 0)
		n++;
	return n;
}

/* The first slot that is free, or that belongs to a coupler that is gone. */
static unsigned free_slot(const struct native *native)
{
	unsigned n = 0;

	while (n < NATIVE_COUPLERS && native_has(native, channel_of(n, 0)))
		n++;
	return n;
}

/* What stands in front of the wire, from now on. NULL: it can have no branches. */
static struct trunk *trunk_of(struct native *native, unsigned wire)
{
	struct channel *channel = &native->channel[wire];

	for (unsigned i = 0; !channel->trunk && i < NATIVE_COUPLERS; i++) {
		struct trunk *trunk = &native->trunk[i];

		if (trunk->link.wire || !trunk_fits(channel->link))
			continue;
		trunk_set(trunk, channel->link);
		channel->trunk = trunk;
		channel->link = &trunk->link;
	}
	return channel->trunk;
}

void branches_found(struct native *native, struct device *device)
{
	unsigned n = coupler_slot(native, device->rom),
		 wire = native->channel[device->channel].wire;
	struct trunk *trunk = trunk_of(native, wire);
	struct coupler *coupler;
	bool running = true; /* the first list was made, so no client waits for it */

	for (unsigned i = native_next(native, 0); i < NATIVE_ALL; i = native_next(native, i + 1))
		running &= native->channel[i].listed;
	if (n == NATIVE_COUPLERS)
		n = free_slot(native);
	if (n == NATIVE_COUPLERS || !trunk) {
		native_event(native, BUS_NOTE, device->rom, trunk ? -ENOSPC : -EOPNOTSUPP,
		             trunk ? "more couplers than the bus takes: its branches are left out"
		                   : "this master cannot reach what is behind a coupler");
		return;
	}
	coupler = &native->coupler[n];
	if (coupler->trunk)
		coupler_remove(coupler);
	coupler_add(trunk, parent_of(native->coupler, device->channel), coupler, device->rom,
	            device->own);
	for (unsigned i = 0; i < COUPLER_BRANCHES; i++) {
		struct channel *channel = &native->channel[channel_of(n, i)];

		native_open_channel(native, channel_of(n, i), &coupler->branch[i].link, wire);
		channel->listed = running;
		channel->search_ns = native_now(native);
	}
}

bool branches_lost(struct native *native, const struct device *device)
{
	unsigned n = coupler_slot(native, device->rom);

	if (n == NATIVE_COUPLERS)
		return false;
	coupler_remove(&native->coupler[n]);
	for (unsigned i = 0; i < COUPLER_BRANCHES; i++)
		native->channel[channel_of(n, i)].gone = true;
	return true;
}

struct link *branches_wire(struct native *native, unsigned n, struct link *link)
{
	struct trunk *trunk = native->channel[n].trunk;

	if (!trunk)
		return link;
	trunk_set(trunk, link);
	return &trunk->link;
}

int branches_channel(const struct native *native, const struct device *coupler,
                     struct path_slice word)
{
	unsigned n = coupler_slot(native, coupler->rom);

	for (unsigned i = 0; n < NATIVE_COUPLERS && i < COUPLER_BRANCHES; i++)
		if (word.len == strlen(words[i]) && memcmp(word.text, words[i], word.len) == 0 &&
		    coupler->present && native_has(native, channel_of(n, i)))
			return (int)channel_of(n, i);
	return -ENODEV;
}

int branches_look(struct native *native, const uint8_t rom[8])
{
	unsigned n = coupler_slot(native, rom);

	return n < NATIVE_COUPLERS && native_has(native, channel_of(n, 0))
	               ? coupler_look(&native->coupler[n])
	               : 0;
}

bool branches_has_news(struct native *native, unsigned channel)
{
	return !branch_of(native->coupler, channel)->coupler->parent;
}

bool branches_news(struct native *native, unsigned channel)
{
	const struct branch *branch = branch_of(native->coupler, channel);

	return branch->coupler->seen->news >> branch->number & 1;
}

void branches_news_end(struct native *native, unsigned channel)
{
	struct branch *branch = branch_of(native->coupler, channel);

	branch->coupler->seen->news &= (uint8_t) ~(1u << branch->number);
}

bool branches_is_on(struct native *native, unsigned channel)
{
	const struct branch *branch = branch_of(native->coupler, channel);
	const struct branch *on = branch->coupler->trunk->on;

	while (on && on != branch)
		on = on->coupler->parent;
	return on;
}

int branches_print(struct native *native, unsigned channel, char *text, size_t room)
{
	const struct branch *branch = parent_of(native->coupler, channel);
	char part[ROM_TEXT_MAX + 8], name[ROM_TEXT_MAX];
	size_t len = 0;

	text[0] = '\0';
	for (; branch; branch = branch->coupler->parent) {
		rom_print(branch->coupler->rom, ROM_F_I, name);
		int n = snprintf(part, sizeof(part), "%s/%s/", name, words[branch->number]);

		if (len + (size_t)n >= room)
			return -EMSGSIZE;
		memmove(text + n, text, len + 1);
		memcpy(text, part, (size_t)n);
		len += (size_t)n;
	}
	return 0;
}

void branches_name(struct native *native, unsigned channel, char *text, size_t room)
{
	static const char cut[] = ".../";
	const size_t n = sizeof(cut) - 1;

	if (channel < NATIVE_CHANNELS) {
		snprintf(text, room, "bus.%u", channel);
		return;
	}
	/* What is left of it is the end. */
	if (branches_print(native, channel, text + n, room - n))
		memcpy(text, cut, n);
	else
		memmove(text, text + n, strlen(text + n) + 1);
	text[strlen(text) - 1] = '\0';
}
