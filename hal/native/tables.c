/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device: simultaneous, interface, system. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/native/limits.h"
#include "hal/native/settings.h"
#include "hal/native/state.h"
#include "hal/native/statistics.h"
#include "hal/native/tables.h"
#include "hal/native/virtual.h"
#include "hal/owfs/path.h"
#include "hal/wire/crc.h"

#define READ_ROM 0x33
#define READ_ROM_DS2400 0x0f

/* For devices that this bus does not know, whatever is there. */
static int write_nothing(struct txn *txn)
{
	(void)txn;
	return 0;
}

static int read_arg(struct txn *txn)
{
	txn->number[0] = txn->property->arg;
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
	return virtual_put(txn, OWSD_VERSION);
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
	return virtual_put(txn, name);
}

static int read_name(struct txn *txn)
{
	char name[64];

	/* By this word a client of an owserver learns that nothing behind it is real. */
	snprintf(name, sizeof(name), "%s%s",
	         txn->native->master->ops->simulated ? "Simulated-" : "",
	         txn->link ? txn->link->ops->name : "");
	return virtual_put(txn, name);
}

static int read_address(struct txn *txn)
{
	return virtual_put(txn, txn->native->where);
}

static int read_elapsed(struct txn *txn)
{
	int64_t seconds = (native_now(txn->native) - txn->native->up_ns) / NATIVE_S;

	txn->number[0] = (double)seconds;
	return 0;
}

enum { WIRE_TIME, RESETS };

static int read_cost(struct txn *txn)
{
	struct link_cost cost = {0};

	if (txn->link && txn->link->ops->cost)
		txn->link->ops->cost(txn->link, &cost);
	if (txn->property->arg == RESETS)
		return virtual_count(txn, cost.resets);
	txn->number[0] = (double)cost.wire_ns / 1e9;
	return 0;
}

enum { ERRORS, SHORTS, CHECKSUMS, TRANSACTIONS };

static int read_channel(struct txn *txn)
{
	const struct channel *channel = &txn->native->channel[txn->channel];
	const uint64_t values[] = {
		[ERRORS] = channel->errors,
		[SHORTS] = channel->shorts,
		[CHECKSUMS] = channel->checksums,
		[TRANSACTIONS] = channel->transactions,
	};

	return virtual_count(txn, values[txn->property->arg]);
}

/* Of the master, which all its channels share. */
static int read_count(struct txn *txn)
{
	return virtual_count(txn, txn->native->count[txn->property->arg]);
}

static const struct property interface[] = {
	PROPERTY_DIR("settings"),
	VIRTUAL_TEXT("settings/address", 512, read_address),
	VIRTUAL("settings/ds2404_found", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, virtual_zero,
                NULL),
	VIRTUAL_TEXT("settings/name", 128, read_name),
	VIRTUAL("settings/overdrive", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, virtual_zero,
                NULL),
	VIRTUAL("settings/version", PROPERTY_UNSIGNED, LIFE_STATIC, ACCESS_READ, 0, virtual_zero,
                NULL),
	PROPERTY_DIR("statistics"),
	VIRTUAL("statistics/bus_time", PROPERTY_FLOAT, LIFE_VOLATILE, ACCESS_READ, WIRE_TIME,
                read_cost, NULL),
	VIRTUAL_NUMBER("statistics/elapsed_time", read_elapsed, 0),
	VIRTUAL_NUMBER("statistics/errors", read_channel, ERRORS),
	VIRTUAL_NUMBER("statistics/locks", read_channel, TRANSACTIONS),
	PROPERTY_DIR("statistics/overdrive"),
	VIRTUAL_NUMBER("statistics/overdrive/attempts", virtual_zero, 0),
	VIRTUAL_NUMBER("statistics/overdrive/failures", virtual_zero, 0),
	VIRTUAL_NUMBER("statistics/read_errors", read_channel, CHECKSUMS),
	VIRTUAL_NUMBER("statistics/reconnects", read_count, COUNT_REOPENS),
	VIRTUAL_NUMBER("statistics/resets", read_cost, RESETS),
	VIRTUAL_NUMBER("statistics/shorts", read_channel, SHORTS),
	VIRTUAL_NUMBER("statistics/timeouts", read_count, COUNT_CHIP_RESETS),
	VIRTUAL_NUMBER("statistics/unlocks", read_channel, TRANSACTIONS),
};

#define CONVERTS(text, which) \
	{ \
		.name = (text), .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, \
		.access = ACCESS_BOTH, .offline = true, .convert = CONVERT_TEMPRES, \
		.arg = (which), .read = read_simultaneous \
	}
#define PRESENT(text) \
	{ \
		.name = (text), .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, \
		.access = ACCESS_READ, .read = read_present \
	}
#define SINGLE(text, command) \
	{ \
		.name = (text), .type = PROPERTY_ASCII, .life = LIFE_VOLATILE, \
		.access = ACCESS_READ, .size = 18, .arg = (command), .read = read_single \
	}

static const struct property simultaneous[] = {
	VIRTUAL("iblss", PROPERTY_YESNO, LIFE_VOLATILE, ACCESS_BOTH, 0, virtual_zero,
                write_nothing),
	PRESENT("present"),
	PRESENT("present_ds2400"),
	SINGLE("single", READ_ROM),
	SINGLE("single_ds2400", READ_ROM_DS2400),
	CONVERTS("temperature", SIMULTANEOUS_TEMPERATURE),
	CONVERTS("voltage", SIMULTANEOUS_VOLTAGE),
};

/* What this build can drive. */
#define DRIVES(text, yes) \
	VIRTUAL(text, PROPERTY_INTEGER, LIFE_STATIC, ACCESS_READ, yes, read_arg, NULL)

static const struct property systems[] = {
	PROPERTY_DIR("configuration"),
	DRIVES("configuration/DebugInfo", 0),
	DRIVES("configuration/USB", 0),
	DRIVES("configuration/i2c", 1),
	DRIVES("configuration/parport", 0),
	VIRTUAL("configuration/trim", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, read_arg, NULL),
	VIRTUAL_TEXT("configuration/version", 20, read_version),
	DRIVES("configuration/zeroconf", 0),
	PROPERTY_DIR("connections"),
	VIRTUAL_NUMBER("connections/count_current_buses", read_buses, 0),
	VIRTUAL_NUMBER("connections/count_outbound_connections", virtual_zero, 0),
	PROPERTY_DIR("process"),
	VIRTUAL_NUMBER("process/pid", read_pid, 0),
	VIRTUAL_TEXT("process/pidfile", 128, read_empty),
};

static const struct family family_interface = {.is_virtual = true, PROPERTIES(interface)};
static const struct family family_simultaneous = {.is_virtual = true, PROPERTIES(simultaneous)};
static const struct family family_system = {.is_virtual = true, PROPERTIES(systems)};

static const struct {
	const char *name;
	const struct family *family;
} tables[] = {
	{"interface", &family_interface},
	{"settings", &virtual_settings},
	{"simultaneous", &family_simultaneous},
	{"statistics", &virtual_statistics},
	{"system", &family_system},
};

const struct family *virtual_family(const char *name, size_t len)
{
	for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++)
		if (strlen(tables[i].name) == len && memcmp(tables[i].name, name, len) == 0)
			return tables[i].family;
	return NULL;
}
