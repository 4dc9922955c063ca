/* SPDX-License-Identifier: MIT */
/*
 * The directories of OWFS that belong to no device: settings, statistics, simultaneous, interface,
 * system. Their functions use no wire, but for `simultaneous`. Of /statistics they have what tells
 * of the wire and the chips, under the names that owserver gives it. Clients of owserver read
 * numbers of 32 bits: a count wraps.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/native/state.h"
#include "hal/native/tables.h"
#include "hal/wire/crc.h"

#define READ_ROM 0x33
#define READ_ROM_DS2400 0x0f

/* arg is the value. */
static int read_arg(struct txn *txn)
{
	txn->number[0] = txn->property->arg;
	return 0;
}

/* arg: where it stands in struct native. */
static void *member_of(struct txn *txn)
{
	return (char *)txn->native + txn->property->arg;
}

static int read_count(struct txn *txn)
{
	txn->number[0] = (double)(uint32_t) * (uint64_t *)member_of(txn);
	return 0;
}

/* For devices that this bus does not know, whatever is there. */
static int write_nothing(struct txn *txn)
{
	(void)txn;
	return 0;
}

static int read_pid(struct txn *txn)
{
	txn->number[0] = getpid();
	return 0;
}

static int read_buses(struct txn *txn)
{
	txn->number[0] = txn->native->channels;
	return 0;
}

static int read_version(struct txn *txn)
{
	return property_text(txn, OWSD_VERSION);
}

static int read_empty(struct txn *txn)
{
	txn->len = 0;
	return 0;
}

/* arg: enum native_simultaneous. */
static int read_simultaneous(struct txn *txn)
{
	const struct native *native = txn->native;
	const struct channel *channel = &native->channel[txn->channel];
	int64_t end = channel->simultaneous_ns[txn->property->arg];

	txn->number[0] = end && native_now(native) < end + native->volatile_ns;
	return 0;
}

/* A presence pulse, whosever. */
static int read_present(struct txn *txn)
{
	int err = txn_end(txn, txn_raw(txn, NULL, 0));

	txn->number[0] = err == 0;
	return err == -ENODEV ? 0 : err;
}

/* Its id, where one device is alone on the wire; several spoil each other's checksum. */
static int read_single(struct txn *txn)
{
	uint8_t command = (uint8_t)txn->property->arg, rom[8];
	char name[ROM_TEXT_MAX];
	int err = txn_raw(txn, &command, 1);

	if (!err)
		err = txn_read(txn, rom, sizeof(rom));
	if (err)
		return err == -ENODEV ? 0 : err;
	if (!onewire_rom_valid(rom))
		return 0;
	rom_print(rom, ROM_F_I_C, name);
	return property_text(txn, name);
}

static int read_name(struct txn *txn)
{
	char name[64];

	/* By this word a client of an owserver learns that nothing behind it is real. */
	snprintf(name, sizeof(name), "%s%s",
	         txn->native->master->ops->simulated ? "Simulated-" : "",
	         txn->link ? txn->link->ops->name : "");
	return property_text(txn, name);
}

static int read_address(struct txn *txn)
{
	return property_text(txn, txn->native->where);
}

static int read_elapsed(struct txn *txn)
{
	int64_t seconds = (native_now(txn->native) - txn->native->up_ns) / NS_PER_S;

	txn->number[0] = (double)seconds;
	return 0;
}

enum { WIRE_TIME, RESETS };

static int read_cost(struct txn *txn)
{
	struct link_cost cost = txn->link ? link_cost_of(txn->link) : (struct link_cost){0};

	if (txn->property->arg == RESETS)
		txn->number[0] = (double)(uint32_t)cost.resets;
	else
		txn->number[0] = (double)cost.wire_ns / 1e9;
	return 0;
}

/* arg: where the count stands in struct channel. */
static int read_channel(struct txn *txn)
{
	uint64_t count;

	memcpy(&count, (const char *)&txn->native->channel[txn->channel] + txn->property->arg,
	       sizeof(count));
	txn->number[0] = (double)(uint32_t)count;
	return 0;
}

/* --- Settings --- */

enum { DIRECTORY, FTP, HA7, NETWORK, SERIAL, SERVER, USB, W1 };

static int read_scale(struct txn *txn)
{
	char text[2] = {txn->native->temperature_scale, '\0'};

	return property_text(txn, txn->property->arg ? txn->native->pressure_scale : text);
}

/*
 * As in owserver the setting is what a client gets that states no scale of its own. The bus itself
 * answers in degrees Celsius and mbar always.
 */
static int write_scale(struct txn *txn)
{
	static const char *const pressure[] = {"mbar", "atm", "mmHg", "inHg", "psi", "Pa"};

	if (!txn->property->arg) {
		if (txn->len == 0 || !strchr("CFKR", txn->data[0]) || !txn->data[0])
			return -EINVAL;
		txn->native->temperature_scale = (char)txn->data[0];
		return 0;
	}
	for (size_t i = 0; i < sizeof(pressure) / sizeof(pressure[0]); i++)
		if (strlen(pressure[i]) == txn->len && !memcmp(pressure[i], txn->data, txn->len)) {
			memcpy(txn->native->pressure_scale, pressure[i], txn->len + 1);
			return 0;
		}
	return -EINVAL;
}

static int read_timeout(struct txn *txn)
{
	int64_t seconds = *(int64_t *)member_of(txn) / NS_PER_S;

	txn->number[0] = (double)seconds;
	return 0;
}

static int write_timeout(struct txn *txn)
{
	if (txn->number[0] > 1e6)
		return -EINVAL;
	*(int64_t *)member_of(txn) = (int64_t)txn->number[0] * NS_PER_S;
	return 0;
}

/* As owserver has them at its start. */
void native_settings(struct native *native)
{
	static const int64_t seconds[NATIVE_IDLE_TIMEOUTS] = {
		[DIRECTORY] = 60, [FTP] = 900,   [HA7] = 60, [NETWORK] = 1,
		[SERIAL] = 5,     [SERVER] = 10, [USB] = 5,  [W1] = 30,
	};

	for (unsigned i = 0; i < NATIVE_IDLE_TIMEOUTS; i++)
		native->idle_ns[i] = seconds[i] * NS_PER_S;
	native->temperature_scale = 'C';
	memcpy(native->pressure_scale, "mbar", sizeof("mbar"));
}

static int read_flag(struct txn *txn)
{
	txn->number[0] = *(bool *)member_of(txn);
	return 0;
}

static int write_flag(struct txn *txn)
{
	*(bool *)member_of(txn) = txn->number[0] != 0;
	return 0;
}

/* One line for each alias: the whole id, '=', the alias. */
static int read_aliases(struct txn *txn)
{
	const struct device_table *table = &txn->native->table;
	char line[16 + 1 + DEVICE_ALIAS_MAX + 2 + 1];

	for (unsigned i = 0; i < table->count; i++) {
		const struct device *device = &table->devices[i];
		const char *alias = device_alias(device);
		size_t len = 0;

		if (!alias[0])
			continue;
		for (int byte = 0; byte < 8; byte++, len += 2)
			snprintf(line + len, sizeof(line) - len, "%02X", device->rom[byte]);
		len += (size_t)snprintf(line + len, sizeof(line) - len, "=%s\r\n", alias);
		if (len > txn->room - txn->len)
			return -EMSGSIZE;
		memcpy(txn->data + txn->len, line, len);
		txn->len += len;
	}
	return 0;
}

/* --- The tables --- */

/* The ways in which all tables answer: index of how[]. */
#define WAYS(X) \
	X(ADDRESS, .read = read_address) \
	X(ARG, .read = read_arg) \
	X(NAME, .read = read_name) \
	X(COST, .read = read_cost) \
	X(ELAPSED, .read = read_elapsed) \
	X(CHANNEL, .read = read_channel) \
	X(COUNT, .read = read_count) \
	X(SIMULTANEOUS, .read = read_simultaneous) \
	X(PRESENT, .read = read_present) \
	X(SINGLE, .read = read_single) \
	X(NOTHING, .read = read_arg, .write = write_nothing) \
	X(VERSION, .read = read_version) \
	X(BUSES, .read = read_buses) \
	X(PID, .read = read_pid) \
	X(EMPTY, .read = read_empty) \
	X(SCALE, .read = read_scale, .write = write_scale) \
	X(TIMEOUT, .read = read_timeout, .write = write_timeout) \
	X(FLAG, .read = read_flag, .write = write_flag) \
	X(ALIASES, .read = read_aliases)
enum { WAY_NONE, WAYS(WAY_ENUM) };
static const struct property_how how[] = {WAYS(WAY_HOW)};

#define VIRTUAL(text, kind, life_, access_, what, how_) \
	PROPERTY(text, kind, life_, access_, .offline = true, .arg = (what), .how = (how_))
#define VIRTUAL_NUMBER(text, how_, what) VIRTUAL(text, UNSIGNED, VOLATILE, READ, what, how_)
#define VIRTUAL_TEXT(text, bytes, how_) \
	PROPERTY(text, ASCII, STATIC, READ, .offline = true, .size = (bytes), .how = (how_))
#define COUNT(text, which) \
	VIRTUAL_NUMBER(text, WAY_COUNT, offsetof(struct native, count[COUNT_##which]))

#define CHANNEL(text, member) VIRTUAL_NUMBER(text, WAY_CHANNEL, offsetof(struct channel, member))

static const struct property interface[] = {
	PROPERTY_DIR("settings"),
	VIRTUAL_TEXT("settings/address", 512, WAY_ADDRESS),
	VIRTUAL("settings/ds2404_found", YESNO, STATIC, READ, 0, WAY_ARG),
	VIRTUAL_TEXT("settings/name", 128, WAY_NAME),
	VIRTUAL("settings/overdrive", YESNO, STATIC, READ, 0, WAY_ARG),
	VIRTUAL("settings/version", UNSIGNED, STATIC, READ, 0, WAY_ARG),
	PROPERTY_DIR("statistics"),
	VIRTUAL("statistics/bus_time", FLOAT, VOLATILE, READ, WIRE_TIME, WAY_COST),
	VIRTUAL_NUMBER("statistics/elapsed_time", WAY_ELAPSED, 0),
	CHANNEL("statistics/errors", errors),
	CHANNEL("statistics/locks", transactions),
	PROPERTY_DIR("statistics/overdrive"),
	VIRTUAL_NUMBER("statistics/overdrive/attempts", WAY_ARG, 0),
	VIRTUAL_NUMBER("statistics/overdrive/failures", WAY_ARG, 0),
	CHANNEL("statistics/read_errors", checksums),
	COUNT("statistics/reconnects", REOPENS),
	VIRTUAL_NUMBER("statistics/resets", WAY_COST, RESETS),
	CHANNEL("statistics/shorts", shorts),
	COUNT("statistics/timeouts", CHIP_RESETS),
	CHANNEL("statistics/unlocks", transactions),
};

#define CONVERTS(text, which) \
	PROPERTY(text, YESNO, VOLATILE, BOTH, .offline = true, .convert = CONVERT_TEMPRES, \
	         .arg = (which), .how = WAY_SIMULTANEOUS)
#define PRESENT(text) PROPERTY(text, YESNO, VOLATILE, READ, .how = WAY_PRESENT)
#define SINGLE(text, command) \
	PROPERTY(text, ASCII, VOLATILE, READ, .size = 18, .arg = (command), .how = WAY_SINGLE)

static const struct property simultaneous[] = {
	VIRTUAL("iblss", YESNO, VOLATILE, BOTH, 0, WAY_NOTHING),
	PRESENT("present"),
	PRESENT("present_ds2400"),
	SINGLE("single", READ_ROM),
	SINGLE("single_ds2400", READ_ROM_DS2400),
	CONVERTS("temperature", SIMULTANEOUS_TEMPERATURE),
	CONVERTS("voltage", SIMULTANEOUS_VOLTAGE),
};

/* What this build can drive. */
#define DRIVES(text, yes) VIRTUAL(text, INTEGER, STATIC, READ, yes, WAY_ARG)

static const struct property systems[] = {
	PROPERTY_DIR("configuration"),
	DRIVES("configuration/DebugInfo", 0),
	DRIVES("configuration/USB", 0),
	DRIVES("configuration/i2c", 1),
	DRIVES("configuration/parport", 0),
	VIRTUAL("configuration/trim", YESNO, STATIC, READ, 0, WAY_ARG),
	VIRTUAL_TEXT("configuration/version", 20, WAY_VERSION),
	DRIVES("configuration/zeroconf", 0),
	PROPERTY_DIR("connections"),
	VIRTUAL_NUMBER("connections/count_current_buses", WAY_BUSES, 0),
	VIRTUAL_NUMBER("connections/count_outbound_connections", WAY_ARG, 0),
	PROPERTY_DIR("process"),
	VIRTUAL_NUMBER("process/pid", WAY_PID, 0),
	VIRTUAL_TEXT("process/pidfile", 128, WAY_EMPTY),
};

#define TIMEOUT(text, which) \
	VIRTUAL(text, UNSIGNED, STATIC, BOTH, offsetof(struct native, which), WAY_TIMEOUT)
/* Of masters and servers that this bus has not: a client reads what it wrote, without effect. */
#define IDLE(text, which) TIMEOUT(text, idle_ns[which])
#define FLAG(text, which) \
	VIRTUAL(text, YESNO, STATIC, BOTH, offsetof(struct native, which), WAY_FLAG)
#define SCALE(text, bytes, which) \
	PROPERTY(text, ASCII, STATIC, BOTH, .offline = true, .size = (bytes), .arg = (which), \
	         .how = WAY_SCALE)

static const struct property settings[] = {
	PROPERTY_DIR("alias"),
	VIRTUAL_TEXT("alias/list", UINT16_MAX, WAY_ALIASES),
	FLAG("alias/unaliased", unaliased),
	PROPERTY_DIR("timeout"),
	IDLE("timeout/directory", DIRECTORY),
	IDLE("timeout/ftp", FTP),
	IDLE("timeout/ha7", HA7),
	IDLE("timeout/network", NETWORK),
	TIMEOUT("timeout/presence", presence_ns),
	IDLE("timeout/serial", SERIAL),
	IDLE("timeout/server", SERVER),
	TIMEOUT("timeout/stable", stable_ns),
	FLAG("timeout/uncached", uncached),
	IDLE("timeout/usb", USB),
	TIMEOUT("timeout/volatile", volatile_ns),
	IDLE("timeout/w1", W1),
	PROPERTY_DIR("units"),
	SCALE("units/pressure_scale", 12, 1),
	SCALE("units/temperature_scale", 1, 0),
};

static const struct property statistics[] = {
	PROPERTY_DIR("errors"),
	/* owserver's names, which openHAB asks for: of checksums of 16 bits too */
	COUNT("errors/CRC8_errors", CHECKSUMS),
	COUNT("errors/CRC8_tries", TRANSACTIONS),
	COUNT("errors/checksum", CHECKSUMS),
	COUNT("errors/link", LINK_ERRORS),
	COUNT("errors/shorts", SHORTS),
	PROPERTY_DIR("read"),
	COUNT("read/cachesuccess", CACHE_HITS),
	COUNT("read/calls", READS),
	PROPERTY_DIR("write"),
	COUNT("write/calls", WRITES),
};

#define TABLE(rows) \
	{ \
		.is_virtual = true, HOW(how), PROPERTIES(rows) \
	}
static const struct {
	const char *name;
	struct family family;
} tables[] = {
	{"interface", TABLE(interface)},
	{"settings", TABLE(settings)},
	{"simultaneous", TABLE(simultaneous)},
	{"statistics", TABLE(statistics)},
	{"system", TABLE(systems)},
};

const struct family *virtual_family(const char *name, size_t len)
{
	for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++)
		if (strlen(tables[i].name) == len && strncasecmp(tables[i].name, name, len) == 0)
			return &tables[i].family;
	return NULL;
}

/* --- /structure: what properties a family has, as owserver states them ----------------------- */

const struct family *structure_family(const char *path, size_t len, size_t *used)
{
	const struct family *family;
	char code[3];

	*used = 2;
	if (len < 2 || (len > 2 && path[2] != '/'))
		return NULL;
	for (unsigned n = 0; (family = family_nth(n)); n++) {
		snprintf(code, sizeof(code), "%02X", family->code);
		if (strncasecmp(code, path, 2) == 0)
			return family;
	}
	return NULL;
}

static unsigned whole_size(const struct property *property, int extension)
{
	unsigned size = property_size(property), count = property->array.count;

	if (extension == EXTENSION_BYTE)
		return 12;
	if (extension != EXTENSION_ALL)
		return size;
	return property->type == PROPERTY_BINARY ? size * count : size * count + count - 1;
}

/* As owserver counts them where they cannot be counted, too. */
static int elements(const struct property *property)
{
	if (property->array.index == INDEX_NONE)
		return 1;
	if (property->array.count == 0)
		return property->array.index == INDEX_LETTERS ? -1 : 0;
	return property->array.count;
}

int structure_print(const struct property *property, int extension, char *text, size_t room)
{
	static const char *const access[] = {"oo", "ro", "wo", "rw"};
	char type = property->type == PROPERTY_BITS ? 'y' : (char)property->type;
	int n = snprintf(text, room, "%c,%.6d,%.6d,%s,%.6u,%c,", type,
	                 extension == EXTENSION_NONE   ? 0
	                 : extension == EXTENSION_WORD ? 0
	                 : extension < 0               ? extension
	                                               : extension_element(extension),
	                 elements(property), access[property->access & 3],
	                 whole_size(property, extension), property->life);
	return n < 0 || (size_t)n >= room ? -EMSGSIZE : n;
}
