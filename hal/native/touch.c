/* SPDX-License-Identifier: MIT */
/*
 * A key (DS1990, DS2401, DS1420) is on the wire for as long as somebody holds it there. With the
 * option Touch each wire is searched for these families alone, 33 times a second: where there is
 * none, that takes a reset and a few slots. What three such searches in a row did not see is gone.
 */
#include <errno.h>
#include <stdio.h>

#include "hal/native/master.h"
#include "hal/native/presence.h"
#include "hal/native/touch.h"
#include "hal/owfs/path.h"

#define EVERY_NS (30 * TXN_MS)
#define PAUSE_NS (500 * TXN_MS) /* after an error */
#define MISSED_MAX 3
#define TOUCH_NS (100 * TXN_MS)

static const uint8_t families[] = {0x01, 0x81};
#define FAMILIES (sizeof(families) / sizeof(families[0]))

static bool is_key(const struct device *device, unsigned n, uint8_t family)
{
	return device->present && device->channel == n && device->rom[0] == family;
}

/* True: it was not there before. */
static bool found(struct native *native, unsigned n, const uint8_t rom[8], int64_t now)
{
	const struct device *device = device_find(&native->table, rom);
	bool known = device && is_key(device, n, rom[0]);
	char text[BUS_EVENT_TEXT], name[ROM_TEXT_MAX];

	presence_found(native, rom, n, now);
	device = device_find(&native->table, rom);
	if (known || !device)
		return false;
	const char *alias = device_alias(device);
	rom_print(rom, ROM_F_I, name);
	snprintf(text, sizeof(text), "key %s%s%.60s%s touches bus.%u", name, alias[0] ? " (" : "",
	         alias, alias[0] ? ")" : "", n);
	native_event(native, BUS_NOTE, rom, 0, text);
	return true;
}

/* While a key is there a search takes longer: others get half of the time even so. */
static void end_round(struct native *native, struct touch *touch, int64_t now)
{
	int64_t took = now - touch->round_ns;

	touch->searching = false;
	touch->family = 0;
	touch->next_ns = now + (took < EVERY_NS / 2 ? EVERY_NS - took : took);
	native->touched = true;
}

/* The family is through; on to the next, or a pause. */
static void end_family(struct native *native, unsigned n, int64_t now)
{
	struct touch *touch = &native->channel[n].touch;

	for (unsigned i = 0; i < native->table.count; i++) {
		struct device *device = &native->table.devices[i];

		if (is_key(device, n, families[touch->family]) && device->ok_ns < touch->begun_ns &&
		    ++device->missed >= MISSED_MAX)
			presence_lost(native, device);
	}
	touch->searching = false;
	if (++touch->family < FAMILIES)
		return;
	end_round(native, touch, now);
}

static void pass(struct native *native, unsigned n, int64_t now)
{
	struct channel *channel = &native->channel[n];
	struct touch *touch = &channel->touch;

	if (!touch->searching) {
		search_begin(&touch->search, false, families[touch->family]);
		touch->searching = true;
		touch->begun_ns = now;
		if (touch->family == 0)
			touch->round_ns = now;
	}
	native_count(native, COUNT_SEARCHES);
	native_count(native, COUNT_TRANSACTIONS);
	int err = search_next(&touch->search, channel->link);
	now = native_now(native);
	if (err >= 0) {
		master_good(native, n);
		/* The signals of a new key are read before anything else is searched for. */
		if (err > 0 && found(native, n, touch->search.rom, now)) {
			end_round(native, touch, now);
			return;
		}
		if (err == 0 || touch->search.last)
			end_family(native, n, now);
		return;
	}
	/* A key that is just being put on spoils the search: the next one is at once. */
	end_round(native, touch, now);
	touch->next_ns = now + (err == -EBADMSG ? 0 : PAUSE_NS);
	if (err == -EBADMSG)
		native_count(native, COUNT_CHECKSUMS);
	else if (err != -ECOMM)
		master_recover(native, n, err);
}

bool touch_knows(const struct native *native, const struct device *device, int64_t now)
{
	bool key = false;

	for (size_t i = 0; i < FAMILIES; i++)
		key |= device->rom[0] == families[i];
	return native->touch && key && device->present && device->channel < native->channels &&
	       device->ok_ns + TOUCH_NS > now;
}

bool touch_step(struct native *native, int64_t now, int64_t *next)
{
	for (unsigned i = 0; native->touch && i < native->channels; i++) {
		unsigned n = (native->toucher + i) % native->channels;
		struct channel *channel = &native->channel[n];
		int64_t when = channel->touch.next_ns;

		if (native_held(native, n, NULL, now))
			when = native->hold_ns[channel->link->chip % NATIVE_CHANNELS];
		if (when <= now) {
			native->toucher = n + 1;
			pass(native, n, now);
			return true;
		}
		*next = when < *next ? when : *next;
	}
	return false;
}
