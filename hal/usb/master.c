/* SPDX-License-Identifier: MIT */
/*
 * Scheme "usb": a DS9490R as a master of the native bus: which of those that are plugged in it is,
 * also after it came back at another port. Each has a chip of its own on its wire, a DS1420 (family
 * 81): its name that stays, which is read when it is opened.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/native/native.h"
#include "hal/owfs/path.h"
#include "hal/usb/ds2490.h"
#include "hal/usb/find.h"
#include "hal/usb/libusb.h"
#include "hal/usb/master.h"
#include "hal/wire/search.h"

#define OWN_FAMILY 0x81
#define OWN_TRIES 3

struct usb_master {
	struct ds2490 chip;
	const struct usb_system *system;
	char where[USB_NAME];   /* the target's "1-1.4"; "": it names no port */
	uint8_t rom[8];         /* the chip by which it is found; all zero: by none */
	struct usb_place place; /* where it was opened last; name is "": never */
	uint64_t others;        /* the mark of a list in which it was not */
	unsigned turn;          /* which of the list is tried first */
};

static struct usb_master *usb_of(struct link_master *base)
{
	return (struct usb_master *)base;
}

int usb_create(const struct usb_system *system, const char *where, const struct bus_env *env,
               struct link_master **out, char *why, size_t size)
{
	uint8_t rom[8] = {0};
	bool is_port = usb_is_name(where) && strlen(where) < USB_NAME;

	if (*where && !is_port && (rom_parse(where, strlen(where), rom) || rom[0] != OWN_FAMILY)) {
		snprintf(why, size,
		         "\"%.60s\": expected the id of the adapter's own chip, as "
		         "81.3B4429000000, or its place, as 1-1.4",
		         where);
		return -EINVAL;
	}
	struct usb_master *master = calloc(1, sizeof(*master));

	if (!master)
		return -ENOMEM;
	ds2490_init(&master->chip, &usb_master_ops, env);
	master->chip.adapter.device = master->place.device;
	master->chip.adapter.proc = system->proc;
	master->system = system;
	memcpy(master->rom, rom, sizeof(rom));
	master->turn = rom[1]; /* targets of several adapters do not all begin with one */
	if (is_port)
		snprintf(master->where, sizeof(master->where), "%s", where);
	*out = &master->chip.adapter.master;
	return 0;
}

static uint64_t mark_of(const struct usb_place *places, unsigned n)
{
	uint64_t mark = 1;

	for (unsigned i = 0; i < n; i++)
		for (const char *at = places[i].device; *at; at++)
			mark = mark * 31 + (uint8_t)*at;
	return mark;
}

/* The adapter's own chip: how many of its family are on the wire, or an error. */
static int find_own(struct usb_master *master, uint8_t rom[8])
{
	struct search search;
	int found = 0, count = 0;

	for (int i = 0; i < OWN_TRIES; i++) {
		count = 0;
		search_begin(&search, false, OWN_FAMILY);
		while ((found = search_next(&search, &master->chip.adapter.link)) > 0) {
			if (!count++ || memcmp(search.rom, master->rom, 8) == 0)
				memcpy(rom, search.rom, 8);
		}
		if (found == 0 || found == -ENODEV || found == -ECANCELED)
			break;
	}
	return found < 0 ? found : count;
}

/*
 * Is it the one? 0, -ENXIO: another, or an error. Where the target names none, the one that is
 * opened first becomes it. On a wire that fails nothing can be asked: then it is the one if there
 * is no other. One without a chip of its own is asked again.
 */
static int judge(struct usb_master *master, bool only, char *why, size_t size)
{
	char text[ROM_TEXT_MAX];
	uint8_t rom[8] = {0};
	int own = find_own(master, rom);

	if (own == -ENODEV)
		snprintf(why, size, "%s is gone: is it plugged in?", master->chip.adapter.name);
	if (own == -ENODEV || own == -ECANCELED)
		return own;
	if (!master->rom[0]) {
		if (own == 1 && !*master->where)
			memcpy(master->rom, rom, sizeof(rom));
		return 0;
	}
	if (own > 0)
		return memcmp(rom, master->rom, 8) != 0 ? -ENXIO : 0;
	if (own == 0) {
		/* it may have its supply for a moment only */
		snprintf(why, size, "%s does not show its own chip", master->chip.adapter.name);
		return -EIO;
	}
	if (only)
		return 0;
	rom_print(master->rom, ROM_F_I, text);
	snprintf(why, size, "it is not known whether %s has the chip %s: its wire fails (%s)",
	         master->chip.adapter.name, text, strerror(-own));
	return own == -ENXIO ? -EIO : own;
}

/*
 * Open it, and look whether it is the one: -ENXIO. The kernel's driver gets back at once what may
 * be another.
 */
static int try_place(struct usb_master *master, const struct usb_place *place, bool only, char *why,
                     size_t size)
{
	struct adapter *adapter = &master->chip.adapter;
	int err = master->system->open(place, &master->chip.port, why, size);

	if (err)
		return err;
	adapter->open = true;
	adapter->lost = false;
	master->place = *place;
	snprintf(adapter->name, sizeof(adapter->name), USB_CALLED, place->name);
	err = ds2490_begin(&master->chip);
	if (err)
		snprintf(why, size, "%s does not answer (%s): unplug it and plug it in again",
		         adapter->name, strerror(-err));
	else
		err = judge(master, only, why, size);
	if (err)
		adapter->master.ops->close(&adapter->master);
	if (err == -ENXIO || (err && !only)) {
		master->system->give_back(place);
		master->place.name[0] = '\0';
	}
	return err;
}

/* None of them was it. */
static int explain_none(const struct usb_master *master, char *why, size_t size)
{
	char text[ROM_TEXT_MAX];

	rom_print(master->rom, ROM_F_I, text);
	if (*master->where)
		snprintf(why, size, "no DS9490R at USB %s: is it plugged in?", master->where);
	else if (master->rom[0])
		snprintf(why, size, "no DS9490R with the chip %s: is it plugged in?", text);
	else
		snprintf(why, size, "no DS9490R: is it plugged in? lsusb -d 04fa:2490");
	return -ENODEV;
}

static int usb_open(struct link_master *base, char *why, size_t size)
{
	struct usb_master *master = usb_of(base);
	struct usb_place places[USB_PLACES];
	unsigned n = master->system->list(places);
	uint64_t mark = mark_of(places, n);
	int result = -ENXIO;

	if (n > 1 && !*master->where && !master->rom[0]) {
		snprintf(
			why, size,
			"there are %u DS9490R, at USB %s, %s%s: name one, as usb:%s, or by its own "
			"chip 81.*, which owsctl -t usb:%s scan shows",
			n, places[0].name, places[1].name, n > 2 ? " ..." : "", places[0].name,
			places[0].name);
		return -EINVAL;
	}
	if (mark == master->others)
		n = 0;
	for (unsigned i = 0; i < n; i++) {
		const struct usb_place *place = &places[(master->turn + i) % n];

		if (*master->where && strcmp(master->where, place->name) != 0)
			continue;
		int err = try_place(master, place, n == 1, why, size);

		if (!err || err == -ECANCELED)
			return err;
		if (err != -ENXIO)
			result = err;
	}
	master->turn++;
	if (result != -ENXIO)
		return result; /* one could not be asked, and why says so */
	master->others = mark;
	return explain_none(master, why, size);
}

static void usb_close(struct link_master *base)
{
	struct usb_master *master = usb_of(base);

	if (!master->chip.adapter.open)
		return;
	(void)ds2490_end_strong(&master->chip); /* nobody else would */
	master->chip.port->ops->close(master->chip.port);
	master->chip.adapter.open = false;
}

static int usb_visible(struct link_master *base, uint64_t *mark)
{
	struct usb_master *master = usb_of(base);
	struct usb_place places[USB_PLACES];
	unsigned n = master->system->list(places);
	int visible = 0;

	*mark = mark_of(places, n);
	for (unsigned i = 0; i < n && *mark != master->others; i++)
		visible |= !*master->where || strcmp(master->where, places[i].name) == 0;
	return visible;
}

/* The kernel's driver gets it at the end alone: not for the moment of each new try. */
static void usb_destroy(struct link_master *base)
{
	struct usb_master *master = usb_of(base);

	usb_close(base);
	if (*master->place.name)
		master->system->give_back(&master->place);
	free(master);
}

static int create(const char *where, const struct bus_env *env, struct link_master **master,
                  char *why, size_t size)
{
	return usb_create(&usb_linux, where, env, master, why, size);
}

const struct link_master_ops usb_master_ops = {
	.create = create,
	.open = usb_open,
	.close = usb_close,
	.visible = usb_visible,
	.destroy = usb_destroy,
	ADAPTER_MASTER_SLOTS,
};

static int usb_bus_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                          size_t size)
{
	return native_create(&usb_bus, &usb_master_ops, where, env, bus, why, size);
}

const struct bus_ops usb_bus = {
	.scheme = "usb",
	.summary = "1-Wire devices on a USB adapter with DS2490: DS9490R",
	.create = usb_bus_create,
	.caches = "",
	NATIVE_BUS_SLOTS,
};
