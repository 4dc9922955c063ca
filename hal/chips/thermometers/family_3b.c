/* SPDX-License-Identifier: MIT */
/*
 * DS1825, MAX31825, MAX31826, MAX31850 and MAX31851 have one family code. The scratchpad tells them
 * apart: the last three have ones in bytes 5 to 7 and a configuration (byte 4) that begins with 1,
 * and the MAX31826 has neither limits nor a cold junction (bytes 2 and 3 are all ones). A DS1825
 * has 0..1.... in byte 4 and 10h in byte 7; there a MAX31825 has the high bytes of its limits,
 * which are sixteenths of a degree in 12 bits, and a 0 in bit 3 of its configuration, byte 3.
 *
 * Of the MAX31825 the drivers of its maker are known (Zephyr's max31825.c), and no data sheet: so
 * nothing is written to it. Like each thermometer it is sent Read Power Supply (B4h) before a
 * conversion, but what it answers to that is not documented: `power` is refused. What it holds
 * after a restart is not documented either: a temperature of 0 is good only near another reading.
 * The same holds for a MAX31850 whose thermocouple and cold junction are both 0: so it restarts,
 * and nothing can be written to it as a mark.
 *
 * A disturbed address can make a MAX31826 copy its scratchpad to another page: nothing shows that.
 */
#include <errno.h>
#include <stdlib.h>

#include "hal/chips/family.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"

enum { UNKNOWN, DS1825, MAX31826, MAX31850, MAX31825 }; /* device.kind */

#define FAULT_ANY 1

/* Which chip it is may have become known since this property was asked for: -ENOENT. */
static int refuse_absent(struct txn *txn)
{
	bool absent = txn->device->kind && !family_has(txn->device, txn->property);

	return absent ? -ENOENT : 0;
}

static bool is_sign(uint8_t byte)
{
	return byte >> 4 == 0 || byte >> 4 == 0xf;
}

static uint8_t kind_by(const uint8_t *bytes)
{
	if (bytes[SP_CONFIG] & 0x80 &&
	    (bytes[SP_5] & bytes[SP_REMAIN] & bytes[SP_PER_DEGREE]) == 0xff)
		return bytes[SP_HIGH] == 0xff && bytes[SP_LOW] == 0xff ? MAX31826 : MAX31850;
	if ((bytes[SP_CONFIG] & 0x90) == 0x10 && bytes[SP_PER_DEGREE] == 0x10)
		return DS1825;
	return is_sign(bytes[SP_CONFIG]) && is_sign(bytes[SP_PER_DEGREE]) && !(bytes[SP_LOW] & 8)
	               ? MAX31825
	               : UNKNOWN;
}

/* Another chip than was known has taken its place, or one that is in no data sheet: -EIO. */
static int saw_scratchpad(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	struct thermometer *chip = txn->device->own;
	uint8_t *known = &txn->device->kind, kind = at || n < SP_CRC ? *known : kind_by(bytes);

	if (!kind || (*known && *known != kind)) {
		*chip = (struct thermometer){0};
		*known = UNKNOWN;
		return -EIO;
	}
	*known = kind;
	/* Those have one resolution, or bits in another place that say so. */
	if (kind != DS1825) {
		chip->ignores = chip->only_12 = true;
		chip->resolution = 12;
		chip->stored = 12;
	}
	int err = thermometer_saw(txn, at, bytes, n);
	return err ? err : refuse_absent(txn);
}

static AREA_NAMED(scratchpad, "scratchpad", .size = 9, .block = 9, .read = 0xbe, .check = AREA_CRC8,
                  .begin = refuse_absent, .saw = saw_scratchpad);

static int scratchpad_now(struct txn *txn, uint8_t bytes[9])
{
	int err = area_fetch(txn, &scratchpad, 0, bytes, 9);

	return err ? err : saw_scratchpad(txn, 0, bytes, 9);
}

static int tell_kind(struct txn *txn)
{
	uint8_t bytes[9];

	return scratchpad_now(txn, bytes);
}

/* 0: it is known which chip this is; TXN_MORE it is now, -ENOENT it has no such property. */
static int learn_kind(struct txn *txn)
{
	if (txn->device->kind != UNKNOWN)
		return refuse_absent(txn);
	int err = tell_kind(txn);
	return err ? err : TXN_MORE;
}

#define NEAR_RAW (5 * 16)
#define NEAR_NS (300 * 1000 * TXN_MS)

/*
 * raw: what was measured, of several quantities the one that is farthest from 0, in sixteenths of a
 * degree. A restart leaves 0, which is no measurement unless one near it came not long before.
 */
static int restarted(struct txn *txn, int raw)
{
	struct thermometer *chip = txn->device->own;
	bool old = !chip->raw_ns || txn_ended(txn) - chip->raw_ns >= NEAR_NS;

	if (raw == 0 && (old || chip->raw > NEAR_RAW || chip->raw < -NEAR_RAW))
		return -ERANGE;
	chip->raw = (int16_t)raw;
	return 0;
}

static int thermocouple_raw(const uint8_t bytes[9])
{
	return ((int16_t)(bytes[0] | bytes[1] << 8) >> 2) * 4;
}

static int cold_raw(const uint8_t bytes[9])
{
	return (int16_t)(bytes[2] | bytes[3] << 8) >> 4;
}

/* Of the last conversion, as far as the chip can show that; TXN_MORE: not yet. */
static int converted(struct txn *txn, uint8_t bytes[9])
{
	int err = scratchpad_now(txn, bytes);

	if (!err)
		err = thermometer_ended(txn, bytes, txn_ended(txn));
	if (err || txn->device->kind != MAX31850)
		return err;
	int hot = thermocouple_raw(bytes), cold = cold_raw(bytes);
	/* What an open thermocouple shows is near no temperature, and a restart shows no fault. */
	if (bytes[0] & FAULT_ANY)
		((struct thermometer *)txn->device->own)->raw = INT16_MAX;
	return bytes[0] & FAULT_ANY ? 0 : restarted(txn, abs(hot) > abs(cold) ? hot : cold);
}

static int read_max31825(struct txn *txn)
{
	uint8_t bytes[9];
	int err = converted(txn, bytes), raw = (int16_t)(bytes[0] | bytes[1] << 8);

	if (!err)
		err = restarted(txn, raw);
	if (!err)
		err = thermometer_took(txn, bytes, txn_ended(txn));
	txn->number[0] = raw / 16.0;
	return err;
}

/* The MAX31850's own temperature is the cold junction's, in the upper 12 bits of bytes 2 and 3. */
static int read_temperature(struct txn *txn)
{
	uint8_t bytes[9];
	int err = learn_kind(txn);

	if (err)
		return err;
	if (txn->device->kind == MAX31825)
		return read_max31825(txn);
	if (txn->device->kind != MAX31850)
		return thermometer_read_temperature(txn);
	err = converted(txn, bytes);
	if (err)
		return err;
	txn->number[0] = cold_raw(bytes) / 16.0;
	return thermometer_took(txn, bytes, txn_ended(txn));
}

/* Open or short it has no temperature, whatever the bits above say. */
static int read_thermocouple(struct txn *txn)
{
	uint8_t bytes[9];
	int err = converted(txn, bytes);

	if (err)
		return err;
	if (bytes[0] & FAULT_ANY)
		return -ENODATA;
	txn->number[0] = thermocouple_raw(bytes) / 16.0;
	return thermometer_took(txn, bytes, txn_ended(txn));
}

static int write_limit(struct txn *txn)
{
	int err = learn_kind(txn);

	return err ? err : thermometer_write_limit(txn);
}

/* Four pins; of a MAX31825 six bits, by resistors. */
static int read_address(struct txn *txn)
{
	uint8_t bytes[9];
	int err = area_read(txn, &scratchpad, 0, bytes, 9);

	txn->number[0] = txn->device->kind == MAX31825 ? bytes[SP_HIGH] & 0x3f
	                                               : bytes[SP_CONFIG] & 0xf;
	return err;
}

static int read_power(struct txn *txn)
{
	int err = txn->phase ? 0 : learn_kind(txn);

	if (!err && txn->device->kind == MAX31825)
		return -EOPNOTSUPP;
	return err ? err : thermometer_read_power(txn);
}

static int read_tempres(struct txn *txn)
{
	static const uint8_t resolutions[] = {8, 9, 10, 12};
	uint8_t bytes[9];
	int err = learn_kind(txn);

	if (err || txn->device->kind != MAX31825)
		return err ? err : thermometer_read_tempres(txn);
	err = scratchpad_now(txn, bytes);
	txn->number[0] = resolutions[bytes[SP_LOW] >> 5 & 3];
	return err;
}

static int write_tempres(struct txn *txn)
{
	int err = txn->phase ? 0 : learn_kind(txn);

	if (!err && txn->device->kind == MAX31825)
		return -EOPNOTSUPP;
	return err ? err : thermometer_write_tempres(txn);
}

static int read_identity(struct txn *txn)
{
	uint8_t bytes[9];
	int err = scratchpad_now(txn, bytes);

	if (err && err != -EIO)
		return err;
	return property_text(txn, err ? "unknown" : family_type(txn->device));
}

/* arg: byte and bit; of a conversion, so it is read anew. */
static int read_fault(struct txn *txn)
{
	uint8_t bytes[9];
	int err = converted(txn, bytes);

	if (err)
		return err;
	txn->number[0] = (bytes[txn->property->arg >> 8] & txn->property->arg & 0xff) != 0;
	return thermometer_took(txn, bytes, txn_ended(txn));
}

static int read_flags(struct txn *txn)
{
	uint8_t bytes[9];
	int err = area_read(txn, &scratchpad, 0, bytes, 9);

	if (!err && txn->device->kind == MAX31850 && !thermocouple_raw(bytes) && !cold_raw(bytes) &&
	    !(bytes[0] & FAULT_ANY))
		err = restarted(txn, 0);
	txn->number[0] = (bytes[0] & 1) << 3 | (bytes[2] & 7);
	return err;
}

/* No data sheet says what becomes of a conversion while the memory is used. */
static int begin_memory(struct txn *txn)
{
	int err = learn_kind(txn);

	return err ? err : thermometer_rest(txn);
}

static AREA_NAMED(memory, "memory", .size = 128, .address_bytes = 1, .read = 0xf0, .block = 8,
                  .begin = begin_memory, .row = 8, .write = 0x0f, .verify = 0xaa, .copy = 0x55,
                  .key = 0xa5, .strong = true, .copy_ns = 25 * TXN_MS);

/* The functions of all thermometers see which chip it is too. */
enum { OWN = SCRATCHPAD, MEMORY };
static const struct area *const areas[] = {[OWN] = &scratchpad, [MEMORY] = &memory};

#define WAYS(X) \
	X(OWN, .read = read_temperature) \
	X(OWN_LIMIT, .write = write_limit) \
	X(FAULT, .read = read_fault) \
	X(FLAGS, .read = read_flags) \
	X(THERMOCOUPLE, .read = read_thermocouple) \
	X(ADDRESS, .read = read_address) \
	X(OWN_POWER, .read = read_power) \
	X(OWN_TEMPRES, .read = read_tempres, .write = write_tempres) \
	X(IDENTITY, .read = read_identity)
enum { WAY_BEFORE_OWN = AFTER_THERMOMETER_WAYS - 1, WAYS(WAY_ENUM) };
static const struct property_how how[] = {THERMOMETER_WAYS, WAYS(WAY_HOW)};

#define TEMPERATURE(text, resolution, which, decimals) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .convert = (resolution), .kinds = (which), \
	         THERMOMETER_MEASURES(decimals), .how = WAY_OWN)
#define FAULT(text, byte, bit) \
	PROPERTY(text, YESNO, VOLATILE, READ, .arg = (byte) << 8 | (bit), \
	         .convert = CONVERT_TEMPRES, .kinds = KIND(MAX31850), .how = WAY_FAULT)
#define LIMIT(text, where) \
	PROPERTY(text, TEMPERATURE, STABLE, BOTH, .kinds = KIND(DS1825), \
	         FIELD(OWN, .at = (where), .is_signed = true), .how = WAY_OWN_LIMIT)

static const struct property properties[] = {
	TEMPERATURE("fasttemp", 9, KIND(DS1825), 1),
	FAULT("fault", 0, FAULT_ANY),
	PROPERTY("flagfield", UNSIGNED, VOLATILE, READ, .hidden = true, .how = WAY_FLAGS),
	FAULT("ground_short", 2, 2),
	IDENTITY_ROW(WAY_IDENTITY, .kinds = 0),
	TEMPERATURE("latesttemp", 0, 0, 4),
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = 128, .kinds = KIND(MAX31826),
                 FIELD(MEMORY)),
	FAULT("open_circuit", 2, 1),
	PROPERTY("pages", DIRECTORY, STATIC, NONE, .kinds = KIND(MAX31826)),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(16, NUMBERS), .size = 8,
                 .kinds = KIND(MAX31826), FIELD(MEMORY)),
	PROPERTY("power", YESNO, VOLATILE, READ, .how = WAY_OWN_POWER),
	PROPERTY("prog_addr", UNSIGNED, STABLE, READ, .how = WAY_ADDRESS),
	THERMOMETER_SCRATCHPAD,
	TEMPERATURE("temperature", CONVERT_TEMPRES, 0, 4),
	TEMPERATURE("temperature10", 10, KIND(DS1825), 2),
	TEMPERATURE("temperature11", 11, KIND(DS1825), 3),
	TEMPERATURE("temperature12", 12, 0, 4),
	TEMPERATURE("temperature9", 9, KIND(DS1825), 1),
	LIMIT("temphigh", SP_HIGH),
	LIMIT("templow", SP_LOW),
	PROPERTY("tempres", UNSIGNED, STABLE, BOTH, .how = WAY_OWN_TEMPRES),
	/* 14 bits of 0.25, of which none below absolute zero */
	PROPERTY("thermocouple", TEMPERATURE, VOLATILE, READ, .convert = CONVERT_TEMPRES,
                 .kinds = KIND(MAX31850), MEASURES(-273.15, 2047.75, 2, DEGREES_C),
                 .how = WAY_THERMOCOUPLE),
	FAULT("vdd_short", 2, 4),
};

static const char *const types[] = {NULL, "DS1825", "MAX31826", "MAX31850", "MAX31825"};

CHIP_FAMILY(3b, "DS1825", PRESENCE, .flags = FLAG_ALARM | FLAG_TEMPERATURE,
            SCAN({"temperature12", "temperature"}, {"thermocouple", "thermocouple"}),
            .several = true, .tell = tell_kind, .types = types, THERMOMETER_FAMILY, AREAS(areas),
            HOW(how), PROPERTIES(properties));
