/* SPDX-License-Identifier: MIT */
/*
 * DS1825, MAX31826, MAX31850 and MAX31851 have one family code. The scratchpad tells them apart:
 * only of a DS1825 the configuration byte begins with 0, and the MAX31826 has neither limits nor a
 * cold junction (bytes 2 and 3 are all ones).
 */
#include <errno.h>

#include "hal/chips/thermometer.h"

enum { UNKNOWN, DS1825, MAX31826, MAX31850 }; /* thermometer.kind */

#define FAULT_ANY 1

static bool is_known(const struct device *device)
{
	return thermometer_of(device)->kind != UNKNOWN;
}

/* Which chip it is may have become known since this property was asked for: -ENOENT. */
static int refuse_absent(struct txn *txn)
{
	const struct property *property = txn->property;

	return is_known(txn->device) && property->visible && !property->visible(txn->device)
	               ? -ENOENT
	               : 0;
}

static int saw_scratchpad(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	struct thermometer *chip = txn->device->own;
	int err = thermometer_saw(txn, at, bytes, n);

	if (err)
		return err;
	if (!(bytes[SP_CONFIG] & 0x80))
		chip->kind = DS1825;
	else if (bytes[SP_HIGH] == 0xff && bytes[SP_LOW] == 0xff)
		chip->kind = MAX31826;
	else
		chip->kind = MAX31850;
	/* Those have one resolution. */
	if (chip->kind != DS1825) {
		chip->ignores = chip->only_12 = true;
		chip->resolution = 12;
		chip->stored = 12;
	}
	return refuse_absent(txn);
}

static const struct area scratchpad = {
	.name = "scratchpad",
	.size = 9,
	.block = 9,
	.read = 0xbe,
	.check = AREA_CRC8,
	.begin = refuse_absent,
	.saw = saw_scratchpad,
};

static int now(struct txn *txn, uint8_t bytes[9])
{
	int err = area_fetch(txn, &scratchpad, 0, bytes, 9);

	return err ? err : saw_scratchpad(txn, 0, bytes, 9);
}

/* 0: it is known which chip this is; TXN_MORE it is now, -ENOENT it has no such property. */
static int identify(struct txn *txn)
{
	uint8_t bytes[9];
	int err;

	if (is_known(txn->device))
		return refuse_absent(txn);
	err = now(txn, bytes);
	return err ? err : TXN_MORE;
}

static bool is_ds1825(const struct device *device)
{
	return !is_known(device) || thermometer_of(device)->kind == DS1825;
}

static bool is_max31826(const struct device *device)
{
	return thermometer_of(device)->kind == MAX31826;
}

static bool is_max31850(const struct device *device)
{
	return thermometer_of(device)->kind == MAX31850;
}

static const char *type_of(const struct device *device)
{
	static const char *const types[] = {"DS1825", "DS1825", "MAX31826", "MAX31850"};

	return types[thermometer_of(device)->kind];
}

/* The MAX31850's own temperature is the cold junction's, in the upper 12 bits of bytes 2 and 3. */
static int read_temperature(struct txn *txn)
{
	uint8_t bytes[9];
	int err = identify(txn);

	if (err)
		return err;
	if (!is_max31850(txn->device))
		return thermometer_read_temperature(txn);
	err = now(txn, bytes);
	txn->number[0] = ((int16_t)(bytes[2] | bytes[3] << 8) >> 4) / 16.0;
	return err;
}

/* Open or short it has no temperature, whatever the bits above say. */
static int read_thermocouple(struct txn *txn)
{
	uint8_t bytes[9];
	int err = now(txn, bytes);

	if (err)
		return err;
	txn->number[0] = ((int16_t)(bytes[0] | bytes[1] << 8) >> 2) / 4.0;
	return bytes[0] & FAULT_ANY ? -EIO : 0;
}

static int write_limit(struct txn *txn)
{
	int err = identify(txn);

	return err ? err : thermometer_write_limit(txn);
}

/* arg: byte and bit; of a conversion, so it is read anew. */
static int read_fault(struct txn *txn)
{
	uint8_t bytes[9];
	int err = now(txn, bytes);

	txn->number[0] = (bytes[txn->property->arg >> 8] & txn->property->arg & 0xff) != 0;
	return err;
}

static int read_flags(struct txn *txn)
{
	uint8_t bytes[9];
	int err = area_read(txn, &scratchpad, 0, bytes, 9);

	txn->number[0] = (bytes[0] & 1) << 3 | (bytes[2] & 7);
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

#define TEMPERATURE(text, resolution, when) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .convert = (resolution), .visible = (when), \
	         .read = read_temperature)
#define FAULT(text, byte, bit) \
	PROPERTY(text, YESNO, VOLATILE, READ, .arg = (byte) << 8 | (bit), \
	         .convert = CONVERT_TEMPRES, .visible = is_max31850, .read = read_fault)
#define LIMIT(text, where) \
	PROPERTY(text, TEMPERATURE, STABLE, BOTH, .visible = is_ds1825, \
	         FIELD(scratchpad, .at = (where), .is_signed = true), .write = write_limit)

static const struct property properties[] = {
	TEMPERATURE("fasttemp", 9, is_ds1825),
	FAULT("fault", 0, FAULT_ANY),
	PROPERTY("flagfield", UNSIGNED, VOLATILE, READ, .hidden = true, .read = read_flags),
	FAULT("ground_short", 2, 2),
	TEMPERATURE("latesttemp", 0, NULL),
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = 128, .visible = is_max31826,
                 FIELD(memory)),
	FAULT("open_circuit", 2, 1),
	PROPERTY("pages", DIRECTORY, STATIC, NONE, .visible = is_max31826),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(16, NUMBERS), .size = 8,
                 .visible = is_max31826, FIELD(memory)),
	THERMOMETER_POWER,
	PROPERTY("prog_addr", UNSIGNED, STABLE, READ,
                 FIELD(scratchpad, .at = SP_CONFIG, .bits = 4)),
	THERMOMETER_SCRATCHPAD,
	TEMPERATURE("temperature", CONVERT_TEMPRES, NULL),
	TEMPERATURE("temperature10", 10, is_ds1825),
	TEMPERATURE("temperature11", 11, is_ds1825),
	TEMPERATURE("temperature12", 12, NULL),
	TEMPERATURE("temperature9", 9, is_ds1825),
	LIMIT("temphigh", SP_HIGH),
	LIMIT("templow", SP_LOW),
	THERMOMETER_TEMPRES,
	PROPERTY("thermocouple", TEMPERATURE, VOLATILE, READ, .convert = CONVERT_TEMPRES,
                 .visible = is_max31850, .read = read_thermocouple),
	FAULT("vdd_short", 2, 4),
};

const struct family family_3b = {
	.code = 0x3b,
	.type = "DS1825",
	.type_of = type_of,
	.is_known = is_known,
	THERMOMETER_FAMILY,
	PROPERTIES(properties),
};
