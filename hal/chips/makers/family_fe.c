/* SPDX-License-Identifier: MIT */
/*
 * iButtonLink SmartSlave: temperature and humidity in a room. No data sheet could be had: the
 * commands are those of OWFS's driver.
 *
 * That driver takes a page if the CRC16 of the page alone does not fit, and refuses it if it does.
 * So what a real one computes is not known. The memory chips of 1-Wire start their CRC16 with the
 * command and the address. A page is good with either of both checksums, but of one chip always
 * with the same: it is learned from LEARNS pages in a row. So what noise may do to get past the
 * checksum is as rare as with one. A page with neither is refused.
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
#define LEARNS 3

/* What the CRC16 covers; device.own. */
enum { NOT_KNOWN, PAGE_ALONE, COMMAND_AND_PAGE };
struct smart_slave {
	uint8_t covers;
	uint8_t learning, pages; /* what that seems to be; of how many pages in a row */
	int64_t measured_ns;     /* its last conversion that was verified; 0: none is known */
};

static int fetch_page(struct txn *txn, uint8_t bytes[PAGE], unsigned *covers)
{
	static const uint8_t command[] = {0xf0, 0};
	uint8_t in[PAGE + 2];
	int err = txn_ask(txn, command, sizeof(command), in, sizeof(in));

	if (err)
		return err;
	uint16_t head = onewire_crc16(0, command, sizeof(command));
	*covers = onewire_crc16_matches(onewire_crc16(0, in, PAGE), in + PAGE) ? PAGE_ALONE
	          : onewire_crc16_matches(onewire_crc16(head, in, PAGE), in + PAGE)
	                  ? COMMAND_AND_PAGE
	                  : NOT_KNOWN;
	memcpy(bytes, in, PAGE);
	return txn_checked(txn, *covers);
}

/* One page; TXN_MORE: which checksum it has is not known yet, and another is to be read. */
static int load_page(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	struct smart_slave *slave = txn->device->own;
	unsigned covers = NOT_KNOWN;
	uint8_t page[PAGE];
	int err = fetch_page(txn, page, &covers);

	(void)area;
	if (!err && (slave->covers || slave->pages) && covers != slave->learning)
		err = txn_checked(txn, false);
	if (err && !slave->covers)
		slave->pages = 0;
	if (err)
		return err;
	slave->learning = (uint8_t)covers;
	if (!slave->covers && ++slave->pages < LEARNS)
		return TXN_MORE;
	slave->covers = (uint8_t)covers;
	memcpy(bytes, page + at, n);
	return 0;
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
		err = page_now(txn, bytes);
		txn->phase -= err == TXN_MORE;
		if (err)
			return err;
		return is_busy(bytes) ? txn_wait(txn, CONVERT_NS) : -EBADMSG;
	default:
		err = page_now(txn, bytes);
		txn->phase -= err == TXN_MORE;
		if (err)
			return err;
		if (is_busy(bytes))
			return txn->phase < LOOKS ? txn_wait(txn, CONVERT_NS) : -EIO;
		if (!bytes[VALID])
			return -EBADMSG; /* it restarted */
		txn_share(txn, &measured, 0, bytes, PAGE, *begun);
		((struct smart_slave *)txn->device->own)->measured_ns = *begun;
		return 0;
	}
}

static double th_value(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] << 8 | bytes[1]) / 128.0;
}

/* arg: where in the page. */
static int read_measured(struct txn *txn)
{
	uint8_t bytes[PAGE];
	int err = family_fe_convert(txn, bytes);

	if (!err)
		txn->number[0] = th_value(bytes + txn->property->arg);
	return err;
}

/*
 * The time of a conversion that the bus did not ask for is not known, and a restart takes the
 * result: then it converts.
 */
static int read_latest(struct txn *txn)
{
	struct smart_slave *slave = txn->device->own;
	uint8_t bytes[PAGE];

	if (!slave->measured_ns)
		return read_measured(txn);
	int err = area_read(txn, &page, 0, bytes, PAGE);

	if (err)
		return err;
	if (bytes[SUBTYPE] != SUBTYPE_TH)
		return -ENOENT;
	if (!bytes[VALID] || is_busy(bytes)) {
		slave->measured_ns = 0;
		return TXN_MORE;
	}
	txn->number[0] = th_value(bytes + txn->property->arg);
	txn->measured_ns = slave->measured_ns;
	return 0;
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

/* What such sensors of rooms measure, as widely as any does. */
#define PERCENT MEASURES(-10, 110, 2, "%")
#define CELSIUS MEASURES(-58, 128, 3, DEGREES_C)

static const struct property properties[] = {
	PROPERTY_DIR("TH"),
	PROPERTY("TH/humidity", FLOAT, VOLATILE, READ, PERCENT, .arg = HUMIDITY_AT,
                 .how = WAY_MEASURED),
	PROPERTY("TH/latesthumidity", FLOAT, VOLATILE, READ, PERCENT, .arg = HUMIDITY_AT,
                 .how = WAY_LATEST),
	PROPERTY("TH/latesttemp", TEMPERATURE, VOLATILE, READ, CELSIUS, .arg = TEMPERATURE_AT,
                 .how = WAY_LATEST),
	PROPERTY("TH/led", YESNO, STABLE, WRITE, .how = WAY_LED),
	PROPERTY("TH/temperature", TEMPERATURE, VOLATILE, READ, CELSIUS, .arg = TEMPERATURE_AT,
                 .how = WAY_MEASURED),
	PROPERTY("firmware", ASCII, STABLE, READ, .size = 5, .arg = VERSION, .how = WAY_TEXT),
	PROPERTY("subtype", ASCII, STABLE, READ, .size = 2, .arg = SUBTYPE, .how = WAY_TEXT),
};

CHIP_FAMILY(fe, "IBLSS", CHECKSUM, .flags = FLAG_TEMPERATURE,
            SCAN({"TH/temperature", "temperature"}, {"TH/humidity", "humidity"}), HOW(how),
            PROPERTIES(properties));
