/* SPDX-License-Identifier: MIT */
/*
 * A key (DS1990, DS2401, DS1420) is on the wire for as long as a person holds it there. With the
 * option Touch each wire is searched for these families alone, 33 times a second: where there is
 * none, that takes a reset and a few slots. What three such searches in a row did not see is gone.
 *
 * A branch of a coupler has to be switched on before it can be searched, and the one before it off:
 * some 40 ms of wire. So branches are not searched all the time. The presence pulse of a key that
 * comes to a branch that is off sets an event flag of the coupler (DS2409, data sheet 102199:
 * "Conditional search for fast event signaling"). So each round of a wire with couplers ends with a
 * search for couplers in alarm, and a branch with such news is searched at once. One with a key is
 * searched for as long as the key is there. A key that comes while its branch is on is no news: so
 * a branch is searched after others have used it. All branches take turns besides, for a key that
 * came just when its branch was searched, and because nothing tells the news of a coupler that is
 * behind another. All branches together get half of the time at most.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/native/branches.h"
#include "hal/native/limits.h"
#include "hal/native/master.h"
#include "hal/native/presence.h"
#include "hal/native/touch.h"
#include "hal/owfs/path.h"

#define EVERY_NS (30 * TXN_MS)
#define PAUSE_NS (500 * TXN_MS) /* after an error */
#define MISSED_MAX 3
#define TOUCH_NS (100 * TXN_MS)
#define TURN_NS (250 * TXN_MS)  /* branches without a reason */
#define QUIET_NS NS_PER_S       /* ... one that is told of by news */
#define TURN_SHARE 4            /* ... all of them take one part in so many of the time */
#define HOLDS_NS (150 * TXN_MS) /* a branch with a key */
#define USED_NS (100 * TXN_MS)  /* still on: not because of this search */
#define ROUND_MOST_NS NS_PER_S  /* one that took longer: the host slept, the adapter hung */
#define SPOILED_MAX 3

static const uint8_t families[] = {0x01, 0x81};
#define FAMILIES (sizeof(families) / sizeof(families[0]))

static bool is_branch(unsigned n)
{
	return n >= NATIVE_CHANNELS;
}

/* Has this channel's round begun, and not ended? */
static bool is_under_way(const struct touch *touch)
{
	return touch->searching || touch->family;
}

static bool has_key(const struct native *native, unsigned n)
{
	for (struct device *device = NULL; (device = native_device(native, n, device));)
		if (memchr(families, device->rom[0], FAMILIES))
			return true;
	return false;
}

/* True: it was not there before. */
static bool found_key(struct native *native, unsigned n, const uint8_t rom[8], int64_t now)
{
	const struct device *device = device_find(&native->table, rom);
	bool known = device && device->present && device->channel == n;
	char text[BUS_EVENT_TEXT], name[ROM_TEXT_MAX];

	presence_found(native, rom, n, now);
	device = device_find(&native->table, rom);
	if (known || !device)
		return false;
	const char *alias = device_alias(device);
	rom_print(rom, ROM_F_I, name);
	int len = snprintf(text, sizeof(text), "key %s%s%.60s%s touches ", name,
	                   alias[0] ? " (" : "", alias,
	                   alias[0] ? strlen(alias) > 60 ? "...)" : ")" : "");
	branches_name(native, n, text + len, sizeof(text) - (size_t)len);
	native_event(native, BUS_NOTE, rom, 0, text);
	return true;
}

/* While a key is there a search takes longer: others get half of the time even so. */
static void end_round(struct native *native, unsigned n, int64_t now)
{
	struct touch *touch = &native->channel[n].touch;
	int64_t took = earlier_ns(now - touch->round_ns, ROUND_MOST_NS);

	touch->searching = false;
	touch->family = 0;
	touch->next_ns = now + (took < EVERY_NS / 2 ? EVERY_NS - took : took);
	native->touched = true;
	native->next_touch[is_branch(n)] = n % NATIVE_CHANNELS + 1;
	if (!is_branch(n))
		return;
	touch->holds = has_key(native, n);
	touch->ended_ns = now;
	touch->next_ns = now + later_ns(HOLDS_NS, took);
	touch->turn_ns = now + (branches_has_news(native, n) ? QUIET_NS : TURN_NS);
	touch->used = false;
	native->touch_ns = now + took;
	native->touch_in_turn_ns = now + later_ns(TURN_NS, (TURN_SHARE - 1) * took);
}

/* The family is through; on to the next, or a pause. */
static void end_family(struct native *native, unsigned n, int64_t now)
{
	struct channel *channel = &native->channel[n];
	struct touch *touch = &channel->touch;

	for (struct device *device = NULL;
	     touch->family < FAMILIES && (device = native_device(native, n, device));)
		if (device->rom[0] == families[touch->family] && device->ok_ns < touch->begun_ns &&
		    ++device->missed >= MISSED_MAX)
			presence_lost(native, device);
	touch->searching = false;
	touch->family++;
	/* Couplers in alarm come after the keys. */
	if (touch->family < FAMILIES + (!is_branch(n) && channel->trunk))
		return;
	touch->whole_ns = touch->round_ns;
	end_round(native, n, now);
}

static int touch_begin(struct native *native, unsigned n, int64_t now)
{
	struct touch *touch = &native->channel[n].touch;
	bool alarm = touch->family == FAMILIES;

	if (!touch->searching) {
		search_begin(&touch->search, alarm,
		             alarm ? COUPLER_FAMILY : families[touch->family]);
		touch->searching = true;
		touch->begun_ns = now;
		if (touch->family == 0) {
			touch->round_ns = now;
			touch->next_ns = now;
		}
	}
	native_count(native, COUNT_SEARCHES);
	native_count(native, COUNT_TRANSACTIONS);
	int err = search_next(&touch->search, native->channel[n].link);
	if (err <= 0 || !alarm)
		return err;
	err = branches_look(native, touch->search.rom);
	return err ? err : 1;
}

/* A search failed. A key that is just being put on spoils it: then the next one is at once. */
static void touch_failed(struct native *native, unsigned n, int err, int64_t now)
{
	struct touch *touch = &native->channel[n].touch;
	bool again = err == -EBADMSG && ++touch->spoiled <= SPOILED_MAX;

	end_round(native, n, now);
	if (again || err != -EBADMSG)
		touch->next_ns = again ? now : now + PAUSE_NS;
	if (is_branch(n) && !again) {
		touch->next_ns = now + PAUSE_NS;
		touch->spoiled = 0;
		branches_news_end(native, n);
	}
	if (err == -EBADMSG)
		native_count(native, COUNT_CHECKSUMS);
	else if (err != -ECOMM)
		master_recover(native, n, err);
}

static void touch_pass(struct native *native, unsigned n, int64_t now)
{
	struct touch *touch = &native->channel[n].touch;
	int err = touch_begin(native, n, now);

	now = native_now(native);
	if (err < 0) {
		touch_failed(native, n, err, now);
		return;
	}
	master_good(native, n);
	touch->spoiled = 0;
	if (is_branch(n))
		branches_news_end(native, n);
	/* The signals of a new key are read before anything else is searched for. */
	if (err > 0 && touch->family < FAMILIES && found_key(native, n, touch->search.rom, now)) {
		end_round(native, n, now);
		return;
	}
	if (err == 0 || touch->search.last)
		end_family(native, n, now);
}

bool touch_seeks(const struct native *native, const uint8_t rom[8])
{
	return native->touch && memchr(families, rom[0], FAMILIES);
}

bool touch_knows(const struct native *native, const struct device *device, int64_t now)
{
	return touch_seeks(native, device->rom) && device->present &&
	       native_has(native, device->channel) && device->ok_ns + TOUCH_NS > now;
}

/* When this channel is searched next. */
static int64_t when_due(struct native *native, unsigned n, int64_t now)
{
	struct channel *channel = &native->channel[n];
	struct touch *touch = &channel->touch;

	if (native_held(native, n, NULL, now))
		return native->hold_ns[channel->link->chip % NATIVE_CHANNELS];
	if (!is_branch(n) || is_under_way(touch))
		return touch->next_ns;
	touch->used |= branches_news(native, n) ||
	               (now > touch->ended_ns + USED_NS && branches_is_on(native, n));
	if (branches_news(native, n))
		return native->touch_ns;
	if (touch->holds || touch->used)
		return later_ns(touch->next_ns, native->touch_ns);
	return later_ns(touch->turn_ns, native->touch_in_turn_ns);
}

static bool try_channel(struct native *native, unsigned n, int64_t now, int64_t *next)
{
	if (!native_has(native, n))
		return false;
	int64_t when = when_due(native, n, now);
	if (when > now) {
		*next = earlier_ns(when, *next);
		return false;
	}
	native->toucher = n;
	touch_pass(native, n, now);
	return true;
}

/*
 * What has begun goes on: another channel between two families would switch a branch off. Branches
 * come first, because each makes all others wait, and wires do not.
 */
bool touch_step(struct native *native, int64_t now, int64_t *next)
{
	const unsigned wires = native->channels, branches = NATIVE_ALL - NATIVE_CHANNELS;

	if (!native->touch)
		return false;
	if (is_under_way(&native->channel[native->toucher].touch) &&
	    try_channel(native, native->toucher, now, next))
		return true;
	for (unsigned i = 0; i < branches; i++)
		if (try_channel(native, NATIVE_CHANNELS + (native->next_touch[1] + i) % branches,
		                now, next))
			return true;
	for (unsigned i = 0; i < wires; i++)
		if (try_channel(native, (native->next_touch[0] + i) % wires, now, next))
			return true;
	return false;
}
