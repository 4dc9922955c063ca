/* SPDX-License-Identifier: MIT */
/* TMP1826 and TMP1827: limits and offset, and the alerts. Functions of properties. */
#pragma once

#include "hal/chips/thermometers/tmp1826.h"

/* A limit, or the offset. arg: where the register begins in the scratchpad. */
int tmp1826_read_limit(struct txn *txn);
/* Sets it, and has the chip keep it in its EEPROM. */
int tmp1826_write_limit(struct txn *txn);
/* Has a conversion been beyond the limit? arg: the bit of tmp1826.alerts. 0 clears it. */
int tmp1826_read_alert(struct txn *txn);
int tmp1826_write_alert(struct txn *txn);
