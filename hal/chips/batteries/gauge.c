/* SPDX-License-Identifier: MIT */
/*
 * The battery gauges with 256 addresses: what several families do alike (gauges.c has the
 * tables and the data sheets).
 */
#include <errno.h>

#include "hal/chips/batteries/gauge.h"
#include "hal/chips/batteries/ws603.h"
#include "hal/chips/thermometers/thermocouple.h"

#define VIS 0x0e /* the voltage across the resistor */
enum { STATUS_AT = 0x01, CHARGING = 0x40, CHARGE_STATUS = 0xc0 };

/* Read Data, Write Data, Recall Data, Copy Data. */
#define GAUGE_READ .address_bytes = 1, .read = 0x69
#define GAUGE_WRITE(row_) GAUGE_READ, .row = (row_), .write = 0x6c
/* Read and written by way of its shadow RAM, in blocks. */
#define GAUGE_STORED(block_) \
	.block = (block_), GAUGE_WRITE(block_), .recall = 0xb8, .copy = 0x48, .copy_ns = 10 * TXN_MS
#define REGISTER(text, where) AREA(.name = (text), .at = (where), .size = 1, GAUGE_WRITE(1))

static AREA_NAMED(words, "words", .size = 256, .block = 2, GAUGE_READ);
static AREA_NAMED(bytes_of, "bytes", .size = 256, GAUGE_READ);

/* A number of two bytes that goes on counting while it is written. */
static bool is_counted(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	int change = (int16_t)((have[0] - want[0]) * 256 + have[1] - want[1]);

	(void)txn, (void)n;
	return change >= -2 && change <= 2;
}

const struct area *const gauge_areas[GAUGE_AREAS] = {
	[MEMORY] = AREA(.name = "memory", .size = 256, .block = 32, GAUGE_READ),
	[WORDS] = &words,
	[BYTES] = &bytes_of,
	[CHARGE] = AREA(.name = "accumulated current", .at = 0x10, .size = 2, GAUGE_WRITE(2),
                        .is_written = is_counted),
	[EEPROM] = AREA(.name = "EEPROM", .size = 128, GAUGE_STORED(16)),
	[EEPROM4] = AREA(.name = "EEPROM", .size = 0x34, GAUGE_STORED(4)),
	[EEPROM32] = AREA(.name = "EEPROM", .size = 128, GAUGE_STORED(32)),
	/* A copy takes the whole block, so all of it is written. */
	[PARAMETERS] = AREA(.name = "parameters", .at = 0x60, .size = 32, GAUGE_STORED(32)),
	/* CC and DC mirror the pins, which follow at once: they are nothing that was written */
	[PROTECTION] = AREA(.name = "protection", .size = 1, GAUGE_WRITE(1), .counts = 0xf3),
	[PINS_OF] = AREA(.name = "pins", .size = 1, GAUGE_READ),
	[STATUS] = REGISTER("status", STATUS_AT),
	[SPECIAL_08] = REGISTER("special", 0x08),
	[SPECIAL_15] = REGISTER("special", 0x15),
	[ALARM] = REGISTER("alarm", 0x85),
	[TIMER] = AREA(.name = "timer", .at = 0x02, .size = 2, GAUGE_WRITE(2),
                       .is_written = is_counted),
};

static int read_lock(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &bytes_of, (unsigned)txn->property->arg, &byte, 1);

	txn->number[0] = byte >> txn->element & 1;
	return err;
}

static int signed_word(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] << 8 | bytes[1]);
}

/* The voltage across the resistor is the thermocouple's; the chip is its cold end. */
static int read_couple(struct txn *txn)
{
	unsigned arg = (unsigned)txn->property->arg;
	double *mv = txn_own(txn, double);
	uint8_t bytes[2];
	int err;

	if (txn->phase == 0) {
		err = area_read(txn, &words, VIS, bytes, 2);
		if (err)
			return err;
		*mv = signed_word(bytes) * 1000 * (arg >> 16 ? GAUGE_FINE : GAUGE_COARSE);
		txn->phase = 1;
		return TXN_MORE;
	}
	err = area_read(txn, &words, arg >> 8 & 0xff, bytes, 2);
	if (err)
		return err;
	return thermocouple_celsius((enum thermocouple)(arg & 0xff), *mv,
	                            (signed_word(bytes) >> 5) * .125, &txn->number[0])
	               ? 0
	               : -ERANGE;
}

static int read_couple_low(struct txn *txn)
{
	txn->number[0] = thermocouple_low((enum thermocouple)txn->property->arg);
	return 0;
}

static int read_couple_high(struct txn *txn)
{
	txn->number[0] = thermocouple_high((enum thermocouple)txn->property->arg);
	return 0;
}

/* Of a DS2770: Start Charge, Stop Charge; then the status says what it is. */
static int write_charge(struct txn *txn)
{
	const uint8_t command = txn->number[0] != 0 ? 0xb5 : 0xbe;
	uint8_t byte;
	int err;

	if (txn->phase == 0) {
		txn_void(txn);
		err = txn_command(txn, &command, 1);
		if (err)
			return err;
		txn->phase = 1;
	}
	err = area_read(txn, &bytes_of, STATUS_AT, &byte, 1);
	if (err)
		return err;
	return ((byte & CHARGE_STATUS) == CHARGING) == (command == 0xb5) ? 0 : -EIO;
}

const struct property_how gauge_how[GAUGE_WAYS] = {
	/* a lock is for good */
	[WAY_LOCK] = {.read = read_lock, .write = property_refuse},
	[WAY_COUPLE] = {.read = read_couple},
	[WAY_COUPLE_LOW] = {.read = read_couple_low},
	[WAY_COUPLE_HIGH] = {.read = read_couple_high},
	[WAY_REFUSED] = {.write = property_refuse},
	[WAY_CHARGE] = {.write = write_charge},
	[WAY_PAGE] = {SET(EEPROM, .at = 0x20)},
	[WAY_PMOD] = {SET(EEPROM, .at = 0x31, .shift = 5, .bits = 1)},
	[WAY_SWEN] = {SET(EEPROM, .at = 0x31, .shift = 3, .bits = 1)},
	[WAY_CURRENTBIAS] = {SET(EEPROM, GAUGE_BIAS(GAUGE_RESISTOR))},
	[WAY_VBIAS] = {SET(EEPROM, GAUGE_BIAS(1))},
	[WAY_WS603_BYTE] = {.read = ws603_read_byte, .write = property_refuse},
	[WAY_WS603_BYTES] = {.read = ws603_read_bytes},
	[WAY_WS603_WIND] = {.read = ws603_read_wind},
	[WAY_WS603_LIGHTS] = {.write = property_refuse},
};
