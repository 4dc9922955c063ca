/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device: simultaneous, interface, system. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
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
	int64_t seconds = (native_now(txn->native) - txn->native->up_ns) / NATIVE_S;

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

/* The ways in which all three tables answer: index of how[]. */
enum {
	WAY_ADDRESS = 1,
	WAY_ARG,
	WAY_NAME,
	WAY_COST,
	WAY_ELAPSED,
	WAY_CHANNEL,
	WAY_COUNT,
	WAY_SIMULTANEOUS,
	WAY_PRESENT,
	WAY_SINGLE,
	WAY_NOTHING,
	WAY_VERSION,
	WAY_BUSES,
	WAY_PID,
	WAY_EMPTY,
};
static const struct property_how how[] = {
	[WAY_ADDRESS] = {.read = read_address},
	[WAY_ARG] = {.read = virtual_arg},
	[WAY_NAME] = {.read = read_name},
	[WAY_COST] = {.read = read_cost},
	[WAY_ELAPSED] = {.read = read_elapsed},
	[WAY_CHANNEL] = {.read = read_channel},
	[WAY_COUNT] = {.read = virtual_count},
	[WAY_SIMULTANEOUS] = {.read = read_simultaneous},
	[WAY_PRESENT] = {.read = read_present},
	[WAY_SINGLE] = {.read = read_single},
	[WAY_NOTHING] = {.read = virtual_arg, .write = write_nothing},
	[WAY_VERSION] = {.read = read_version},
	[WAY_BUSES] = {.read = read_buses},
	[WAY_PID] = {.read = read_pid},
	[WAY_EMPTY] = {.read = read_empty},
};

#define CHANNEL(text, member) VIRTUAL_NUMBER(text, WAY_CHANNEL, offsetof(struct channel, member))

static const struct property interface[] = {
	PROPERTY_DIR("settings"),
	VIRTUAL_TEXT("settings/address", 512, WAY_ADDRESS),
	VIRTUAL("settings/ds2404_found", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, WAY_ARG),
	VIRTUAL_TEXT("settings/name", 128, WAY_NAME),
	VIRTUAL("settings/overdrive", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, WAY_ARG),
	VIRTUAL("settings/version", PROPERTY_UNSIGNED, LIFE_STATIC, ACCESS_READ, 0, WAY_ARG),
	PROPERTY_DIR("statistics"),
	VIRTUAL("statistics/bus_time", PROPERTY_FLOAT, LIFE_VOLATILE, ACCESS_READ, WIRE_TIME,
                WAY_COST),
	VIRTUAL_NUMBER("statistics/elapsed_time", WAY_ELAPSED, 0),
	CHANNEL("statistics/errors", errors),
	CHANNEL("statistics/locks", transactions),
	PROPERTY_DIR("statistics/overdrive"),
	VIRTUAL_NUMBER("statistics/overdrive/attempts", WAY_ARG, 0),
	VIRTUAL_NUMBER("statistics/overdrive/failures", WAY_ARG, 0),
	CHANNEL("statistics/read_errors", checksums),
	VIRTUAL_NUMBER("statistics/reconnects", WAY_COUNT,
                       offsetof(struct native, count[COUNT_REOPENS])),
	VIRTUAL_NUMBER("statistics/resets", WAY_COST, RESETS),
	CHANNEL("statistics/shorts", shorts),
	VIRTUAL_NUMBER("statistics/timeouts", WAY_COUNT,
                       offsetof(struct native, count[COUNT_CHIP_RESETS])),
	CHANNEL("statistics/unlocks", transactions),
};

#define CONVERTS(text, which) \
	PROPERTY(text, YESNO, VOLATILE, BOTH, .offline = true, .convert = CONVERT_TEMPRES, \
	         .arg = (which), .how = WAY_SIMULTANEOUS)
#define PRESENT(text) PROPERTY(text, YESNO, VOLATILE, READ, .how = WAY_PRESENT)
#define SINGLE(text, command) \
	PROPERTY(text, ASCII, VOLATILE, READ, .size = 18, .arg = (command), .how = WAY_SINGLE)

static const struct property simultaneous[] = {
	VIRTUAL("iblss", PROPERTY_YESNO, LIFE_VOLATILE, ACCESS_BOTH, 0, WAY_NOTHING),
	PRESENT("present"),
	PRESENT("present_ds2400"),
	SINGLE("single", READ_ROM),
	SINGLE("single_ds2400", READ_ROM_DS2400),
	CONVERTS("temperature", SIMULTANEOUS_TEMPERATURE),
	CONVERTS("voltage", SIMULTANEOUS_VOLTAGE),
};

/* What this build can drive. */
#define DRIVES(text, yes) VIRTUAL(text, PROPERTY_INTEGER, LIFE_STATIC, ACCESS_READ, yes, WAY_ARG)

static const struct property systems[] = {
	PROPERTY_DIR("configuration"),
	DRIVES("configuration/DebugInfo", 0),
	DRIVES("configuration/USB", 0),
	DRIVES("configuration/i2c", 1),
	DRIVES("configuration/parport", 0),
	VIRTUAL("configuration/trim", PROPERTY_YESNO, LIFE_STATIC, ACCESS_READ, 0, WAY_ARG),
	VIRTUAL_TEXT("configuration/version", 20, WAY_VERSION),
	DRIVES("configuration/zeroconf", 0),
	PROPERTY_DIR("connections"),
	VIRTUAL_NUMBER("connections/count_current_buses", WAY_BUSES, 0),
	VIRTUAL_NUMBER("connections/count_outbound_connections", WAY_ARG, 0),
	PROPERTY_DIR("process"),
	VIRTUAL_NUMBER("process/pid", WAY_PID, 0),
	VIRTUAL_TEXT("process/pidfile", 128, WAY_EMPTY),
};

static const struct family family_interface = {.is_virtual = true, HOW(how), PROPERTIES(interface)};
static const struct family family_simultaneous = {
	.is_virtual = true, HOW(how), PROPERTIES(simultaneous)};
static const struct family family_system = {.is_virtual = true, HOW(how), PROPERTIES(systems)};

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
		if (strlen(tables[i].name) == len && strncasecmp(tables[i].name, name, len) == 0)
			return tables[i].family;
	return NULL;
}
