/* SPDX-License-Identifier: MIT */
/* TMP1826 and TMP1827: what a user writes, and the alerts. Functions of properties. */
#ifndef HAL_CHIPS_TMP1826_MEMORY_H
#define HAL_CHIPS_TMP1826_MEMORY_H

#include "hal/chips/tmp1826.h"

/* Sets a limit, or the offset, and has the chip keep it in its EEPROM. */
int tmp1826_write_limit(struct txn *txn);
/* Has a conversion been beyond the limit? arg: the bit of ds2438.alerts. 0 clears it. */
int tmp1826_read_alert(struct txn *txn);
int tmp1826_write_alert(struct txn *txn);
/* The EEPROM, 256 bytes. */
extern const struct area tmp1826_memory;

#endif
