/* SPDX-License-Identifier: MIT */
/* Which driver has a slave, and what of its properties that driver's attributes stand for. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/w1/w1.h"

static const struct {
	const struct w1_driver *drivers;
	unsigned count;
} tables[] = {
	{w1_thermometers, sizeof(w1_thermometers) / sizeof(w1_thermometers[0])},
	{w1_switches, sizeof(w1_switches) / sizeof(w1_switches[0])},
	{w1_memories, sizeof(w1_memories) / sizeof(w1_memories[0])},
	{w1_wired, sizeof(w1_wired) / sizeof(w1_wired[0])},
};

const struct w1_driver *w1_driver_of(const struct w1_master *master, const uint8_t rom[8])
{
	for (size_t t = 0; t < sizeof(tables) / sizeof(tables[0]); t++) {
		for (unsigned i = 0; i < tables[t].count; i++) {
			const struct w1_driver *driver = &tables[t].drivers[i];

			if (driver->family != rom[0])
				continue;
			for (unsigned f = 0; f < 2 && driver->files[f]; f++)
				if (w1_slave_has(master, rom, driver->files[f]))
					return driver;
		}
	}
	return NULL;
}

static bool names_directory(const struct w1_way *way, const struct property *what)
{
	size_t n = strlen(what->name);

	return what->type == PROPERTY_DIRECTORY && strncmp(way->property, what->name, n) == 0 &&
	       way->property[n] == '/';
}

static bool has_element(const struct w1_way *way, int extension)
{
	return way->count == 0 || (extension >= 0 && (extension & 0xff) >= way->first &&
	                           (extension & 0xff) < way->first + way->count);
}

/* Raw access has no search, which a DS2405 needs, and no time for a conversion. */
static bool fits_rw(const struct device *device)
{
	return device->rom[0] != 0x05 && !device->family->thermometer;
}

static void tell_driver(struct w1_master *master, const uint8_t rom[8])
{
	struct w1_slave *slave = w1_slave_of(master, rom);
	char text[96], name[W1_NAME_MAX];

	w1_name(rom, name);
	if (slave->told_driver)
		return;
	slave->told_driver = true;
	snprintf(text, sizeof(text), "%s: no driver of the kernel has it", name);
	w1_note(master, -ENOENT, text);
}

int w1_property(struct link *base, const struct device *device, const struct property *what,
                int extension, property_function **read, property_function **write)
{
	struct w1_master *master = ((struct w1_link *)base)->master;
	const struct w1_driver *driver = w1_driver_of(master, device->rom);

	if (strcmp(what->name, "present") == 0)
		return 0;
	if (!driver) {
		char name[W1_NAME_MAX];

		/* Gone: the command will tell. */
		w1_name(device->rom, name);
		if (!w1_exists(master, name, ""))
			return 0;
		if (w1_slave_has(master, device->rom, "rw") && fits_rw(device))
			return 0;
		tell_driver(master, device->rom);
		return -ENOENT;
	}
	for (unsigned i = 0; i < driver->count; i++) {
		const struct w1_way *way = &driver->ways[i];

		if (names_directory(way, what))
			return 0;
		if (strcmp(way->property, what->name) != 0 || !has_element(way, extension) ||
		    (way->file && !w1_slave_has(master, device->rom, way->file)))
			continue;
		*read = way->read ? way->read : *read;
		*write = way->write ? way->write : *write;
		return 0;
	}
	return -ENOENT;
}
