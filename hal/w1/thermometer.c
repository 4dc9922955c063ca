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

#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "hal/chips/thermometer.h"
#include "hal/owfs/path.h"
#include "hal/w1/w1.h"

#define READ_SCRATCHPAD 0xbe
#define WRITE_SCRATCHPAD 0x4e
#define COPY_SCRATCHPAD 0x48
#define OLD_NS (10 * NATIVE_S)
#define REFUSED_NS (60 * NATIVE_S)
/* Millidegrees that a scratchpad can hold, either way. */
#define VALUE_MOST 128000

static int64_t now_of(const struct w1_master *master)
{
	return master->master.env->now(master->master.env->ctx);
}

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

static int read_limits(struct w1_master *master, const uint8_t rom[8], uint8_t scratchpad[9])
{
	int err = w1_slave_text(master, rom, "alarms");
	char *end;

	if (err)
		return err;
	long low = strtol(master->text, &end, 10);
	const char *behind = end;
	long high = strtol(behind, &end, 10);
	if (end == behind || low < INT8_MIN || low > INT8_MAX || high < INT8_MIN || high > INT8_MAX)
		return -EIO;
	scratchpad[SP_LOW] = (uint8_t)low;
	scratchpad[SP_HIGH] = (uint8_t)high;
	return 0;
}

static int read_resolution(struct w1_master *master, const struct w1_slave *slave,
                           uint8_t scratchpad[9])
{
	long resolution;
	int err = is_fixed(slave) ? -ENOENT
	                          : w1_slave_number(master, slave->rom, "resolution", &resolution);

	if (err)
		return err == -ENOENT ? 0 : err;
	if (resolution < 9 || resolution > 12)
		return -EIO;
	scratchpad[SP_CONFIG] = (uint8_t)((scratchpad[SP_CONFIG] & 0x9f) | (resolution - 9) << 5);
	return 0;
}

/* Settings as the driver tells them; the checksum to match. */
static int read_settings(struct w1_master *master, const struct w1_slave *slave,
                         uint8_t scratchpad[9])
{
	int err = read_resolution(master, slave, scratchpad);

	if (!err)
		err = read_limits(master, slave->rom, scratchpad);
	scratchpad[SP_CRC] = rom_crc8(scratchpad, 8);
	return err;
}

int w1_scratchpad(struct w1_master *master, struct w1_slave *slave, uint8_t scratchpad[9])
{
	int err = w1_slave_text(master, slave->rom, "w1_slave");
	long value;

	if (!err) {
		err = from_w1_slave(master->text, scratchpad);
	} else if (err == -ENOENT) {
		err = w1_slave_number(master, slave->rom, "temperature", &value);
		if (!err && (value < -VALUE_MOST || value > VALUE_MOST))
			err = -EIO;
		if (!err)
			from_value(slave, value, scratchpad);
		if (!err) {
			err = read_settings(master, slave, scratchpad);
			err = err == -ENOENT ? 0 : err;
		}
	}
	/* What was to be converted still is: the value before it is not the one asked for. */
	if (err)
		return err;
	memcpy(slave->scratchpad, scratchpad, 9);
	slave->due = false;
	slave->known = true;
	slave->read_ns = now_of(master);
	return 0;
}

/* Without a conversion, as far as the driver has the settings in attributes of their own. */
static int scratchpad_now(struct w1_master *master, struct w1_slave *slave, uint8_t scratchpad[9])
{
	bool settings = w1_slave_has(master, slave->rom, "alarms");

	if (slave->due || (!slave->known && (!settings || slave->rom[0] == 0x3b)) ||
	    (!settings && now_of(master) - slave->read_ns > OLD_NS))
		return w1_scratchpad(master, slave, scratchpad);
	if (slave->known)
		memcpy(scratchpad, slave->scratchpad, 9);
	else
		from_value(slave, 85000, scratchpad);
	return settings ? read_settings(master, slave, scratchpad) : 0;
}

static long master_number(struct w1_link *link, const char *name, const char *file, long otherwise)
{
	char text[24] = "";
	int n = w1_read(link->master, name, file, text, sizeof(text) - 1);

	return n > 0 ? strtol(text, NULL, 10) : otherwise;
}

/*
 * A slave that is no thermometer and is attached while all convert makes the driver (6.1) follow a
 * null pointer: the kernel's thread dies and the wire with it. So not among others, and not before
 * the first search is over; from then on only who plugs one in meets it.
 */
static bool converts_at_once(struct w1_link *link, const char *name)
{
	for (unsigned i = 0; i < link->master->slave_count; i++)
		if (link->master->slaves[i].channel == link - link->master->links &&
		    !family_of(link->master->slaves[i].rom[0])->thermometer)
			return false;
	/* No oftener than need be: who reads these while the master is removed hangs, and it too. */
	link->searched = link->searched || master_number(link, name, "w1_master_attempts", 2) >= 2;
	return link->searched || master_number(link, name, "w1_master_search", 0) == 0;
}

void w1_convert_all(struct w1_link *link)
{
	static const char trigger[8] = {'t', 'r', 'i', 'g', 'g', 'e', 'r', '\n'};
	struct w1_master *master = link->master;
	unsigned channel = (unsigned)(link - master->links);
	char name[24];

	for (unsigned i = 0; i < master->slave_count; i++)
		if (master->slaves[i].channel == channel)
			master->slaves[i].due = true;
	w1_master_name(link->number, name);
	/*
	 * Where it fails, or is not there, each converts when it is read. What the driver refuses, it
	 * tells its log.
	 */
	if (now_of(master) >= link->bulk_ns && w1_exists(master, name, "therm_bulk_read") &&
	    converts_at_once(link, name) &&
	    w1_write(master, name, "therm_bulk_read", trigger, sizeof(trigger)))
		link->bulk_ns = now_of(master) + REFUSED_NS;
}

static int put(struct w1_link *link, const char *file, const char *text)
{
	return w1_slave_write(link->master, link->slave->rom, file, text, strlen(text));
}

/* Older drivers take the resolution in w1_slave. What is so already is not written. */
static int write_settings(struct w1_link *link)
{
	const uint8_t *bytes = link->command + 1;
	uint8_t now[9] = {0};
	char text[24];
	bool settings = w1_slave_has(link->master, link->slave->rom, "alarms");
	int err = settings ? read_settings(link->master, link->slave, now)
	                   : scratchpad_now(link->master, link->slave, now);

	if (err || link->length < 3)
		return err ? err : -EIO;
	if (now[SP_HIGH] != bytes[0] || now[SP_LOW] != bytes[1]) {
		snprintf(text, sizeof(text), "%d %d\n", (int8_t)bytes[1], (int8_t)bytes[0]);
		err = settings ? put(link, "alarms", text) : -EOPNOTSUPP;
	}
	if (err || link->length < 4 || ((now[SP_CONFIG] ^ bytes[2]) & 0x60) == 0)
		return err;
	snprintf(text, sizeof(text), "%d\n", 9 + (bytes[2] >> 5 & 3));
	bool own = w1_slave_has(link->master, link->slave->rom, "resolution");
	err = put(link, own ? "resolution" : "w1_slave", text);
	link->slave->known &= own;
	/* Whoever may not change it reads at the resolution that the chip has. */
	return err == -EACCES || err == -EPERM ? 0 : err;
}

static int command(struct w1_link *link)
{
	switch (link->command[0]) {
	case WRITE_SCRATCHPAD:
		return write_settings(link);
	case COPY_SCRATCHPAD:
		return put(link, "eeprom_cmd", "save\n");
	case THERMOMETER_CONVERT:
		link->slave->due = true;
		return 0;
	case READ_SCRATCHPAD:
	case THERMOMETER_READ_POWER:
		return 0;
	}
	return -EOPNOTSUPP;
}

static int answer(struct w1_link *link, uint8_t *bytes, size_t n)
{
	if (link->command[0] != READ_SCRATCHPAD || n != 9)
		return -EOPNOTSUPP;
	return scratchpad_now(link->master, link->slave, bytes);
}

static int bit(struct w1_link *link)
{
	long power;
	int err = link->command[0] == THERMOMETER_READ_POWER
	                  ? w1_slave_number(link->master, link->slave->rom, "ext_power", &power)
	                  : -EOPNOTSUPP;

	return err ? err : power != 0;
}

const struct w1_wire w1_thermometer_wire = {.command = command, .answer = answer, .bit = bit};

/* What the chip measured last; where that is not known yet, now. */
static int read_latest(struct txn *txn)
{
	struct w1_slave *slave = w1_slave_of(w1_master_of(txn), txn->device->rom);

	slave->due |= !slave->known;
	return property_reader(txn->property)(txn);
}

static int read_whole(struct txn *txn)
{
	w1_slave_of(w1_master_of(txn), txn->device->rom)->due = true;
	return property_reader(txn->property)(txn);
}

/* A conversion that is still to be read is not for this. */
static int read_setting(struct txn *txn)
{
	struct w1_slave *slave = w1_slave_of(w1_master_of(txn), txn->device->rom);
	bool due = slave->due;

	slave->due = false;
	int err = property_reader(txn->property)(txn);
	slave->due = due;
	return err;
}

#define CONVERTED(text) \
	{ \
		.property = (text) \
	}
static const struct w1_way ways[] = {
	{.property = "errata/die"},
	CONVERTED("fasttemp"),
	CONVERTED("fault"),
	{.property = "flagfield", .read = read_setting},
	CONVERTED("ground_short"),
	{.property = "latesttemp", .read = read_latest},
	CONVERTED("open_circuit"),
	{.property = "power", .file = "ext_power"},
	{.property = "prog_addr", .read = read_setting},
	{.property = "scratchpad", .file = "w1_slave", .read = read_whole},
	CONVERTED("temperature"),
	CONVERTED("temperature10"),
	CONVERTED("temperature11"),
	CONVERTED("temperature12"),
	CONVERTED("temperature9"),
	{.property = "temphigh", .read = read_setting},
	{.property = "templow", .read = read_setting},
	{.property = "tempres", .read = read_setting},
	CONVERTED("thermocouple"),
	CONVERTED("vdd_short"),
};

/* clang-format off */
#define DRIVER(code) \
	{.family = (code), .files = {"w1_slave", "temperature"}, .wire = &w1_thermometer_wire, \
	 W1_WAYS(ways)}
/* clang-format on */
const struct w1_driver w1_thermometers[5] = {
	DRIVER(0x10), DRIVER(0x22), DRIVER(0x28), DRIVER(0x3b), DRIVER(0x42),
};
