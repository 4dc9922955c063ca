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

static unsigned kind_of(const struct device *device)
{
	return thermometer_of(device)->kind;
}

/* Which chip it is may have become known since this property was asked for: -ENOENT. */
static int refuse_absent(struct txn *txn)
{
	bool absent = kind_of(txn->device) && !family_has(txn->device, txn->property);

	return absent ? -ENOENT : 0;
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

	if (kind_of(txn->device) != UNKNOWN)
		return refuse_absent(txn);
	err = now(txn, bytes);
	return err ? err : TXN_MORE;
}

/* The MAX31850's own temperature is the cold junction's, in the upper 12 bits of bytes 2 and 3. */
static int read_temperature(struct txn *txn)
{
	uint8_t bytes[9];
	int err = identify(txn);

	if (err)
		return err;
	if (kind_of(txn->device) != MAX31850)
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

enum { OWN = AFTER_THERMOMETER_AREAS, MEMORY };
static const struct area *const areas[] = {
	THERMOMETER_AREAS, [OWN] = &scratchpad, [MEMORY] = &memory};

enum { WAY_OWN = AFTER_THERMOMETER_WAYS, WAY_OWN_LIMIT, WAY_FAULT, WAY_FLAGS, WAY_THERMOCOUPLE };
static const struct property_how how[] = {
	THERMOMETER_WAYS,
	[WAY_OWN] = {.read = read_temperature},
	[WAY_OWN_LIMIT] = {.write = write_limit},
	[WAY_FAULT] = {.read = read_fault},
	[WAY_FLAGS] = {.read = read_flags},
	[WAY_THERMOCOUPLE] = {.read = read_thermocouple},
};

#define TEMPERATURE(text, resolution, which) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .convert = (resolution), .kinds = (which), \
	         .how = WAY_OWN)
#define FAULT(text, byte, bit) \
	PROPERTY(text, YESNO, VOLATILE, READ, .arg = (byte) << 8 | (bit), \
	         .convert = CONVERT_TEMPRES, .kinds = KIND(MAX31850), .how = WAY_FAULT)
#define LIMIT(text, where) \
	PROPERTY(text, TEMPERATURE, STABLE, BOTH, .kinds = KIND(DS1825), \
	         FIELD(OWN, .at = (where), .is_signed = true), .how = WAY_OWN_LIMIT)

static const struct property properties[] = {
	TEMPERATURE("fasttemp", 9, KIND(DS1825)),
	FAULT("fault", 0, FAULT_ANY),
	PROPERTY("flagfield", UNSIGNED, VOLATILE, READ, .hidden = true, .how = WAY_FLAGS),
	FAULT("ground_short", 2, 2),
	TEMPERATURE("latesttemp", 0, 0),
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = 128, .kinds = KIND(MAX31826),
                 FIELD(MEMORY)),
	FAULT("open_circuit", 2, 1),
	PROPERTY("pages", DIRECTORY, STATIC, NONE, .kinds = KIND(MAX31826)),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(16, NUMBERS), .size = 8,
                 .kinds = KIND(MAX31826), FIELD(MEMORY)),
	THERMOMETER_POWER,
	PROPERTY("prog_addr", UNSIGNED, STABLE, READ, FIELD(OWN, .at = SP_CONFIG, .bits = 4)),
	THERMOMETER_SCRATCHPAD,
	TEMPERATURE("temperature", CONVERT_TEMPRES, 0),
	TEMPERATURE("temperature10", 10, KIND(DS1825)),
	TEMPERATURE("temperature11", 11, KIND(DS1825)),
	TEMPERATURE("temperature12", 12, 0),
	TEMPERATURE("temperature9", 9, KIND(DS1825)),
	LIMIT("temphigh", SP_HIGH),
	LIMIT("templow", SP_LOW),
	THERMOMETER_TEMPRES,
	PROPERTY("thermocouple", TEMPERATURE, VOLATILE, READ, .convert = CONVERT_TEMPRES,
                 .kinds = KIND(MAX31850), .how = WAY_THERMOCOUPLE),
	FAULT("vdd_short", 2, 4),
};

static const char *const types[] = {"DS1825", "DS1825", "MAX31826", "MAX31850"};

const struct family family_3b = {
	.code = 0x3b,
	.type = "DS1825",
	.kind = kind_of,
	.types = types,
	THERMOMETER_FAMILY,
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
