/* SPDX-License-Identifier: MIT */
/* The battery gauges with 256 addresses: what several families do alike. */
#include <errno.h>

#include "hal/chips/batteries/gauge.h"

#define VIS 0x0e             /* the voltage across the resistor */
#define PROTECTION_PINS 0x0c /* of the protection register: CC and DC mirror the pins */

AREA_NAMED(gauge_memory, "memory", .size = 256, .block = 32, GAUGE_READ);
AREA_NAMED(gauge_words, "words", .size = 256, .block = 2, GAUGE_READ);
AREA_NAMED(gauge_bytes, "bytes", .size = 256, GAUGE_READ);
AREA_NAMED(gauge_eeprom, "EEPROM", .size = 128, GAUGE_STORED(16));
/* A copy takes the whole block, so all of it is written. */
AREA_NAMED(gauge_parameters, "parameters", .at = 0x60, .size = 32, GAUGE_STORED(32));

bool gauge_is_counted(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	int change = (int16_t)((have[0] - want[0]) * 256 + have[1] - want[1]);

	(void)txn, (void)n;
	return change >= -2 && change <= 2;
}

AREA_NAMED(gauge_charge, "accumulated current", .at = 0x10, .size = 2, GAUGE_WRITE(2),
           .is_written = gauge_is_counted);

/* The pins follow at once, and are nothing that was written. */
static int saw_protection(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	bytes[0] &= (uint8_t)~PROTECTION_PINS;
	return 0;
}

AREA_NAMED(gauge_protection, "protection", .size = 1, GAUGE_WRITE(1), .saw = saw_protection);
AREA_NAMED(gauge_pins, "pins", .size = 1, GAUGE_READ);

int gauge_read_lock(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &gauge_bytes, txn->property->arg & 0xff, &byte, 1);

	txn->number[0] = byte >> txn->element & 1;
	return err;
}

/* For good: the enabling bit, and the command that has to follow it at once. */
int gauge_write_lock(struct txn *txn)
{
	uint32_t places = (uint32_t)txn->property->arg;
	const uint8_t enable[] = {0x6c, (uint8_t)places, 0x40};
	const uint8_t lock[] = {0x6a, (uint8_t)(places >> (8 * (1 + txn->element)))};
	int err = 0;

	if (txn->phase == 0) {
		if (txn->number[0] == 0)
			return -EOPNOTSUPP;
		txn_void(txn);
		err = txn_command(txn, enable, sizeof(enable));
		if (!err)
			err = txn_command(txn, lock, sizeof(lock));
		if (err)
			return err;
		txn->phase = 1;
	}
	err = gauge_read_lock(txn);
	return err ? err : txn->number[0] != 0 ? 0 : -EIO;
}

static int signed_word(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] << 8 | bytes[1]);
}

/* The voltage across the resistor is the thermocouple's; the chip is its cold end. */
int gauge_read_couple(struct txn *txn)
{
	unsigned arg = (unsigned)txn->property->arg;
	double *mv = txn_own(txn, double);
	uint8_t bytes[2];
	int err;

	if (txn->phase == 0) {
		err = area_read(txn, &gauge_words, VIS, bytes, 2);
		if (err)
			return err;
		*mv = signed_word(bytes) * 1000 * (arg >> 16 ? GAUGE_FINE : GAUGE_COARSE);
		txn->phase = 1;
		return TXN_MORE;
	}
	err = area_read(txn, &gauge_words, arg >> 8 & 0xff, bytes, 2);
	if (err)
		return err;
	return thermocouple_celsius((enum thermocouple)(arg & 0xff), *mv,
	                            (signed_word(bytes) >> 5) * .125, &txn->number[0])
	               ? 0
	               : -ERANGE;
}

int gauge_couple_low(struct txn *txn)
{
	txn->number[0] = thermocouple_low((enum thermocouple)txn->property->arg);
	return 0;
}

int gauge_couple_high(struct txn *txn)
{
	txn->number[0] = thermocouple_high((enum thermocouple)txn->property->arg);
	return 0;
}
