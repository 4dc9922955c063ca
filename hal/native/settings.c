/* SPDX-License-Identifier: MIT */
/* /settings: what can be changed while the bus runs. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "hal/native/limits.h"
#include "hal/native/settings.h"
#include "hal/native/state.h"
#include "hal/native/virtual.h"

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

/* arg: where it stands in struct native. */
static void *member_of(struct txn *txn)
{
	return (char *)txn->native + txn->property->arg;
}

static int read_timeout(struct txn *txn)
{
	int64_t seconds = *(int64_t *)member_of(txn) / NATIVE_S;

	txn->number[0] = (double)seconds;
	return 0;
}

static int write_timeout(struct txn *txn)
{
	if (txn->number[0] > 1e6)
		return -EINVAL;
	*(int64_t *)member_of(txn) = (int64_t)txn->number[0] * NATIVE_S;
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
		native->idle_ns[i] = seconds[i] * NATIVE_S;
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

enum { WAY_SCALE = 1, WAY_TIMEOUT, WAY_FLAG, WAY_ALIASES };
static const struct property_how how[] = {
	[WAY_SCALE] = {.read = read_scale, .write = write_scale},
	[WAY_TIMEOUT] = {.read = read_timeout, .write = write_timeout},
	[WAY_FLAG] = {.read = read_flag, .write = write_flag},
	[WAY_ALIASES] = {.read = read_aliases},
};

#define TIMEOUT(text, which) \
	VIRTUAL(text, PROPERTY_UNSIGNED, LIFE_STATIC, ACCESS_BOTH, offsetof(struct native, which), \
	        WAY_TIMEOUT)
/* Of masters and servers that this bus has not: a client reads what it wrote, without effect. */
#define IDLE(text, which) TIMEOUT(text, idle_ns[which])
#define FLAG(text, which) \
	VIRTUAL(text, PROPERTY_YESNO, LIFE_STATIC, ACCESS_BOTH, offsetof(struct native, which), \
	        WAY_FLAG)
#define SCALE(text, bytes, which) \
	PROPERTY(text, ASCII, STATIC, BOTH, .offline = true, .size = (bytes), .arg = (which), \
	         .how = WAY_SCALE)

static const struct property properties[] = {
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

const struct family virtual_settings = {.is_virtual = true, HOW(how), PROPERTIES(properties)};
