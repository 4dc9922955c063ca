/* SPDX-License-Identifier: MIT */
/*
 * Is what a thermometer holds the result of its last conversion? A chip may not have received
 * Convert T, and an old result has a right checksum, too. All times are ns. Nothing here uses the
 * wire.
 */
#ifndef HAL_CHIPS_THERMOMETER_PROOF_H
#define HAL_CHIPS_THERMOMETER_PROOF_H

#include "hal/wire/txn.h"

/*
 * Behind a reading of the scratchpad. 0: its conversion is over. TXN_MORE: it seemed to be, and
 * nothing proves that; txn waits for the longest time, and is to read the scratchpad again.
 */
int thermometer_ended(struct txn *txn, const uint8_t scratchpad[9], int64_t now);
/* What it holds was read, and is good: notes that, and from when it is (measured_ns, unproven). */
void thermometer_took(struct txn *txn, const uint8_t scratchpad[9], int64_t now);

#endif
