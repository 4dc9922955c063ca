/* SPDX-License-Identifier: MIT */
/* What family_29.c has of a DS2408 for the displays that stand on one. */
#ifndef HAL_CHIPS_DS2408_H
#define HAL_CHIPS_DS2408_H

#include "hal/chips/family.h"

/* What is known of the chip (device.own). */
struct ds2408 {
	bool por_clear;  /* the power-on flag has been seen clear */
	uint8_t display; /* enum lcd_board: which one has been set up */
};

/* The strobe is switched on; several calls if it is not: TXN_MORE says that it was off. */
int ds2408_strobe(struct txn *txn);
/* Bytes for the outputs, in one transaction. */
int ds2408_put(struct txn *txn, const uint8_t *bytes, unsigned n);

#endif
