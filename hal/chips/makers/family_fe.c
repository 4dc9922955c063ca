/* SPDX-License-Identifier: MIT */
/*
 * iButtonLink SmartSlave: temperature and humidity in a room. No data sheet could be had: the
 * commands are those of OWFS's driver.
 *
 * That driver takes a page if the CRC16 of the page alone does not fit, and refuses it if it does.
 * So what a real one computes is not known. The memory chips of 1-Wire start their CRC16 with the
 * command and the address. A page is good with either of both checksums, and refused with neither.
 *
 * The page, which has the CRC16, has a busy flag, too: it proves a conversion.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/wire/crc.h"

#define SUBTYPE_TH 0x04
#define PAGE 32
enum { SUBTYPE, VERSION, BUSY, TEMPERATURE_AT = 4, HUMIDITY_AT = 6, VALID = 8 }; /* of the page */

/* What OWFS waits for a conversion. */
#define CONVERT_NS (1000 * TXN_MS)
#define SOON_NS (5 * TXN_MS)
#define LOOKS 4

static int load_page(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	static const uint8_t command[] = {0xf0, 0};
	uint16_t head = onewire_crc16(0, command, sizeof(command));
	uint8_t in[PAGE + 2];
	int err = txn_ask(txn, command, sizeof(command), in, sizeof(in));

	(void)area;
	if (err)
		return err;
	memcpy(bytes, in + at, n);
	return txn_checked(txn,
	                   onewire_crc16_matches(onewire_crc16(0, in, PAGE), in + PAGE) ||
	                           onewire_crc16_matches(onewire_crc16(head, in, PAGE), in + PAGE));
}

static AREA_NAMED(page, "page", .size = PAGE, .block = PAGE, .load = load_page);
/* The page of a conversion that was verified. */
static AREA_NAMED(measured, "measured", .size = PAGE, .block = PAGE);

static bool is_busy(const uint8_t bytes[PAGE])
{
	return bytes[BUSY] || bytes[BUSY + 1];
}

static int page_now(struct txn *txn, uint8_t bytes[PAGE])
{
	int err = load_page(txn, &page, 0, bytes, PAGE);

	return !err && bytes[SUBTYPE] != SUBTYPE_TH ? -ENOENT : err;
}

/* The busy flag proves that the command was taken. */
static int family_fe_convert(struct txn *txn, uint8_t bytes[PAGE])
{
	int64_t *begun = txn_own(txn, int64_t);
	int err;

	switch (txn->phase++) {
	case 0:
		if (txn_shared(txn, &measured, 0, bytes, PAGE))
			return 0;
		*begun = txn_now(txn);
		return txn_command_wait(txn, TXN_BYTES(0xb4), SOON_NS);
	case 1:
		err = page_now(txn, bytes);
		if (err)
			return err;
		return is_busy(bytes) ? txn_wait(txn, CONVERT_NS) : -EBADMSG;
	default:
		err = page_now(txn, bytes);
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

static double th_value(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] << 8 | bytes[1]) / 128.0;
}

/* arg: where in the page. Of what was not asked for the time is not known: it converts. */
static int read_measured(struct txn *txn)
{
	uint8_t bytes[PAGE];
	int err = family_fe_convert(txn, bytes);

	if (!err)
		txn->number[0] = th_value(bytes + txn->property->arg);
	return err;
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

enum { WAY_MEASURED = 1, WAY_TEXT, WAY_LED };
static const struct property_how how[] = {
	[WAY_MEASURED] = {.read = read_measured},
	[WAY_TEXT] = {.read = read_text},
	[WAY_LED] = {.write = write_led},
};

/* What such sensors of rooms measure, as widely as any does. */
#define PERCENT MEASURES(-10, 110, 2, "%")
#define CELSIUS MEASURES(-58, 128, 3, DEGREES_C)

static const struct property properties[] = {
	PROPERTY_DIR("TH"),
	PROPERTY("TH/humidity", FLOAT, VOLATILE, READ, PERCENT, .arg = HUMIDITY_AT,
                 .how = WAY_MEASURED),
	PROPERTY("TH/latesthumidity", FLOAT, VOLATILE, READ, PERCENT, .arg = HUMIDITY_AT,
                 .how = WAY_MEASURED),
	PROPERTY("TH/latesttemp", TEMPERATURE, VOLATILE, READ, CELSIUS, .arg = TEMPERATURE_AT,
                 .how = WAY_MEASURED),
	PROPERTY("TH/led", YESNO, STABLE, WRITE, .how = WAY_LED),
	PROPERTY("TH/temperature", TEMPERATURE, VOLATILE, READ, CELSIUS, .arg = TEMPERATURE_AT,
                 .how = WAY_MEASURED),
	PROPERTY("firmware", ASCII, STABLE, READ, .size = 5, .arg = VERSION, .how = WAY_TEXT),
	PROPERTY("subtype", ASCII, STABLE, READ, .size = 2, .arg = SUBTYPE, .how = WAY_TEXT),
};

CHIP_FAMILY(fe, "IBLSS", CHECKSUM, .flags = FLAG_TEMPERATURE,
            SCAN({"TH/temperature", "temperature"}, {"TH/humidity", "humidity"}), HOW(how),
            PROPERTIES(properties));
