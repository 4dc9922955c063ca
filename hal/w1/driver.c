/* SPDX-License-Identifier: MIT */
/*
 * Which driver has a slave, and which of its properties and areas that driver's attributes stand
 * for: of the EEPROMs, the counters of the DS2423, and the DS2438 here.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/chips/area.h"
#include "hal/chips/batteries/ds2438.h"
#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/w1/driver.h"
#include "hal/w1/switches.h"
#include "hal/w1/thermometer.h"

/* --- Memories -------------------------------------------------------------------------------- */

/* EEPROMs are one attribute; the driver of the DS2423 gives the text of four pages. */
static int read_eeprom(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	return w1_slave_read(slave, "eeprom", at, bytes, n);
}

/* The drivers of DS2433 and DS28E04 take what comes; the others' read twice themselves. */
static int read_twice(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t again[AREA_UNIT];
	int err = n <= sizeof(again) ? read_eeprom(slave, at, bytes, n) : -EIO;

	if (!err)
		err = read_eeprom(slave, at, again, n);
	return err ? err : memcmp(bytes, again, n) == 0 ? 0 : -EBADE;
}

static int write_eeprom(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	return w1_slave_write(slave, "eeprom", at, bytes, n);
}

/* The driver's lines are of pages 12 to 15: 42 bytes, "crc=YES c=1234". */
static int parse_counter(const char *line, unsigned page, uint32_t *count)
{
	const char *good, *number;
	char *end;

	for (unsigned i = 12; i < page; i++) {
		line = strchr(line, '\n');
		if (!line)
			return -EIO;
		line++;
	}
	size_t len = strcspn(line, "\n");
	good = strstr(line, "crc=YES");
	if (!good || (size_t)(good - line) > len)
		return memchr(line, '=', len) ? -EBADMSG : -EIO;
	number = strstr(good, "c=Y") == good ? NULL : strstr(good, " c=");
	if (!number || (size_t)(number - line) > len)
		return -EIO;
	/* Printed with a sign. */
	*count = (uint32_t)strtoll(number + 3, &end, 10);
	return end == number + 3 ? -EIO : 0;
}

/* Four bytes of each page. */
static int read_counters(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	int err = w1_slave_text(slave, "w1_slave");

	for (unsigned i = 0; i < n && !err; i++) {
		uint32_t count = 0;

		err = at + i < 4 * 12 ? -ENOENT
		                      : parse_counter(slave->tree->text, (at + i) / 4, &count);
		bytes[i] = (uint8_t)(count >> 8 * ((at + i) % 4));
	}
	return err;
}

static const struct w1_part eeprom[] = {
	{.area = "memory", .read = read_eeprom, .write = write_eeprom},
};
static const struct w1_part ds2433[] = {
	{.area = "memory", .read = read_twice, .write = write_eeprom},
};
static const struct w1_property eeprom_properties[] = {
	{.name = "memory"},
	{.name = "pages/page"},
};

/* What follows the pages is no attribute. */
static const struct w1_property ds28e04_properties[] = {
	{.name = "pages/page"},
};

static const struct w1_part ds2423[] = {
	{.area = "counters", .read = read_counters},
};
static const struct w1_property ds2423_properties[] = {
	{.name = "counter"},
	{.name = "counters"},
	{.name = "mincount"},
	{.name = "pages/count", .first = 12, .count = 4},
};

/* clang-format off */
#define EEPROM(code, parts_) \
	{.family = (code), .files = {"eeprom"}, W1_PARTS(parts_), W1_PROPERTIES(eeprom_properties)}

static const struct w1_driver w1_memories[] = {
	EEPROM(0x14, eeprom),
	{.family = 0x1c, .files = {"eeprom"}, W1_PARTS(ds2433), W1_PROPERTIES(ds28e04_properties)},
	{.family = 0x1d, .files = {"w1_slave"}, W1_PARTS(ds2423), W1_PROPERTIES(ds2423_properties)},
	EEPROM(0x23, ds2433),
	EEPROM(0x2d, eeprom),
	{.family = 0},
};
/* clang-format on */

/* --- The DS2438 ------------------------------------------------------------------------------ */

/*
 * Reading `temperature`, `vad` and `vdd` makes the chip convert and leaves the result in page 0,
 * where the family's functions look for it.
 */
static int read_page(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t page[8];
	int err = at / 8 > 1 || at % 8 + n > 8
	                  ? -ENOENT
	                  : w1_slave_read(slave, at / 8 ? "page1" : "page0", 0, page, sizeof(page));

	if (!err)
		memcpy(bytes, page + at % 8, n);
	return err;
}

/* Of the configuration the driver can change what it measures, not the accumulator's bits. */
static int write_configuration(struct w1_slave *slave, unsigned at, const uint8_t *bytes,
                               unsigned n)
{
	uint8_t now, on = bytes[0] & DS2438_IAD;
	int err = at || n != 1 ? -EOPNOTSUPP : read_page(slave, 0, &now, 1);

	if (err)
		return err;
	if ((now ^ bytes[0]) & (DS2438_CA | DS2438_EE))
		return -EOPNOTSUPP;
	return (now ^ bytes[0]) & DS2438_IAD ? w1_slave_write(slave, "iad", 0, &on, 1) : 0;
}

/* The attributes' names are the quantities', but for the case. */
static int ds2438_convert(struct w1_slave *slave, const char *what)
{
	static const char *const files[] = {"temperature", "vad", "vdd"};

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++)
		if (strcasecmp(files[i], what) == 0)
			return w1_slave_text(slave, files[i]);
	return -EOPNOTSUPP;
}

static const struct w1_part parts[] = {
	{.area = "pages", .read = read_page, .write = write_configuration},
};

static const struct w1_property properties[] = {
	{.name = "CA"},
	{.name = "EE"},
	{.name = "HIH3600/humidity"},
	{.name = "HIH4000/humidity"},
	{.name = "HIH5030/humidity"},
	{.name = "HTM1735/humidity"},
	{.name = "IAD"},
	{.name = "VAD"},
	{.name = "VDD"},
	{.name = "date", .file = "page1"},
	{.name = "humidity"},
	{.name = "identity"},
	{.name = "latesttemp"},
	{.name = "offset", .file = "page1"},
	{.name = "pages/page", .first = 0, .count = 1},
	{.name = "pages/page", .file = "page1", .first = 1, .count = 1},
	{.name = "temperature"},
	{.name = "udate", .file = "page1"},
	{.name = "vis"},
};

static const struct w1_driver w1_ds2438[] = {
	{.family = 0x26,
         .files = {"page0"},
         W1_PARTS(parts),
         W1_PROPERTIES(properties),
         .convert = ds2438_convert},
	{.family = 0},
};

/* --- All drivers ----------------------------------------------------------------------------- */

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
	char text[96];

	/* Gone: the command will tell. */
	if (!w1_exists(slave->tree, slave->name, "") ||
	    (w1_slave_has(slave, "rw") && fits_rw(slave)))
		return true;
	if (!slave->told_driver) {
		snprintf(text, sizeof(text), "%s: no driver that owsd uses has it", slave->name);
		bus_report(slave->tree->env, BUS_NOTE, -ENOENT, text);
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
	slave->told_driver = false;
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
