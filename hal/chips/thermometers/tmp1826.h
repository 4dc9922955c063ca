/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827: thermometers that answer with the family code of the DS2438. Nothing here
 * writes to such a chip but Convert T, and what a user writes. They cannot be told from each other;
 * both are "TMP1826".
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

/* Of the scratchpad: temperature, status, 3 bytes of settings, limits and offset; 2 checksums. */
#define TMP1826_PAD 18
enum { TMP1826_STATUS = 2, TMP1826_SETTINGS = 4 };
enum { TMP1826_PRECISE = 0x80 }; /* of the first byte of the settings: 1/128 degrees, not 1/16 */

/*
 * To read the status clears its flags: that there is a new result, and the alerts, which are kept
 * in tmp1826.alerts. -EBADMSG: a checksum is wrong.
 */
int tmp1826_read_pad(struct txn *txn, uint8_t pad[TMP1826_PAD]);
/* Degrees of a register. */
double tmp1826_celsius(const uint8_t pad[TMP1826_PAD], unsigned at);
int tmp1826_read_temperature(struct txn *txn);
int tmp1826_read_power(struct txn *txn);
/* Bits of the format: 12 or 16. */
int tmp1826_read_format(struct txn *txn);

/* Places in the scratchpad. */
#define TMP1826_LOW 9
#define TMP1826_HIGH 11
#define TMP1826_OFFSET 13
enum { TMP1826_ALERT_LOW = 1, TMP1826_ALERT_HIGH = 2 };
