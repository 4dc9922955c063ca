/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device: their names, and what stands behind them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/native/native.h"

static int put(struct txn *txn, const char *text)
{
	size_t len = strlen(text);

	if (len > txn->room)
		return -EMSGSIZE;
	memcpy(txn->data, text, len);
	txn->len = len;
	return 0;
}

static int read_count(struct txn *txn)
{
	txn->number[0] = (double)(uint32_t)txn->native->count[txn->property->arg];
	return 0;
}

static int read_zero(struct txn *txn)
{
	txn->number[0] = 0;
	return 0;
}

static int read_cache(struct txn *txn)
{
	const struct cache *cache = &txn->native->cache;
	const uint64_t values[] = {cache->tries, cache->hits, cache->added};

	txn->number[0] = (double)(uint32_t)values[txn->property->arg];
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
	return put(txn, OWSD_VERSION);
}

static int read_empty(struct txn *txn)
{
	txn->len = 0;
	return 0;
}

static int read_scale(struct txn *txn)
{
	char text[2] = {txn->native->temperature_scale, '\0'};

	return put(txn, txn->property->arg ? txn->native->pressure_scale : text);
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

static int64_t *timeout_of(struct txn *txn)
{
	return txn->property->arg ? &txn->native->stable_ns : &txn->native->volatile_ns;
}

static int read_timeout(struct txn *txn)
{
	txn->number[0] = (double)(*timeout_of(txn) / NATIVE_S);
	return 0;
}

static int write_timeout(struct txn *txn)
{
	if (txn->number[0] > 1e6)
		return -EINVAL;
	*timeout_of(txn) = (int64_t)txn->number[0] * NATIVE_S;
	return 0;
}

static int read_simultaneous(struct txn *txn)
{
	const struct native *native = txn->native;
	int64_t end = native->channels ? native->channel[txn->channel].simultaneous_ns : 0;

	txn->number[0] = end && native_now(native) < end + native->volatile_ns;
	return 0;
}

static int read_name(struct txn *txn)
{
	return put(txn, txn->link ? txn->link->ops->name : "");
}

static int read_address(struct txn *txn)
{
	return put(txn, txn->native->bus.ops->scheme);
}

static int read_elapsed(struct txn *txn)
{
	txn->number[0] = (double)((native_now(txn->native) - txn->native->up_ns) / NATIVE_S);
	return 0;
}

static int read_bus_time(struct txn *txn)
{
	struct link_cost cost = {0};

	if (txn->link && txn->link->ops->cost)
		txn->link->ops->cost(txn->link, &cost);
	txn->number[0] = txn->property->arg ? (double)(uint32_t)cost.resets
	                                    : (double)cost.wire_ns / 1e9;
	return 0;
}

static int read_channel(struct txn *txn)
{
	const struct channel *channel = &txn->native->channel[txn->channel];

	txn->number[0] = (double)(uint32_t)(txn->property->arg ? channel->shorts : channel->errors);
	return 0;
}

#define NUMBER(text, function, what)                                                      \
	{.name = (text), .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE,                 \
	 .access = ACCESS_READ, .offline = true, .arg = (what), .read = (function)}
#define TEXT(text, bytes, function)                                                       \
	{.name = (text), .type = PROPERTY_ASCII, .life = LIFE_STATIC, .access = ACCESS_READ, \
	 .offline = true, .size = (bytes), .read = (function)}

static const struct property interface[] = {
	PROPERTY_DIR("settings"),
	TEXT("settings/address", 512, read_address),
	TEXT("settings/name", 128, read_name),
	NUMBER("settings/version", read_zero, 0),
	PROPERTY_DIR("statistics"),
	{.name = "statistics/bus_time", .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE,
	 .access = ACCESS_READ, .offline = true, .read = read_bus_time},
	NUMBER("statistics/elapsed_time", read_elapsed, 0),
	NUMBER("statistics/errors", read_channel, 0),
	NUMBER("statistics/reconnects", read_count, COUNT_REOPENS),
	NUMBER("statistics/resets", read_bus_time, 1),
	NUMBER("statistics/shorts", read_channel, 1),
	NUMBER("statistics/timeouts", read_count, COUNT_CHIP_RESETS),
};

static const struct property settings[] = {
	PROPERTY_DIR("timeout"),
	{.name = "timeout/stable", .type = PROPERTY_UNSIGNED, .life = LIFE_STATIC,
	 .access = ACCESS_BOTH, .offline = true, .arg = 1, .read = read_timeout,
	 .write = write_timeout},
	{.name = "timeout/volatile", .type = PROPERTY_UNSIGNED, .life = LIFE_STATIC,
	 .access = ACCESS_BOTH, .offline = true, .read = read_timeout, .write = write_timeout},
	PROPERTY_DIR("units"),
	{.name = "units/pressure_scale", .type = PROPERTY_ASCII, .life = LIFE_STATIC,
	 .access = ACCESS_BOTH, .offline = true, .size = 12, .arg = 1, .read = read_scale,
	 .write = write_scale},
	{.name = "units/temperature_scale", .type = PROPERTY_ASCII, .life = LIFE_STATIC,
	 .access = ACCESS_BOTH, .offline = true, .size = 1, .read = read_scale,
	 .write = write_scale},
};

static const struct property simultaneous[] = {
	{.name = "temperature", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE,
	 .access = ACCESS_BOTH, .offline = true, .convert = CONVERT_TEMPRES,
	 .read = read_simultaneous},
};

static const struct property statistics[] = {
	PROPERTY_DIR("cache"),
	PROPERTY_DIR("cache/internal"),
	NUMBER("cache/internal/added", read_cache, 2),
	NUMBER("cache/internal/hits", read_cache, 1),
	NUMBER("cache/internal/tries", read_cache, 0),
	PROPERTY_DIR("directory"),
	PROPERTY_DIR("directory/bus"),
	NUMBER("directory/bus/calls", read_count, COUNT_DIRECTORIES),
	PROPERTY_DIR("errors"),
	NUMBER("errors/checksum", read_count, COUNT_CHECKSUMS),
	NUMBER("errors/link", read_count, COUNT_LINK_ERRORS),
	NUMBER("errors/shorts", read_count, COUNT_SHORTS),
	PROPERTY_DIR("read"),
	NUMBER("read/cachesuccess", read_count, COUNT_CACHE_HITS),
	NUMBER("read/calls", read_count, COUNT_READS),
	PROPERTY_DIR("write"),
	NUMBER("write/calls", read_count, COUNT_WRITES),
};

static const struct property systems[] = {
	PROPERTY_DIR("configuration"),
	TEXT("configuration/version", 20, read_version),
	PROPERTY_DIR("connections"),
	NUMBER("connections/count_current_buses", read_buses, 0),
	NUMBER("connections/count_outbound_connections", read_zero, 0),
	PROPERTY_DIR("process"),
	NUMBER("process/pid", read_pid, 0),
	TEXT("process/pidfile", 128, read_empty),
};

static const struct {
	const char *name;
	struct family family;
} tables[] = {
	{"interface", {.is_virtual = true, PROPERTIES(interface)}},
	{"settings", {.is_virtual = true, PROPERTIES(settings)}},
	{"simultaneous", {.is_virtual = true, PROPERTIES(simultaneous)}},
	{"statistics", {.is_virtual = true, PROPERTIES(statistics)}},
	{"system", {.is_virtual = true, PROPERTIES(systems)}},
};

const struct family *virtual_family(const char *name, size_t len)
{
	for (size_t i = 0; i < sizeof(tables) / sizeof(tables[0]); i++)
		if (strlen(tables[i].name) == len && memcmp(tables[i].name, name, len) == 0)
			return &tables[i].family;
	return NULL;
}
