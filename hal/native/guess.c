/* SPDX-License-Identifier: MIT */
/* Short searches: on which of several wires thermometers may be that are asked for. */
#include <string.h>

#include "hal/native/first_asked.h"
#include "hal/native/guess.h"
#include "hal/native/hunt.h"
#include "hal/wire/search.h"

/* It begins so long after the bus is up: clients that ask at once have asked by then. */
#define GATHER_NS (20 * TXN_MS)

/* The ids that are asked for, and those that are known. */
struct ids {
	unsigned n;
	uint8_t rom[NATIVE_DEPTH + DEVICE_MAX][ROM_LEN];
	bool alone; /* the search stopped at one of them */
};

/* Returns whether some of them are not known. */
static bool gather_ids(struct native *native, struct ids *ids)
{
	unsigned known = 0;
	struct path path;

	for (unsigned i = 0; i < native->table.count; i++)
		if (native->table.devices[i].present)
			memcpy(ids->rom[known++], native->table.devices[i].rom, ROM_LEN);
	ids->n = known;
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (!first_names(native, job, &path) || path.bus >= 0)
			continue;
		bool is_new = true;
		for (unsigned k = 0; is_new && k < ids->n; k++)
			is_new = memcmp(ids->rom[k], path.rom, ROM_LEN) != 0;
		if (is_new)
			memcpy(ids->rom[ids->n++], path.rom, ROM_LEN);
	}
	return ids->n > known;
}

/* True: exactly one id has this prefix of more than 8 bits. */
static bool is_alone(void *ctx, const uint8_t prefix[8], unsigned bits, uint8_t rom[8])
{
	struct ids *ids = ctx;
	const uint8_t *only = NULL;

	for (unsigned i = 0; bits > 8 && i < ids->n; i++) {
		if (!search_same(ids->rom[i], prefix, bits))
			continue;
		if (only)
			return false;
		only = ids->rom[i];
	}
	if (only)
		memcpy(rom, only, ROM_LEN);
	return ids->alone = only;
}

static void note_likely(struct native *native, const uint8_t rom[8], unsigned n)
{
	struct path path;

	/* No request waits for a device that is known, and perhaps no thermometer. */
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (first_names(native, job, &path) &&
		    memcmp(path.rom, rom, sizeof(path.rom)) == 0) {
			job->likely |= UINT64_C(1) << n;
			native->channel[n].first.likely = true;
		}
}

/* What goes wrong here is seen to by the search. */
static void guess_wire(struct native *native, unsigned n, struct ids *ids, int64_t now)
{
	struct channel *channel = &native->channel[n];

	ids->alone = false;
	if (!channel->first.guessing)
		search_begin(&channel->guess, false, 0);
	channel->first.guessing = true;
	channel->guess.lone = is_alone;
	channel->guess.ctx = ids;
	native_count(native, COUNT_SEARCHES);
	native_count(native, COUNT_TRANSACTIONS);
	int found = search_next(&channel->guess, channel->link);
	if (found > 0 && ids->alone)
		note_likely(native, channel->guess.rom, n);
	else if (found > 0)
		hunt_found(native, channel->guess.rom, n, now);
	channel->first.guessed = found <= 0 || channel->guess.last;
}

bool guess_step(struct native *native, int64_t now)
{
	struct ids ids;
	unsigned best = NATIVE_ALL;

	if (native_next(native, 1) == NATIVE_ALL || now < native->up_ns + GATHER_NS)
		return false;
	for (unsigned n = 0; n < native->channels; n++) {
		const struct first *first = &native->channel[n].first;

		if (!first_fits(native, n) || first->guessed ||
		    !native->channel[n].link->ops->triplet || native_held(native, n, NULL, now))
			continue;
		/* Each wire's first, so that it converts. */
		if (best == NATIVE_ALL ||
		    (!first->guessing && native->channel[best].first.guessing))
			best = n;
	}
	if (best == NATIVE_ALL)
		return false;
	if (!gather_ids(native, &ids))
		return false;
	guess_wire(native, best, &ids, now);
	return true;
}
