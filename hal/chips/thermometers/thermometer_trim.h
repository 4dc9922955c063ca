/* SPDX-License-Identifier: MIT */
/* What `errata` of a thermometer with a nine-byte scratchpad has. */
#ifndef HAL_CHIPS_THERMOMETER_TRIM_H
#define HAL_CHIPS_THERMOMETER_TRIM_H

#include "hal/chips/family.h"

int thermometer_read_die(struct txn *txn);
int thermometer_read_trim(struct txn *txn);
int thermometer_refuse_trim(struct txn *txn);
int thermometer_read_trim_valid(struct txn *txn);
int thermometer_read_trim_blanket(struct txn *txn);

#endif
