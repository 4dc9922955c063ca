/* SPDX-License-Identifier: MIT */
/*
 * Which driver has a slave, and which of its properties and areas that driver's attributes stand
 * for.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/w1/driver.h"
#include "hal/w1/ds2438.h"
#include "hal/w1/memory.h"
#include "hal/w1/name.h"
#include "hal/w1/switches.h"
#include "hal/w1/thermometer.h"

const struct w1_driver *w1_driver_of(const struct w1_slave *slave)
{
	static const struct w1_driver *const tables[] = {w1_thermometers, w1_switches, w1_memories,
	                                                 w1_ds2438};

	for (size_t t = 0; t < sizeof(tables) / sizeof(tables[0]); t++)
		for (const struct w1_driver *driver = tables[t]; driver->family; driver++)
			for (unsigned f = 0; f < 2 && driver->files[f]; f++)
				if (driver->family == slave->rom[0] &&
				    w1_slave_has(slave, driver->files[f]))
					return driver;
	return NULL;
}

/* Is it that property, or a directory above it? */
static bool is_named(const struct w1_property *property, const char *name)
{
	size_t n = strlen(name);

	return strncmp(property->name, name, n) == 0 &&
	       (property->name[n] == '\0' || property->name[n] == '/');
}

static bool has_element(const struct w1_property *property, int element)
{
	int n = extension_element(element);

	return property->count == 0 ||
	       (element >= 0 && n >= property->first && n < property->first + property->count);
}

/* Raw access has no search, which a DS2405 needs, and no time for a conversion. */
static bool fits_rw(const struct w1_slave *slave)
{
	return slave->rom[0] != 0x05 && !family_of(slave->rom[0])->thermometer;
}

static bool is_offered_raw(struct w1_slave *slave)
{
	char text[96], name[W1_NAME_MAX];

	w1_name(slave->rom, name);
	/* Gone: the command will tell. */
	if (!w1_exists(slave->tree, name, "") || (w1_slave_has(slave, "rw") && fits_rw(slave)))
		return true;
	if (!slave->told_driver) {
		snprintf(text, sizeof(text), "%s: no driver that owsd uses has it", name);
		w1_note(slave->tree, -ENOENT, text);
	}
	slave->told_driver = true;
	return false;
}

bool w1_offers(struct w1_slave *slave, const char *name, int element)
{
	const struct w1_driver *driver = w1_driver_of(slave);

	if (strcmp(name, "present") == 0)
		return true;
	if (!driver)
		return is_offered_raw(slave);
	for (unsigned i = 0; i < driver->property_count; i++) {
		const struct w1_property *property = &driver->properties[i];

		if (is_named(property, name) &&
		    (property->name[strlen(name)] == '/' || has_element(property, element)) &&
		    (!property->file || w1_slave_has(slave, property->file)))
			return true;
	}
	return false;
}

const struct w1_part *w1_part_of(const struct w1_slave *slave, const char *area)
{
	const struct w1_driver *driver = w1_driver_of(slave);

	for (unsigned i = 0; driver && i < driver->part_count; i++)
		if (strcmp(driver->parts[i].area, area) == 0)
			return &driver->parts[i];
	return NULL;
}

/* A slave that is being attached or removed has no attributes; without a driver it has `rw`. */
static int no_attribute(const struct w1_slave *slave)
{
	return w1_driver_of(slave) || w1_slave_has(slave, "rw") ? -EOPNOTSUPP : -ENODEV;
}

int w1_in_alarm(struct w1_slave *slave)
{
	const struct w1_driver *driver = w1_driver_of(slave);
	int in = driver && driver->alarm ? driver->alarm(slave) : -ENOENT;

	return in == -ENOENT ? no_attribute(slave) : in;
}
