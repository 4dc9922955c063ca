/* SPDX-License-Identifier: MIT */
/*
 * iButtonLink SmartSlave: temperature and humidity in a room. No data sheet could be had: the
 * commands are those of OWFS's driver.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"

#define SUBTYPE_TH 0x04
#define PAGE 32
enum { SUBTYPE, VERSION, BUSY, TEMPERATURE_AT = 4, HUMIDITY_AT = 6, VALID = 8 }; /* of the page */

/* What OWFS waits for a conversion. */
#define CONVERT_NS (1000 * TXN_MS)
#define SOON_NS (5 * TXN_MS)
#define LOOKS 4

/* The checksum is that of the page alone. */
static int load_page(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	static const uint8_t command[] = {0xf0, 0};
	uint8_t page[PAGE];
	int err = txn_command(txn, command, sizeof(command));

	(void)area;
	if (!err)
		err = txn_read_crc16(txn, NULL, 0, page, PAGE);
	if (!err)
		memcpy(bytes, page + at, n);
	return err;
}

static const struct area page = {.name = "page", .size = PAGE, .block = PAGE, .load = load_page};
/* The page of a conversion that was verified. */
static const struct area measured = {.name = "measured", .size = PAGE, .block = PAGE};

static bool is_busy(const uint8_t bytes[PAGE])
{
	return bytes[BUSY] || bytes[BUSY + 1];
}

static int now(struct txn *txn, uint8_t bytes[PAGE])
{
	int err = load_page(txn, &page, 0, bytes, PAGE);

	return !err && bytes[SUBTYPE] != SUBTYPE_TH ? -ENOENT : err;
}

/* The busy flag proves that the command was taken. */
static int convert(struct txn *txn, uint8_t bytes[PAGE])
{
	static const uint8_t command = 0xb4;
	int64_t *begun = txn_own(txn, int64_t);
	int err;

	switch (txn->phase++) {
	case 0:
		if (txn_shared(txn, &measured, 0, bytes, PAGE))
			return 0;
		*begun = txn_now(txn);
		err = txn_command(txn, &command, 1);
		return err ? err : txn_wait(txn, SOON_NS);
	case 1:
		err = now(txn, bytes);
		if (err)
			return err;
		return is_busy(bytes) ? txn_wait(txn, CONVERT_NS) : -EBADMSG;
	default:
		err = now(txn, bytes);
		if (err)
			return err;
		if (is_busy(bytes))
			return txn->phase < LOOKS ? txn_wait(txn, CONVERT_NS) : -EIO;
		if (!bytes[VALID])
			return -EBADMSG; /* it restarted */
		txn_share(txn, &measured, 0, bytes, PAGE, *begun);
		return 0;
	}
}

static double value(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] << 8 | bytes[1]) / 128.0;
}

/* arg: where in the page. */
static int read_measured(struct txn *txn)
{
	uint8_t bytes[PAGE];
	int err = convert(txn, bytes);

	if (!err)
		txn->number[0] = value(bytes + txn->property->arg);
	return err;
}

static int read_latest(struct txn *txn)
{
	uint8_t bytes[PAGE];
	int err = area_read(txn, &page, 0, bytes, PAGE);

	if (err)
		return err;
	if (bytes[SUBTYPE] != SUBTYPE_TH)
		return -ENOENT;
	txn->number[0] = value(bytes + txn->property->arg);
	return !bytes[VALID] || is_busy(bytes) ? -EIO : 0;
}

static int read_text(struct txn *txn)
{
	uint8_t bytes[PAGE];
	char text[8] = "TH";
	int err = area_read(txn, &page, 0, bytes, PAGE);

	if (err)
		return err;
	if (bytes[SUBTYPE] != SUBTYPE_TH)
		return -ENOENT;
	if (txn->property->arg == VERSION)
		snprintf(text, sizeof(text), "%u.%u", bytes[VERSION] >> 4, bytes[VERSION] & 0xf);
	return property_text(txn, text);
}

/* Nothing shows what it does. */
static int write_led(struct txn *txn)
{
	const uint8_t command[] = {0xa5, 0, txn->number[0] != 0};

	return txn_command(txn, command, sizeof(command));
}

enum { WAY_MEASURED = 1, WAY_LATEST, WAY_TEXT, WAY_LED };
static const struct property_how how[] = {
	[WAY_MEASURED] = {.read = read_measured},
	[WAY_LATEST] = {.read = read_latest},
	[WAY_TEXT] = {.read = read_text},
	[WAY_LED] = {.write = write_led},
};

static const struct property properties[] = {
	PROPERTY_DIR("TH"),
	PROPERTY("TH/humidity", FLOAT, VOLATILE, READ, .arg = HUMIDITY_AT, .how = WAY_MEASURED),
	PROPERTY("TH/latesthumidity", FLOAT, VOLATILE, READ, .arg = HUMIDITY_AT, .how = WAY_LATEST),
	PROPERTY("TH/latesttemp", TEMPERATURE, VOLATILE, READ, .arg = TEMPERATURE_AT,
                 .how = WAY_LATEST),
	PROPERTY("TH/led", YESNO, STABLE, WRITE, .how = WAY_LED),
	PROPERTY("TH/temperature", TEMPERATURE, VOLATILE, READ, .arg = TEMPERATURE_AT,
                 .how = WAY_MEASURED),
	PROPERTY("firmware", ASCII, STABLE, READ, .size = 5, .arg = VERSION, .how = WAY_TEXT),
	PROPERTY("subtype", ASCII, STABLE, READ, .size = 2, .arg = SUBTYPE, .how = WAY_TEXT),
};

const struct family family_fe = {
	.code = 0xfe,
	.type = "IBLSS",
	HOW(how),
	PROPERTIES(properties),
};
