/* SPDX-License-Identifier: MIT */
/*
 * DS1825, MAX31826, MAX31850 and MAX31851 have one family code. The scratchpad tells them apart:
 * only of a DS1825 the configuration byte begins with 0, and the MAX31826 has neither limits nor a
 * cold junction (bytes 2 and 3 are all ones).
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/thermometer.h"

#define CHIP note[0]
enum { UNKNOWN, DS1825, MAX31826, MAX31850 };

#define FAULT_ANY 1

static int scratchpad(struct txn *txn, uint8_t bytes[9])
{
	int err = thermometer_scratchpad(txn, bytes);

	if (err)
		return err;
	if (!(bytes[SP_CONFIG] & 0x80))
		txn->device->CHIP = DS1825;
	else if (bytes[SP_HIGH] == 0xff && bytes[SP_LOW] == 0xff)
		txn->device->CHIP = MAX31826;
	else
		txn->device->CHIP = MAX31850;
	/* Those have one resolution. */
	if (txn->device->CHIP != DS1825) {
		txn->device->ignores = txn->device->only_12 = true;
		txn->device->resolution = 12;
		txn->device->stored = 12;
	}
	/* which chip it is may not have been known when this was asked for */
	return txn->property->visible && !txn->property->visible(txn->device) ? -ENOENT : 0;
}

/* 0: it is known which chip this is; TXN_MORE it is now, -ENOENT it has no such property. */
static int identify(struct txn *txn)
{
	uint8_t bytes[9];
	int err;

	if (txn->device->CHIP != UNKNOWN)
		return 0;
	err = scratchpad(txn, bytes);
	return err ? err : TXN_MORE;
}

static bool is_known(const struct device *device)
{
	return device->CHIP != UNKNOWN;
}

static bool is_ds1825(const struct device *device)
{
	return device->CHIP == UNKNOWN || device->CHIP == DS1825;
}

static bool is_max31826(const struct device *device)
{
	return device->CHIP == MAX31826;
}

static bool is_max31850(const struct device *device)
{
	return device->CHIP == MAX31850;
}

static const char *type_of(const struct device *device)
{
	static const char *const types[] = {"DS1825", "DS1825", "MAX31826", "MAX31850"};

	return types[device->CHIP];
}

/* The MAX31850's own temperature is the cold junction's, in the upper 12 bits of bytes 2 and 3. */
static int read_temperature(struct txn *txn)
{
	uint8_t bytes[9];
	int err = identify(txn);

	if (err)
		return err;
	if (txn->device->CHIP != MAX31850)
		return thermometer_read_temperature(txn);
	err = scratchpad(txn, bytes);
	txn->number[0] = ((int16_t)(bytes[2] | bytes[3] << 8) >> 4) / 16.0;
	return err;
}

/* Open or short it has no temperature, whatever the bits above say. */
static int read_thermocouple(struct txn *txn)
{
	uint8_t bytes[9];
	int err = scratchpad(txn, bytes);

	if (err)
		return err;
	txn->number[0] = ((int16_t)(bytes[0] | bytes[1] << 8) >> 2) / 4.0;
	return bytes[0] & FAULT_ANY ? -EIO : 0;
}

static int read_limit(struct txn *txn)
{
	int err = identify(txn);

	return err ? err : thermometer_read_limit(txn);
}

static int write_limit(struct txn *txn)
{
	int err = identify(txn);

	return err ? err : thermometer_write_limit(txn);
}

/* arg: byte and bit. */
static int read_fault(struct txn *txn)
{
	uint8_t bytes[9];
	int err = scratchpad(txn, bytes);

	txn->number[0] = (bytes[txn->property->arg >> 8] & txn->property->arg & 0xff) != 0;
	return err;
}

static int read_flags(struct txn *txn)
{
	uint8_t bytes[9];
	int err = scratchpad(txn, bytes);

	txn->number[0] = (bytes[0] & 1) << 3 | (bytes[2] & 7);
	return err;
}

static int read_location(struct txn *txn)
{
	uint8_t bytes[9];
	int err = scratchpad(txn, bytes);

	txn->number[0] = bytes[SP_CONFIG] & 0x0f;
	return err;
}

static const struct area memory = {
	.name = "memory",
	.size = 128,
	.address_bytes = 1,
	.read = 0xf0,
	.block = 8,
	.begin = identify,
	.row = 8,
	.write = 0x0f,
	.verify = 0xaa,
	.copy = 0x55,
	.key = 0xa5,
	.strong = true,
	.copy_ns = 25 * TXN_MS,
};

/* clang-format off */
#define TEMPERATURE(text, resolution, when)                                               \
	{.name = (text), .type = PROPERTY_TEMPERATURE, .life = LIFE_VOLATILE,               \
	 .access = ACCESS_READ, .convert = (resolution), .visible = (when),                 \
	 .read = read_temperature}
#define FAULT(text, byte, bit)                                                            \
	{.name = (text), .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, .access = ACCESS_READ, \
	 .arg = (byte) << 8 | (bit), .convert = CONVERT_TEMPRES, .visible = is_max31850,    \
	 .read = read_fault}
#define LIMIT(text, where)                                                                \
	{.name = (text), .type = PROPERTY_TEMPERATURE, .life = LIFE_STABLE,                 \
	 .access = ACCESS_BOTH, .arg = (where), .visible = is_ds1825,                       \
	 .read = read_limit, .write = write_limit}

static const struct property properties[] = {
	TEMPERATURE("fasttemp", 9, is_ds1825),
	FAULT("fault", 0, FAULT_ANY),
	{.name = "flagfield", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = read_flags},
	FAULT("ground_short", 2, 2),
	TEMPERATURE("latesttemp", 0, NULL),
	{.name = "memory", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE, .access = ACCESS_BOTH,
	 .size = 128, .visible = is_max31826, FIELD(memory)},
	FAULT("open_circuit", 2, 1),
	{.name = "pages", .type = PROPERTY_DIRECTORY, .life = LIFE_STATIC, .visible = is_max31826},
	{.name = "pages/page", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,
	 .access = ACCESS_BOTH, .array = {16, INDEX_NUMBERS, false}, .size = 8,
	 .visible = is_max31826, FIELD(memory)},
	THERMOMETER_POWER,
	{.name = "prog_addr", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE, .access = ACCESS_READ,
	 .read = read_location},
	THERMOMETER_SCRATCHPAD,
	TEMPERATURE("temperature", CONVERT_TEMPRES, NULL),
	TEMPERATURE("temperature10", 10, is_ds1825),
	TEMPERATURE("temperature11", 11, is_ds1825),
	TEMPERATURE("temperature12", 12, NULL),
	TEMPERATURE("temperature9", 9, is_ds1825),
	LIMIT("temphigh", SP_HIGH),
	LIMIT("templow", SP_LOW),
	THERMOMETER_TEMPRES,
	{.name = "thermocouple", .type = PROPERTY_TEMPERATURE, .life = LIFE_VOLATILE,
	 .access = ACCESS_READ, .convert = CONVERT_TEMPRES, .visible = is_max31850,
	 .read = read_thermocouple},
	FAULT("vdd_short", 2, 4),
};
/* clang-format on */

const struct family family_3b = {
	.code = 0x3b,
	.thermometer = true,
	.alarms = true,
	.type = "DS1825",
	.type_of = type_of,
	.is_known = is_known,
	PROPERTIES(properties),
};
