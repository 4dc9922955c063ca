/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827: thermometers that answer with the family code of the DS2438. Nothing here
 * writes to such a chip but Convert T, and what a user writes. They cannot be told from each other;
 * both are "TMP1826".
 *
 * No whole data sheet was at hand, but the maker's pages of it, and published drivers. They
 * disagree on whether a CRC8 follows each block of the memory: a block is read until three looks
 * are the same, in either case. It comes after a pause within the transaction, so a link that
 * splits refuses it. The chip shows no busy slots: the flag of a new result is cleared, and has to
 * be seen again. Copy Scratchpad-1 keeps limits and offset over a loss of power, and nothing shows
 * whether it succeeded; a block of the memory is read back. To read the status clears its alerts:
 * they are kept until 0 is written, over an absence and a restart of the chip, too; a read that is
 * disturbed loses one whose cause has passed. Of the pins the commands alone could be had (F5h,
 * A5h): they, the resistor address, the TMP1827's SHA-256 and the modes that convert by themselves
 * are not served.
 */
#pragma once

#include "hal/chips/batteries/ds2438.h"
#include "hal/chips/family.h"

/* The kinds of family 26 (device.kind). */
enum { IS_DS2438 = 1, IS_TMP1826, IS_NEITHER };

/* What is known of such a chip (device.own). */
struct tmp1826 {
	struct ds2438 common; /* of all chips of the family */
	uint8_t alerts;       /* that were read, which clears them in the chip */
	bool kept;            /* its EEPROM has its settings */
};
_Static_assert(sizeof(struct tmp1826) <= DEVICE_OWN, "no room for what is known of a chip");
static inline struct tmp1826 *tmp1826_of(const struct txn *txn)
{
	return txn->device->own;
}

/* family.identify of family 26. */
int tmp1826_identify(struct txn *txn);
/* Bits of the format: 12 or 16. */
property_function tmp1826_read_temperature, tmp1826_read_power, tmp1826_read_format;
/*
 * A limit, or the offset: to write it has the chip keep it in its EEPROM. arg: where the register
 * begins in the scratchpad.
 */
enum { TMP1826_LOW = 9, TMP1826_HIGH = 11, TMP1826_OFFSET = 13 };
property_function tmp1826_read_limit, tmp1826_write_limit;
/* Has a conversion been beyond the limit? arg: the bit of tmp1826.alerts. 0 clears it. */
enum { TMP1826_ALERT_LOW = 1, TMP1826_ALERT_HIGH = 2 };
property_function tmp1826_read_alert, tmp1826_write_alert;
/* 256 bytes. -EOPNOTSUPP: the link makes no pause within a transaction (txn_write_paused). */
extern const struct area tmp1826_memory;
