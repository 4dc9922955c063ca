/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827: thermometers that answer with the family code of the DS2438. Nothing here
 * writes to such a chip but Convert T. They cannot be told from each other; both are "TMP1826".
 */
#ifndef HAL_CHIPS_TMP1826_H
#define HAL_CHIPS_TMP1826_H

#include "hal/chips/family.h"

/* The kinds of family 26; 0: not known. */
enum { IS_DS2438 = 1, IS_TMP1826, IS_NEITHER };

/* family.identify and family.kind of family 26. */
int tmp1826_identify(struct txn *txn);
unsigned tmp1826_kind(const struct device *device);

int tmp1826_read_temperature(struct txn *txn);
/* arg: where the register begins in the scratchpad. */
int tmp1826_read_limit(struct txn *txn);
int tmp1826_read_power(struct txn *txn);
/* Bits of the format: 12 or 16. */
int tmp1826_read_format(struct txn *txn);

/* Places in the scratchpad. */
#define TMP1826_LOW 9
#define TMP1826_HIGH 11

#endif
