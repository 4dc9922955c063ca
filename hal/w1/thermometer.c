/* SPDX-License-Identifier: MIT */
/*
 * Thermometers. `w1_slave` has the whole scratchpad, which tells 85 degrees from a power fault;
 * `temperature`, where it is alone, the value. Reading them makes the chip convert, unless
 * `therm_bulk_read` has made all convert before. Settings are read and written without that.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/owfs/path.h"
#include "hal/w1/name.h"
#include "hal/w1/thermometer.h"

#define OLD_NS (10000 * TXN_MS)
#define REFUSED_NS (60000 * TXN_MS)
/* Millidegrees that a scratchpad can hold, either way. */
#define VALUE_MOST 128000
/* Readings that raise no alarm: they are none. */
#define BROKEN 0x07f8
#define POWER_ON 0x0550
#define REMAIN_POWER_ON 0x0c

static bool is_fixed(const struct w1_slave *slave)
{
	return slave->rom[0] == 0x10;
}

/* "72 01 4b 46 7f ff 0e 10 57 : crc=57 YES" */
static int from_w1_slave(const char *text, uint8_t scratchpad[9])
{
	char *end;

	for (unsigned i = 0; i < 9; i++) {
		unsigned long byte = strtoul(text, &end, 16);

		if (end == text || byte > 0xff)
			return -EIO;
		scratchpad[i] = (uint8_t)byte;
		text = end;
	}
	size_t line = strcspn(text, "\n");
	const char *yes = strstr(text, "YES");
	if (!yes || (size_t)(yes - text) > line || rom_crc8(scratchpad, 9))
		return -EBADMSG;
	return 0;
}

/* What a chip that stands at this value could have: sixteenths, or halves and their remainder. */
static void from_value(const struct w1_slave *slave, long millidegrees, uint8_t scratchpad[9])
{
	long raw = (millidegrees * 16 + (millidegrees < 0 ? -500 : 500)) / 1000;

	memset(scratchpad, 0xff, 9);
	scratchpad[SP_REMAIN] = 0;
	scratchpad[SP_PER_DEGREE] = 16;
	scratchpad[SP_CONFIG] = 0x7f;
	if (is_fixed(slave)) {
		long remain = ((12 - raw) % 16 + 16) % 16;

		raw = (raw - 12 + remain) / 16 * 2;
		scratchpad[SP_REMAIN] = (uint8_t)remain;
	}
	scratchpad[SP_LSB] = (uint8_t)raw;
	scratchpad[SP_MSB] = (uint8_t)(raw >> 8);
}

static int read_limits(struct w1_slave *slave, uint8_t scratchpad[9])
{
	int err = w1_slave_text(slave, "alarms");
	char *end;

	if (err)
		return err;
	long low = strtol(slave->tree->text, &end, 10);
	const char *behind = end;
	long high = strtol(behind, &end, 10);
	if (end == behind || low < INT8_MIN || low > INT8_MAX || high < INT8_MIN || high > INT8_MAX)
		return -EIO;
	scratchpad[SP_LOW] = (uint8_t)low;
	scratchpad[SP_HIGH] = (uint8_t)high;
	return 0;
}

static int read_resolution(struct w1_slave *slave, uint8_t scratchpad[9])
{
	long resolution;
	int err = is_fixed(slave) ? -ENOENT : w1_slave_number(slave, "resolution", &resolution);

	if (err)
		return err == -ENOENT ? 0 : err;
	if (resolution < 9 || resolution > 12)
		return -EIO;
	scratchpad[SP_CONFIG] = (uint8_t)((scratchpad[SP_CONFIG] & 0x9f) | (resolution - 9) << 5);
	return 0;
}

/* Settings as the driver tells them; the checksum to match. */
static int read_settings(struct w1_slave *slave, uint8_t scratchpad[9])
{
	int err = read_resolution(slave, scratchpad);

	if (!err)
		err = read_limits(slave, scratchpad);
	scratchpad[SP_CRC] = rom_crc8(scratchpad, 8);
	return err;
}

/* All nine bytes: of a new conversion, if none was read out since. */
static int read_new(struct w1_slave *slave, uint8_t scratchpad[9])
{
	int err = w1_slave_text(slave, "w1_slave");
	long value;

	if (!err) {
		err = from_w1_slave(slave->tree->text, scratchpad);
	} else if (err == -ENOENT) {
		err = w1_slave_number(slave, "temperature", &value);
		if (!err && (value < -VALUE_MOST || value > VALUE_MOST))
			err = -EIO;
		if (!err)
			from_value(slave, value, scratchpad);
		if (!err) {
			err = read_settings(slave, scratchpad);
			err = err == -ENOENT ? 0 : err;
		}
	}
	/*
	 * What was to be converted still is: the value before it is not the one asked for. Zeros
	 * with the settings of the attributes would pass for a chip's answer.
	 */
	if (err || thermometer_is_blank(family_of(slave->rom[0]), scratchpad))
		return err;
	memcpy(slave->scratchpad, scratchpad, 9);
	slave->due = false;
	slave->known = true;
	slave->read_ns = bus_now(slave->tree->env);
	return 0;
}

/* Without a conversion, as far as the driver has the settings in attributes of their own. */
static int read_now(struct w1_slave *slave, bool due, uint8_t scratchpad[9])
{
	bool settings = w1_slave_has(slave, "alarms");

	if (due || (!slave->known && (!settings || slave->rom[0] == 0x3b)) ||
	    (!settings && bus_now(slave->tree->env) - slave->read_ns > OLD_NS))
		return read_new(slave, scratchpad);
	if (slave->known)
		memcpy(scratchpad, slave->scratchpad, 9);
	else
		from_value(slave, 85000, scratchpad);
	return settings ? read_settings(slave, scratchpad) : 0;
}

/*
 * A conversion that is still to be read is not for a request for settings alone. What the chip
 * measured last, where that is not known yet, it measures now.
 */
static int thermometer_read_scratchpad(struct w1_slave *slave, unsigned at, uint8_t *bytes,
                                       unsigned n)
{
	bool is_setting = at >= SP_HIGH && at + n <= SP_5;
	uint8_t scratchpad[9];
	int err = read_now(slave, !is_setting && (slave->due || !slave->known), scratchpad);

	if (!err)
		memcpy(bytes, scratchpad + at, n);
	return err;
}

static int thermometer_put(struct w1_slave *slave, const char *file, const char *text)
{
	return w1_slave_write(slave, file, 0, text, strlen(text));
}

/* Older drivers take the resolution in w1_slave. What is so already is not written. */
static int write_settings(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	uint8_t now[9] = {0};
	char text[24];
	bool settings = w1_slave_has(slave, "alarms");
	int err = settings ? read_settings(slave, now) : read_now(slave, slave->due, now);

	if (err || at != SP_HIGH || n < 2)
		return err ? err : -EOPNOTSUPP;
	if (now[SP_HIGH] != bytes[0] || now[SP_LOW] != bytes[1]) {
		snprintf(text, sizeof(text), "%d %d\n", (int8_t)bytes[1], (int8_t)bytes[0]);
		err = settings ? thermometer_put(slave, "alarms", text) : -EOPNOTSUPP;
	}
	if (err || n < 3 || ((now[SP_CONFIG] ^ bytes[2]) & 0x60) == 0)
		return err;
	snprintf(text, sizeof(text), "%d\n", 9 + (bytes[2] >> 5 & 3));
	bool own = w1_slave_has(slave, "resolution");
	err = thermometer_put(slave, own ? "resolution" : "w1_slave", text);
	slave->known &= own;
	/* Whoever may not change it reads at the resolution that the chip has. */
	return err == -EACCES || err == -EPERM ? 0 : err;
}

/* Settings that are in the scratchpad go to the EEPROM as they are there. */
static int save(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	(void)at, (void)bytes, (void)n;
	return thermometer_put(slave, "eeprom_cmd", "save\n");
}

/* All ones: the wire feeds no chip. */
static int read_supply(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	long power = 0;
	int err = w1_slave_number(slave, "ext_power", &power);

	(void)at;
	memset(bytes, power ? 0xff : 0, n);
	return err;
}

static int thermometer_convert(struct w1_slave *slave, const char *what)
{
	(void)what;
	slave->due = true;
	return 0;
}

static long master_number(struct w1_tree *tree, const char *name, const char *file, long otherwise)
{
	char text[24] = "";
	int n = w1_read(tree, name, file, 0, text, sizeof(text) - 1);

	return n > 0 ? strtol(text, NULL, 10) : otherwise;
}

/*
 * A slave that is no thermometer and is attached while all convert makes the driver (6.1) follow a
 * null pointer: the kernel's thread dies and the wire with it. So not among others, and not before
 * the first search is over; from then on it happens only when a user plugs one in.
 */
static bool converts_at_once(struct w1_slaves *slaves, struct w1_bulk *bulk, const char *name)
{
	for (unsigned i = 0; i < slaves->count; i++)
		if (slaves->slave[i].channel == bulk->channel &&
		    !family_of(slaves->slave[i].rom[0])->thermometer)
			return false;
	/*
	 * No oftener than need be: a read of these while the master is removed hangs, and so does
	 * the removal.
	 */
	bulk->searched = bulk->searched ||
	                 master_number(slaves->tree, name, "w1_master_attempts", 2) >= 2;
	return bulk->searched || master_number(slaves->tree, name, "w1_master_search", 0) == 0;
}

void w1_convert_all(struct w1_slaves *slaves, struct w1_bulk *bulk)
{
	static const char trigger[8] = {'t', 'r', 'i', 'g', 'g', 'e', 'r', '\n'};
	struct w1_tree *tree = slaves->tree;
	char name[W1_MASTER_NAME_MAX];

	for (unsigned i = 0; i < slaves->count; i++)
		if (slaves->slave[i].channel == bulk->channel)
			slaves->slave[i].due = true;
	w1_master_name(bulk->number, name);
	/*
	 * Where it fails, or is not there, each converts when it is read. What the driver refuses,
	 * it tells its log.
	 */
	if (bus_now(tree->env) >= bulk->refused_ns && w1_exists(tree, name, "therm_bulk_read") &&
	    converts_at_once(slaves, bulk, name) &&
	    w1_write(tree, name, "therm_bulk_read", 0, trigger, sizeof(trigger)))
		bulk->refused_ns = bus_now(tree->env) + REFUSED_NS;
}

bool w1_alarm_converts(const struct w1_slave *slave)
{
	return family_of(slave->rom[0])->thermometer &&
	       (!slave->known || bus_now(slave->tree->env) - slave->read_ns > OLD_NS);
}

/* The chip compares whole degrees, after each conversion. */
static int is_in_alarm(struct w1_slave *slave)
{
	uint8_t *pad = slave->scratchpad, fresh[9];
	int err = w1_alarm_converts(slave) ? read_new(slave, fresh) : 0;

	if (err)
		return err;
	int raw = (int16_t)(pad[SP_LSB] | pad[SP_MSB] << 8), shift = is_fixed(slave) ? 1 : 4;
	if (!is_fixed(slave) &&
	    (raw >= BROKEN || (raw == POWER_ON && pad[SP_REMAIN] == REMAIN_POWER_ON)))
		return 0;
	int degrees = raw >= 0 ? raw >> shift : -((-raw + (1 << shift) - 1) >> shift);
	return degrees >= (int8_t)pad[SP_HIGH] || degrees <= (int8_t)pad[SP_LOW];
}

static const struct w1_part parts[] = {
	{.area = "scratchpad", .read = thermometer_read_scratchpad, .write = write_settings},
	{.area = "eeprom", .write = save},
	{.area = "supply", .read = read_supply},
};

static const struct w1_property properties[] = {
	{.name = "errata/die"},
	{.name = "fasttemp"},
	{.name = "fault"},
	{.name = "flagfield"},
	{.name = "ground_short"},
	{.name = "identity", .file = "w1_slave"},
	{.name = "latesttemp"},
	{.name = "open_circuit"},
	{.name = "power", .file = "ext_power"},
	{.name = "prog_addr"},
	{.name = "scratchpad", .file = "w1_slave"},
	{.name = "temperature"},
	{.name = "temperature10"},
	{.name = "temperature11"},
	{.name = "temperature12"},
	{.name = "temperature9"},
	{.name = "temphigh"},
	{.name = "templow"},
	{.name = "tempres"},
	{.name = "thermocouple"},
	{.name = "vdd_short"},
};

/* clang-format off */
#define DRIVER(code) \
	{.family = (code), .files = {"w1_slave", "temperature"}, W1_PARTS(parts), \
	 W1_PROPERTIES(properties), .convert = thermometer_convert, .alarm = is_in_alarm}
/* clang-format on */
const struct w1_driver w1_thermometers[] = {
	DRIVER(0x10), DRIVER(0x22), DRIVER(0x28), DRIVER(0x3b), DRIVER(0x42), {.family = 0},
};
